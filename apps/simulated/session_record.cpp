// SPDX-License-Identifier: Apache-2.0
#include "apps/simulated/session_record.hpp"

#include <cmath>
#include <nlohmann/json.hpp>

#include "apps/simulated/session_order.hpp"
#include "apps/simulated/session_tables.hpp"
#include "tuina/core/io/file.hpp"
#include "tuina/core/io/json_fault.hpp"
#include "tuina/core/io/surface_file.hpp"
#include "tuina/core/units.hpp"
#include "tuina/motion/arm_separation.hpp"
#include "tuina/record/plan_file.hpp"
#include "tuina/robot/arm_model.hpp"
#include "tuina/tissue/stiffness_map.hpp"

namespace tuina::app {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using telemetry::ReportData;

double number(const json& node, const char* key) {
  return node.at(key).get<double>();
}
std::string word(const json& node, const char* key) {
  return node.at(key).get<std::string>();
}
Vector3 three(const json& node) {
  const auto v = node.get<std::array<double, 3>>();
  return {v[0], v[1], v[2]};
}
Arm arm_of(const json& node) {
  return word(node, "arm") == name_of(Arm::right) ? Arm::right : Arm::left;
}

void take_acupoints(const json& session, ReportData& data) {
  for (const json& point : session.at("acupoints").at("points")) {
    const json& error = point.at("error_mm");
    data.acupoints.push_back(
        {.acupoint = {.name = word(point, "name"),
                      .at_in_couch = three(point.at("position_m")),
                      .normal_in_couch = three(point.at("normal")),
                      .uncertainty_m = from_mm(number(point, "uncertainty_mm"))},
         .error_m = error.is_null() ? std::nullopt : std::optional(from_mm(error.get<double>()))});
  }
}

void take_conduct(const json& session, const massage::Plan& plan, ReportData& data) {
  for (const json& done : session.at("massage").at("performed")) {
    const std::string contact_fault = word(done, "trouble");
    data.paths.push_back({.arm = arm_of(done),
                          .begin_s = number(done, "begin_s"),
                          .path = plan.paths.at(done.at("path").get<std::size_t>()).path,
                          .end_s = number(done, "end_s"),
                          .contact_fault = contact_fault == "none" ? "" : contact_fault});
  }
  const json& techniques = session.at("massage").at("techniques");
  for (const Technique technique : all_techniques) {
    // A version that knew fewer techniques may have written the session.
    const auto errors = techniques.find(name_of(technique));
    if (errors == techniques.end() || errors->at("rmse_n").is_null()) continue;
    data.forces.push_back({.technique = technique,
                           .rmse_n = number(*errors, "rmse_n"),
                           .peak_n = number(*errors, "peak_n")});
  }
  for (const json& made : session.at("decisions")) {
    data.decisions.push_back({.time_s = number(made, "time_s"),
                              .arm = arm_of(made),
                              .path = word(made, "path"),
                              .rule = word(made, "rule"),
                              .reason = word(made, "reason"),
                              .from_n = number(made, "from_n"),
                              .to_n = number(made, "to_n")});
  }
  for (const json& stop : session.at("stops"))
    data.stops.push_back({.time_s = number(stop, "time_s"), .cause = word(stop, "cause")});
}

void take_tissue(const json& session, ReportData& data) {
  const json& stiffness = session.at("stiffness");
  const json& places = stiffness.at("places");
  data.stiffness_force_n = number(stiffness, "force_n");
  std::vector<tissue::Visit> visits;
  std::size_t next = 0;
  for (const json& felt : session.at("tissue")) {
    const json& place = places.at(next++);
    const json& ci95 = felt.at("ci95");
    const Vector3 at = three(place.at("position_m"));
    const double k = number(place, "stiffness_n_per_mm");
    const double k_ci95 = number(place, "ci95_n_per_mm");
    const bool converged = felt.at("converged").get<bool>();
    data.tissue.push_back(
        {.name = word(felt, "name"),
         .at_in_couch = at,
         .estimate = {.tissue = {number(felt, "alpha_n"), 1e3 * number(felt, "beta_per_mm")},
                      .alpha_ci95_n = number(ci95, "alpha_n"),
                      .beta_ci95_per_m = 1e3 * number(ci95, "beta_per_mm"),
                      .presses = felt.at("presses").get<int>(),
                      .converged = converged,
                      .converged_after_s = converged ? number(felt, "converged_after_s") : 0.0},
         .truth =
             TangentTissue{number(felt, "true_alpha_n"), 1e3 * number(felt, "true_beta_per_mm")},
         .tissue_class = word(felt, "class"),
         .class_probability = number(felt, "class_probability"),
         .stiffness_n_per_mm = k,
         .stiffness_ci95_n_per_mm = k_ci95});
    if (place.at("mapped").get<bool>())
      visits.push_back({word(felt, "name"), {at, std::log(1e3 * k), k_ci95 / (1.96 * k)}});
  }
  std::vector<tissue::FeltPlace> last;
  for (const tissue::Visit& visit : tissue::last_visits(visits)) last.push_back(visit.felt);
  data.stiffness_at = [map = tissue::StiffnessMap(last)](const Vector3& at_in_couch) {
    const auto value = map.at(at_in_couch);
    return value ? std::optional(
                       telemetry::MappedStiffness{1e-3 * std::exp(value->log_stiffness), value->sd})
                 : std::nullopt;
  };
  for (const json& change : stiffness.at("changes")) {
    data.changes.push_back({.name = word(change, "name"),
                            .before_n_per_mm = number(change, "before_n_per_mm"),
                            .after_n_per_mm = number(change, "after_n_per_mm"),
                            .detectable = 0.01 * number(change, "detectable_percent"),
                            .detected = change.at("detected").get<bool>()});
  }
  const json& condition = session.at("body_condition");
  if (condition.at("presses").get<int>() > 0) {
    data.condition = {{.slim = number(condition, "slim"),
                       .medium = number(condition, "medium"),
                       .hefty = number(condition, "hefty"),
                       .female = number(condition, "female")}};
  }
}

void take_numbers(const json& session, ReportData& data) {
  const json& scan = session.at("scan");
  const double compute_ms = number(scan, "compute_ms") +
                            number(session.at("acupoints"), "compute_ms") +
                            number(session.at("plan"), "compute_ms");
  data.numbers = {
      {"scan error", fmt::format("{:.2f}", number(scan, "rms_error_mm")), "mm",
       "RMS distance of the scan from the true surface"},
      {"scan to plan", fmt::format("{:.2f}", 1e-3 * compute_ms), "s",
       "computing time, the sweep itself not counted"},
      {"simulation", fmt::format("{:.0f}", number(session.at("massage"), "real_time_factor")),
       "times real time", "two arms at 1 kHz, physics at 4 kHz"}};
}

/// The arms as the session believed them to stand, four times a second.
std::vector<telemetry::ArmsPose> poses_of(const std::vector<JointRow>& joints,
                                          const robot::RobotPlacement& placement,
                                          const Transform& base_from_couch) {
  constexpr double every_s = 0.25;
  const auto models = robot::both_models(placement.arm, placement.mount);
  const Transform couch_from_base = base_from_couch.inverse();
  std::vector<telemetry::ArmsPose> poses;
  for (const JointRow& row : joints) {
    if (!poses.empty() && row.time_s - poses.back().time_s < every_s - 1e-6) continue;
    telemetry::ArmsPose pose{.time_s = row.time_s};
    for (const Arm arm : both_arms) {
      const robot::ArmModel& model = models[arm];
      if (row.q_rad[arm].size() != model.joints()) return {};
      const auto origins = model.kinematics(row.q_rad[arm], row.rail_m).origins_in_base;
      for (int i = 0; i < model.joints(); ++i) {
        const auto link = static_cast<std::size_t>(i);
        const bool last = i + 1 == model.joints();
        const double radius_m =
            last ? model.table().tool_radius_m : model.table().links[link].radius_m;
        pose.links[arm].push_back(
            {couch_from_base * origins[link], couch_from_base * origins[link + 1], radius_m});
      }
    }
    poses.push_back(std::move(pose));
  }
  return poses;
}

}  // namespace

