// SPDX-License-Identifier: Apache-2.0
#include "tuina/record/session_report.hpp"

#include <cmath>

#include "tuina/core/io/file.hpp"
#include "tuina/core/io/surface_file.hpp"
#include "tuina/core/units.hpp"
#include "tuina/record/plan_file.hpp"
#include "tuina/record/session_file.hpp"
#include "tuina/record/session_tables.hpp"
#include "tuina/robot/arm_model.hpp"
#include "tuina/safety/arm_separation.hpp"
#include "tuina/session/run.hpp"
#include "tuina/tissue/stiffness_map.hpp"

namespace tuina::record {
namespace {

using telemetry::ReportData;

/// The map of the presses that count for it, the last at each place.
std::function<std::optional<telemetry::MappedStiffness>(const Vector3&)> stiffness_map_of(
    const std::vector<telemetry::FeltTissue>& felt) {
  std::vector<tissue::Visit> visits;
  for (const telemetry::FeltTissue& one : felt) {
    if (!one.mapped) continue;
    const double k = one.stiffness_n_per_mm;
    visits.push_back(
        {one.name, {one.at_in_couch, std::log(1e3 * k), one.stiffness_ci95_n_per_mm / (1.96 * k)}});
  }
  std::vector<tissue::FeltPlace> last;
  for (const tissue::Visit& visit : tissue::last_visits(visits)) last.push_back(visit.felt);
  return [map = tissue::StiffnessMap(last)](const Vector3& at_in_couch) {
    const auto value = map.at(at_in_couch);
    return value ? std::optional(
                       telemetry::MappedStiffness{1e-3 * std::exp(value->log_stiffness), value->sd})
                 : std::nullopt;
  };
}

std::vector<telemetry::KeyNumber> numbers_of(const SessionFile& file) {
  const double compute_ms = file.scan.compute_ms + file.acupoints.compute_ms + file.plan.compute_ms;
  std::vector<telemetry::KeyNumber> numbers;
  if (file.simulated())
    numbers.push_back({"scan error", fmt::format("{:.2f}", to_mm(file.scan.rms_error_m)), "mm",
                       "RMS distance of the scan from the true surface"});
  numbers.push_back({"scan to plan", fmt::format("{:.2f}", 1e-3 * compute_ms), "s",
                     "computing time, the sweep itself not counted"});
  if (file.simulated())
    numbers.push_back({"simulation", fmt::format("{:.0f}", file.massage.real_time_factor),
                       "times real time", "two arms at 1 kHz, physics at 4 kHz"});
  if (!file.devices) return numbers;
  std::uint64_t lost = 0, late = 0;
  std::string wrists;
  for (const Arm arm : both_arms) {
    const DeviceRecord::Traffic& traffic = file.devices->traffic[arm];
    lost += traffic.lost, late += traffic.late + traffic.rejected;
    if (!traffic.wrist.empty())
      wrists += fmt::format("; {} wrist sensor {}", name_of(arm), traffic.wrist);
  }
  numbers.push_back({"arms", fmt::format("{}", lost), "states lost",
                     fmt::format("{}; {} more late or rejected{}; camera and turntable: {}",
                                 file.devices->arms, late, wrists, file.devices->scanner)});
  return numbers;
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

telemetry::PerformedPath shown(const PerformedEntry& done, const ContactPath& path) {
  return {.arm = done.arm,
          .begin_s = done.begin_s,
          .path = path,
          .end_s = done.end_s,
          .contact_fault = done.contact_fault == "none" ? "" : done.contact_fault,
          .programme_n = done.programme_n,
          .lowered_by = done.lowered_by,
          .ordered_n = done.ordered_n,
          .given_n = done.compared_n(),
          .why = done.told_why()};
}

}  // namespace

Result<ReportData> read_record(const std::filesystem::path& folder) {
  const std::string name = (folder / "session.json").string();
  const auto text = read_file(name);
  if (!text) return tl::unexpected(text.error());
  auto config = read_file(folder / "config.toml");
  if (!config) return tl::unexpected(config.error());
  auto scan = read_surface(folder / "scan.ply");
  if (!scan) return tl::unexpected(scan.error());
  const auto plan = read_plan(folder / "plan.json");
  if (!plan) return tl::unexpected(plan.error());
  auto trace = read_trace(folder / "trace.csv");
  if (!trace) return tl::unexpected(trace.error());
  const auto joints = read_joints(folder / "joints.csv");
  if (!joints) return tl::unexpected(joints.error());
  auto distances = read_distances(folder / "distances.csv");
  if (!distances) return tl::unexpected(distances.error());
  const auto file = parse_session(*text, name);
  if (!file) return tl::unexpected(file.error());
  const auto model = robot::load_robot(file->order.robot);
  if (!model) return fail(Fault::bad_input, "{}: order.robot: {}", name, model.error().message);

  ReportData data{.person = file->person,
                  .position = file->position,
                  .programme = plan->plan.programme,
                  .seed = file->seed,
                  .simulated = file->simulated(),
                  .duration_s = file->massage.duration_s,
                  .scan_in_couch = std::move(scan->cloud),
                  .acupoints = file->acupoints.points,
                  .trace = std::move(*trace),
                  .force_rmse_n = file->massage.force.rmse_n,
                  .forces = file->massage.techniques,
                  .tissue = file->tissue,
                  .stiffness_force_n = file->stiffness_force_n,
                  .stiffness_at = stiffness_map_of(file->tissue),
                  .changes = file->changes,
                  .decisions = file->decisions,
                  .distances = std::move(*distances),
                  .stopping_distance_m = safety::stopping_arm_distance_m,
                  .stops = file->stops,
                  .rescans_s = file->rescans_s,
                  .numbers = numbers_of(*file),
                  .config_toml = std::move(*config),
                  .version = file->version};
  for (const Sentence& note : file->plan.notes)
    (massage::tells_left_out(note) ? data.left_out : data.plan_notes).push_back(note);
  if (file->condition_presses > 0) data.condition = file->condition;
  for (const PerformedEntry& done : file->massage.performed) {
    if (done.path >= plan->plan.paths.size())
      return fail(Fault::bad_input, "{}: path {} was performed, which plan.json does not have",
                  name, done.path);
    data.paths.push_back(shown(done, plan->plan.paths[done.path].path));
  }
  std::vector<Acupoint> acupoints;
  for (const auto& shown : data.acupoints) acupoints.push_back(shown.acupoint);
  data.poses = poses_of(
      *joints, robot::place_robot(*model, data.position, session::head_at_plus_y(acupoints)),
      file->base_from_couch);
  return data;
}

}  // namespace tuina::record
