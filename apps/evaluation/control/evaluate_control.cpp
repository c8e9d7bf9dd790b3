// SPDX-License-Identifier: Apache-2.0
#include <filesystem>
#include <thread>

#include "apps/evaluation/control/report.hpp"
#include "apps/evaluation/verbs.hpp"
#include "tuina/core/io/file.hpp"
#include "tuina/core/units.hpp"

namespace tuina::app {
namespace {

Result<std::vector<ControlTrace>> traces_of(const ContactExperiment& experiment) {
  std::vector<ControlTrace> traces;
  for (const ControllerChoice& choice : controller_choices()) {
    ContactExperiment run = experiment;
    choose(run, choice);
    auto outcome = run_contact(run);
    if (!outcome) return tl::unexpected(outcome.error());
    traces.push_back({choice.name, std::move(outcome->trace)});
  }
  return traces;
}

/// Every controller on every tissue, what people do, and where the contact trembles
/// (docs/control.md), in the world of the config.
class EvaluateControl final : public Verb {
 public:
  [[nodiscard]] const char* name() const override { return "evaluate control"; }
  [[nodiscard]] const char* summary() const override {
    return "controllers in contact: tissues, forces, disturbances, stability";
  }
  [[nodiscard]] const char* example() const override {
    return "tuina evaluate control --html control.html";
  }
  void describe(Options& options) override {
    options.flag("--full", full_, "every combination, four seeds: many minutes");
    std::vector<std::string> names;
    for (const ControlTable& table : control_tables(false, 1)) names.push_back(table.name);
    options.add("--table", table_, "one only").one_of(names);
    options.add("--html", html_, "a page with tables and figures");
    options.add("--figures", figures_, "the figures as SVG files into this folder");
    cells_.describe(options);
  }

  [[nodiscard]] Result<Answer> run(const CommonOptions& common) override {
    const auto folder = std::filesystem::path(html_).parent_path();
    for (const std::filesystem::path& needed : {folder, std::filesystem::path(figures_)}) {
      if (!needed.empty() && !std::filesystem::is_directory(needed))
        return fail(Fault::file, "the folder {} does not exist", needed.string());
    }
    const auto config = effective_config(common);
    if (!config) return tl::unexpected(config.error());
    if (auto opened = cells_.open(common, *config); !opened) return tl::unexpected(opened.error());
    ControlReport report{.full = full_, .seed = common.seed, .realism = config->simulation.realism};
    report.tables = control_tables(full_, common.seed);
    for (ControlTable& table : report.tables) {
      for (ControlRow& row : table.rows) {
        for (ContactExperiment& experiment : row.runs) live_in(*config, experiment);
      }
    }
    if (!table_.empty())
      std::erase_if(report.tables, [&](const auto& table) { return table.name != table_; });
    const unsigned threads = std::clamp(std::thread::hardware_concurrency(), 1U, 8U);
    if (auto done = run_tables(report.tables, cells_, threads, progress_bar(common, "control"));
        !done)
      return tl::unexpected(done.error());
    return cells_.answer([&] { return answer(report); });
  }

 private:
  /// The rest takes seconds and is no cell: whoever makes the tables does it.
  [[nodiscard]] Result<Answer> answer(ControlReport& report) const {
    auto presses = traces_of({.tissue = soft_muscle,
                              .torso_n_per_m = sim::rigid,
                              .duration_s = 5.0,
                              .seed = report.seed});
    if (!presses) return tl::unexpected(presses.error());
    auto rises = traces_of({.force_n = 40.0,
                            .duration_s = 5.0,
                            .shifts = {{.start_s = 2.5,
                                        .by_in_couch = Vector3(0.0, 30_mm, 0.0),
                                        .speed_m_per_s = 0.1}},
                            .seed = report.seed});
    if (!rises) return tl::unexpected(rises.error());
    report.presses = std::move(*presses);
    report.rises = std::move(*rises);
    report.beyond_reach = pull_beyond_reach();
    report.reflex_bounds = reflex_bounds();
    report.force_at_tool = force_at_tool();
    if (auto written = write(report); !written) return tl::unexpected(written.error());
    return Answer{.json = to_json(report), .text = to_text(report)};
  }
  [[nodiscard]] Result<void> write(const ControlReport& report) const {
    if (!html_.empty()) {
      if (auto written = write_file(html_, page_of(report)); !written) return written;
    }
    if (figures_.empty()) return {};
    for (const auto& [name, svg] : figures_of(report)) {
      const auto path = std::filesystem::path(figures_) / (name + ".svg");
      if (auto written = write_file(path, svg); !written) return written;
    }
    return {};
  }

  Cells cells_;
  bool full_ = false;
  std::string table_, html_, figures_;
};

}  // namespace

std::unique_ptr<Verb> make_evaluate_control() {
  return std::make_unique<EvaluateControl>();
}

}  // namespace tuina::app
