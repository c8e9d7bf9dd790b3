// SPDX-License-Identifier: Apache-2.0
#include <CLI/CLI.hpp>
#include <filesystem>

#include "apps/tuina/keyboard.hpp"
#include "apps/tuina/session_files.hpp"
#include "apps/tuina/simulated_session.hpp"
#include "apps/tuina/verbs.hpp"

namespace tuina::app {
namespace {

/// The whole session in simulation: scan, map, plan, massage, report.
class Massage final : public Verb {
 public:
  [[nodiscard]] const char* name() const override { return "massage"; }
  [[nodiscard]] const char* summary() const override {
    return "scan a simulated person, plan and give a massage, write the report";
  }
  [[nodiscard]] const char* example() const override {
    return "tuina massage --person phantom:hefty --position prone --programme relax --out "
           "my-report";
  }
  void describe(CLI::App& command) override {
    command
        .add_option("--person", order_.person,
                    "phantom:slim, phantom:medium, phantom:hefty, or a labelled body FILE.ply")
        ->capture_default_str();
    command.add_option("--position", position_, "auto: recognised from the scan")
        ->check(CLI::IsMember({"auto", "sitting", "prone"}))
        ->capture_default_str();
    command.add_option("--programme", order_.programme, "a shipped programme or a TOML file")
        ->capture_default_str();
    command.add_option("--no-go", order_.no_go, "a TOML file with what must not be touched");
    command.add_option("--consent", order_.consent,
                       "a TOML file with the answers to the health questions; without it the "
                       "simulated person answers");
    command.add_option(
        "--robot-pose", order_.robot_pose,
        "where the robot stands: a file of `tuina calibrate --robot`; without it the "
        "simulated robot was measured as well");
    command
        .add_option("--adaptive", adaptive_,
                    "on: what the presses feel decides how hard they may be; off: as planned")
        ->check(CLI::IsMember({"on", "off"}))
        ->capture_default_str();
    command.add_flag("--keys", order_.keys, fmt::format("live, at real pace: {}", key_help));
    command
        .add_option("--body-mass-index", facts_.mass_index,
                    "of the person, kg/m^2, if known: a help in telling the body condition")
        ->check(CLI::Range(10.0, 80.0));
    command.add_option("--body-fat-percent", facts_.fat_percent, "likewise")
        ->check(CLI::Range(2.0, 70.0));
    command.add_option("--method", method_, "of finding acupoints")
        ->check(CLI::IsMember({"field_morphing", "surface"}));
    command.add_option("--atlas", order_.atlas,
                       "an atlas file or a labelled body instead of the shipped atlas");
    command.add_option("--pace", pace_, "of the simulation")
        ->check(CLI::IsMember({"max", "real"}))
        ->capture_default_str();
    command
        .add_option(
            "--out", out_,
            "folder for session.json, scan.ply, acupoints.json, plan.json, trace.csv, report.html")
        ->capture_default_str();
  }

  [[nodiscard]] Result<Answer> run(const CommonOptions& common) override {
    const auto config = effective_config(common);
    if (!config) return tl::unexpected(config.error());
    if (position_ == "sitting") order_.position = Position::sitting;
    if (position_ == "prone") order_.position = Position::prone;
    order_.method = body::parse_method(method_).value_or(order_.method);
    order_.real_time = pace_ == "real" || order_.keys;
    order_.adaptive = adaptive_ == "on";
    // Before the work, not after it: the folder is made, and an empty one goes again.
    std::error_code fault;
    const bool made = std::filesystem::create_directories(out_, fault);
    if (!std::filesystem::is_directory(out_)) {
      return fail(Fault::file, "--out {}: the folder cannot be made: {}", out_, fault.message());
    }
    const auto result = run_simulated_session(order_, *config, common);
    if (!result) {
      if (made) std::filesystem::remove(out_, fault);
      return tl::unexpected(result.error());
    }

    const FeltBack felt = felt_back(*result, facts_);
    Answer answer{.json = session_json(*result, felt, common.seed),
                  .text = session_text(*result),
                  .exit_code = result->stops.empty() ? 0 : 4};
    const auto report = report_data(*result, felt, order_, *config, common.seed);
    if (const auto written = write_session(*result, report, answer.json, out_); !written) {
      return tl::unexpected(written.error());
    }
    answer.text +=
        fmt::format("\nreport: {}", (std::filesystem::path(out_) / "report.html").string());
    return answer;
  }

 private:
  SessionOrder order_;
  std::string position_ = "auto";
  std::string method_;
  tissue::BodyFacts facts_;
  std::string pace_ = "max";
  std::string adaptive_ = "on";
  std::string out_ = "massage-report";
};

}  // namespace

std::unique_ptr<Verb> make_massage() {
  return std::make_unique<Massage>();
}

}  // namespace tuina::app