Result<ReportData> read_record(const fs::path& folder) {
  const std::string file = (folder / "session.json").string();
  const auto text = read_file(file);
  if (!text) return tl::unexpected(text.error());
  auto config = read_file(folder / "config.toml");
  if (!config) return tl::unexpected(config.error());
  auto scan = read_surface(folder / "scan.ply");
  if (!scan) return tl::unexpected(scan.error());
  const auto plan = record::read_plan(folder / "plan.json");
  if (!plan) return tl::unexpected(plan.error());
  auto trace = read_trace(folder / "trace.csv");
  if (!trace) return tl::unexpected(trace.error());
  const auto joints = read_joints(folder / "joints.csv");
  if (!joints) return tl::unexpected(joints.error());
  auto distances = read_distances(folder / "distances.csv");
  if (!distances) return tl::unexpected(distances.error());
  try {
    const json session = json::parse(*text);
    ReportData data{.person = word(session, "person"),
                    .position = word(session, "position") == name_of(BodyPosture::prone)
                                    ? BodyPosture::prone
                                    : BodyPosture::sitting,
                    .programme = word(session.at("order"), "programme"),
                    .seed = session.at("seed").get<std::uint64_t>(),
                    .duration_s = number(session.at("massage"), "duration_s"),
                    .scan_in_couch = std::move(scan->cloud),
                    .trace = std::move(*trace),
                    .distances = std::move(*distances),
                    .stopping_distance_m = motion::stopping_arm_distance_m,
                    .config_toml = std::move(*config),
                    .version = word(session, "version")};
    take_acupoints(session, data);
    take_conduct(session, plan->plan, data);
    take_tissue(session, data);
    take_numbers(session, data);
    const json& placed = session.at("base_from_couch");
    Transform base_from_couch = Transform::Identity();
    for (int row = 0; row < 3; ++row)
      base_from_couch.linear().row(row) = three(placed.at("rotation").at(row));
    base_from_couch.translation() = three(placed.at("translation_m"));
    std::vector<Acupoint> acupoints;
    for (const auto& shown : data.acupoints) acupoints.push_back(shown.acupoint);
    const auto model = robot::load_robot(session.at("order").value("robot", "thesis"));
    if (!model) {
      return fail(Fault::bad_input, "{}: order.robot: {}", file, model.error().message);
    }
    data.poses = poses_of(
        *joints, robot::place_robot(*model, data.position, session::head_at_plus_y(acupoints)),
        base_from_couch);
    return data;
  } catch (const json::exception& fault) {
    return tl::unexpected(json_fault(fault, *text, file, "the record of a session"));
  } catch (const std::out_of_range&) {
    return fail(Fault::bad_input, "{}: a path was performed that plan.json does not have", file);
  }
}

}  // namespace tuina::app
