// SPDX-License-Identifier: Apache-2.0
#include "tuina/massage/plan.hpp"

#include <chrono>
#include <filesystem>

#include "apps/tuina/verbs.hpp"
#include "tuina/core/io/file.hpp"
#include "tuina/core/io/surface_file.hpp"
#include "tuina/core/units.hpp"
#include "tuina/record/acupoint_file.hpp"
#include "tuina/record/plan_file.hpp"
#include "tuina/session/lay_plan.hpp"
#include "tuina/telemetry/report/page.hpp"

namespace tuina::app {
namespace {

/// The back as the report of a session shows it, before anything was done.
std::string picture_of(const PointCloud& scan_in_couch, BodyPosture position,
                       const std::vector<Acupoint>& acupoints, const massage::Plan& plan) {
  telemetry::ReportData data{.position = position, .scan_in_couch = scan_in_couch};
  for (const Acupoint& point : acupoints) data.acupoints.push_back({.acupoint = point});
  for (const massage::PlannedPath& planned : plan.paths)
    data.paths.push_back({.arm = planned.arm, .path = planned.path});
  return telemetry::back_picture(data);
}

std::string text_of(const record::PlanFile& file, BodyPosture position) {
  const massage::Plan& plan = file.plan;
  std::string text =
      fmt::format("{}: {} paths, {:.0f} s, {}\n", plan.programme, plan.paths.size(),
                  plan.duration_s, file.reachable ? "all within reach" : "not all within reach");
  for (const massage::PlannedPath& planned : plan.paths) {
    double peak_n = 0.0;
    for (const ContactPoint& point : planned.path.points) peak_n = std::max(peak_n, point.force_n);
    text += fmt::format("{:6.1f} s  {:<5}  {:<24} {:5.1f} N  {}\n", planned.start_s,
                        name_of(planned.arm), planned.path.name, peak_n,
                        massage::name_of(planned.zone));
  }
  for (const Sentence& note : plan.notes) text += fmt::format("note: {}\n", note.words);
  const bool at_once = plan.min_tool_distance_m > 0.0;  // no two paths run together otherwise
  text += fmt::format(
      "the arms stay {:.0f} mm apart{}; {:.0f} mm from the {}, {:.0f} mm from the robot's body; "
      "planned in {:.0f} ms",
      to_mm(file.min_arm_distance_m),
      at_once ? fmt::format(", their tools {:.0f} mm", to_mm(plan.min_tool_distance_m)) : "",
      to_mm(file.clear[robot::Surrounding::couch]),
      position == BodyPosture::sitting ? "chair" : "bed",
      to_mm(file.clear[robot::Surrounding::body]), file.compute_ms);
  return text;
}

class PlanVerb final : public Verb {
 public:
  [[nodiscard]] const char* name() const override { return "plan"; }
  [[nodiscard]] const char* summary() const override {
    return "lay a programme onto a scanned back, as contact paths of two arms";
  }
  [[nodiscard]] const char* example() const override {
    return "tuina plan scan.ply acupoints.json --programme relax --out plan.json --picture "
           "plan.svg";
  }
  void describe(Options& options) override {
    options.add("scan", scan_, "the person's surface: PLY or PCD, metres").required();
    options.add("acupoints", acupoints_, "acupoints.json of that scan, as `tuina map` writes")
        .required();
    std::string names;
    for (const massage::ShippedProgramme& shipped : massage::shipped_programmes()) {
      names += (names.empty() ? "" : ", ") + std::string(shipped.name);
    }
    options.add("--programme", programme_, "a file, or one of " + names).show_default();
    add_robot_option(options, robot_);
    options.add("--no-go", no_go_, "a TOML file with what must not be touched");
    options.add("--picture", picture_, "draw acupoints and paths on the back, as SVG");
  }

  [[nodiscard]] Result<Answer> run(const CommonOptions& common) override {
    const auto config = effective_config(common);
    if (!config) return tl::unexpected(config.error());
    if (const auto good = check_files(common.out); !good) return tl::unexpected(good.error());
    const auto model = robot::load_robot(robot_);
    if (!model) return tl::unexpected(model.error());
    const auto programme = massage::load_programme(programme_);
    if (!programme) return tl::unexpected(programme.error());
    const auto options = session::plan_options(*config, no_go_);
    if (!options) return tl::unexpected(options.error());
    const auto map = record::read_acupoints(acupoints_);
    if (!map) return tl::unexpected(map.error());
    const auto scan = read_surface(scan_);
    if (!scan) return tl::unexpected(scan.error());

    const auto start = std::chrono::steady_clock::now();
    const auto back = body::fit_back(scan->cloud, {.position = map->position});
    if (!back)
      return tl::unexpected(Error{back.error().fault, scan_ + ": " + back.error().message});
    const auto ready =
        session::lay_plan(*back, map->acupoints, map->landmarks, *programme, *model, *options);
    if (!ready) return tl::unexpected(ready.error());
    const std::chrono::duration<double, std::milli> taken =
        std::chrono::steady_clock::now() - start;

    const record::PlanFile file = record::plan_file_of(*ready, taken.count());
    if (!picture_.empty()) {
      const std::string svg = picture_of(scan->cloud, back->position(), map->acupoints, file.plan);
      if (auto written = write_file(picture_, svg); !written)
        return tl::unexpected(written.error());
    }
    return Answer{.json = record::to_json(file), .text = text_of(file, back->position())};
  }

 private:
  [[nodiscard]] Result<void> check_files(const std::string& out) const {
    if (!picture_.empty() && std::filesystem::path(picture_).extension() != ".svg")
      return fail(Fault::usage, "--picture {}: is drawn as SVG; NAME.svg is needed", picture_);
    for (const std::string& written : {out, picture_}) {
      if (auto good = check_folder_of(written); !good) return good;
    }
    return {};
  }

  std::string scan_;
  std::string acupoints_;
  std::string programme_ = "relax";
  std::string robot_ = "thesis";
  std::string no_go_;
  std::string picture_;
};

}  // namespace

std::unique_ptr<Verb> make_plan() {
  return std::make_unique<PlanVerb>();
}

}  // namespace tuina::app
