// SPDX-License-Identifier: Apache-2.0
#include "apps/tuina/simulated_session.hpp"

#include <chrono>
#include <limits>
#include <thread>

#include "apps/tuina/atlas_source.hpp"
#include "apps/tuina/keyboard.hpp"
#include "tuina/core/file.hpp"
#include "tuina/core/random.hpp"
#include "tuina/core/units.hpp"
#include "tuina/robot/clearance.hpp"
#include "tuina/session/massage_step.hpp"
#include "tuina/session/scan_step.hpp"
#include "tuina/sim/back_contact.hpp"
#include "tuina/sim/laser_scanner.hpp"
#include "tuina/sim/plant.hpp"
#include "tuina/sim/tissue_map.hpp"

namespace tuina::app {
namespace {

class Stopwatch {
 public:
  [[nodiscard]] double seconds() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  }
  [[nodiscard]] double ms() const { return 1e3 * seconds(); }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

/// Where the session believes the couch to be: the scanner-to-robot calibration leaves 2 mm and 0.3
/// degrees.
Transform believed_pose(const Transform& base_from_couch, std::uint64_t seed) {
  constexpr double place_sd_m = 2_mm, turn_sd_rad = 0.3_deg;
  Random random = make_random(seed, "scanner to robot");
  const auto drawn = [&](double sd) {
    const double each = sd / std::sqrt(3.0);
    const double x = gaussian(random, each), y = gaussian(random, each), z = gaussian(random, each);
    return Vector3(x, y, z);
  };
  const Vector3 turn = drawn(turn_sd_rad);
  const Vector3 shift = drawn(place_sd_m);
  Transform error = Transform::Identity();
  error.linear() = Eigen::AngleAxisd(turn.norm(), turn.normalized()).toRotationMatrix();
  error.translation() = shift;
  return error * base_from_couch;
}

std::vector<double> errors_of(const std::vector<Acupoint>& found, const sim::Person& person) {
  std::vector<double> errors_m;
  for (const Acupoint& acupoint : found) {
    double error_m = std::numeric_limits<double>::quiet_NaN();
    for (const Acupoint& truth : person.acupoints) {
      if (truth.name == acupoint.name) error_m = (truth.at_in_couch - acupoint.at_in_couch).norm();
    }
    errors_m.push_back(error_m);
  }
  return errors_m;
}

/// Watches the massage from outside: what the session does, beside what only the simulation knows.
class Witness {
 public:
  Witness(const massage::Plan& plan, const PerArm<robot::ArmModel>& models,
          const Transform& couch_from_base, massage::ZoneMap true_zones)
      : plan_(plan),
        models_(models),
        couch_from_base_(couch_from_base),
        true_zones_(std::move(true_zones)) {}

  void watch(double time_s, const PerArm<session::ArmView>& view, const sim::PlantTruth& truth) {
    constexpr int rows_every_ticks = 5;
    const bool row = ticks_++ % rows_every_ticks == 0;
    if (row) {
      const auto pose = [&](Arm arm) {
        return models_[arm].kinematics(truth.arms[arm].q_rad, truth.rail_m);
      };
      const double apart_m = robot::distance_between_m(models_[Arm::left], pose(Arm::left),
                                                       models_[Arm::right], pose(Arm::right));
      min_arm_distance_m = std::min(min_arm_distance_m, apart_m);
      constexpr double distances_every_s = 0.1;
      if (distances.empty() || time_s - distances.back().time_s >= distances_every_s)
        distances.push_back({time_s, apart_m});
    }
    for (const Arm arm : both_arms) {
      const session::ArmView& seen = view[arm];
      const sim::ContactTruth& contact = truth.arms[arm].contact;
      const bool in_contact = seen.phase == session::ArmPhase::contact;
      std::optional<Technique> technique;
      if (in_contact) technique = plan_.paths[static_cast<std::size_t>(seen.path)].path.technique;
      if (in_contact && seen.target_n > 0.0) count(time_s, arm, seen, contact, *technique);
      if (in_contact) {
        if (!touching_[arm]) touched_[arm] = {};
        feel(touched_[arm], contact, row);
      }
      touching_[arm] = in_contact;
      if (row) {
        trace.push_back({.time_s = time_s,
                         .arm = arm,
                         .technique = technique,
                         .target_n = seen.target_n,
                         .true_force_n = contact.force_n,
                         .measured_force_n = seen.measured_n,
                         .depth_m = contact.depth_m,
                         .tool_in_couch = couch_from_base_ * seen.tool_in_base});
      }
    }
  }
  /// In the present contact of an arm, or its last one.
  [[nodiscard]] const Touched& touched(Arm arm) const { return touched_[arm]; }

  double min_arm_distance_m = std::numeric_limits<double>::infinity();
  std::vector<telemetry::ArmDistance> distances;
  std::vector<telemetry::TraceRow> trace;
  session::ForceErrorSum all;
  std::map<Technique, session::ForceErrorSum> by_technique;

 private:
  void count(double time_s, Arm arm, const session::ArmView& seen, const sim::ContactTruth& contact,
             Technique technique) {
    session::ForceErrorSum& sum = by_technique[technique];
    if (seen.path != last_path_[arm]) sum.begin(), all.begin();
    last_path_[arm] = seen.path;
    sum.add(time_s, seen.target_n, contact.force_n);
    all.add(time_s, seen.target_n, contact.force_n);
  }

  void feel(Touched& touched, const sim::ContactTruth& contact, bool row) const {
    if (contact.force_n > touched.peak_n) {
      touched.peak_n = contact.force_n;
      touched.tissue = contact.tissue;
      touched.at_in_couch = contact.at_in_couch;
    }
    if (!row || contact.force_n <= 0.0) return;
    const massage::Zone zone = true_zones_.at(contact.at_in_couch);
    if (contact.force_n == touched.peak_n) touched.zone = zone;
    const massage::ZoneRule& rule = massage::rule_of(zone);
    touched.over_cap_n = std::max(touched.over_cap_n, contact.force_n - rule.cap_n);
    touched.over_trip_n = std::max(touched.over_trip_n, contact.force_n - rule.trip_n);
  }

  const massage::Plan& plan_;
  const PerArm<robot::ArmModel>& models_;
  Transform couch_from_base_;
  massage::ZoneMap true_zones_;
  long ticks_ = 0;
  PerArm<int> last_path_{.of = {-1, -1}};
  PerArm<bool> touching_ = {};
  PerArm<Touched> touched_;
};

Result<void> massage_person(SessionResult& result, const robot::RobotMount& mount,
                            const Transform& base_from_couch, const SessionOrder& order,
                            const session::Config& config, const CommonOptions& common) {
  const sim::Breathing breathing{.amplitude_m = from_mm(config.simulation.breathing_mm),
                                 .frequency_hz = config.simulation.breathing_hz};
  sim::BackContact contact(
      result.person.skin_in_couch, sim::lay_tissue(result.person, common.seed),
      {.torso_n_per_m = 1e3 * config.simulation.torso_n_per_mm, .breathing = breathing});
  Random arm_errors = make_random(common.seed, "true arms");
  PerArm<robot::ArmTable> true_arms;
  for (const Arm arm : both_arms) {
    true_arms[arm] = sim::draw_arm(robot::thesis_arm(),
                                   {.friction_scale = config.simulation.friction}, arm_errors);
  }
  auto plant = sim::Plant::make(mount, true_arms,
                                {.q_rad = result.ready.ready_rad, .rail_m = result.ready.rail_m},
                                &contact, {.seed = common.seed});
  if (!plant) return tl::unexpected(plant.error());

  const PerArm<robot::ArmModel> models = robot::both_models(robot::thesis_arm(), mount);
  session::MassageStep massage(result.ready.plan, result.ready.jobs, models,
                               {.base_from_couch = base_from_couch,
                                .rail_m = result.ready.rail_m,
                                .standoff_m = from_mm(config.massage.standoff_mm),
                                .force_ceiling_n = config.safety.force_ceiling_n,
                                .steer = config.massage.steer,
                                .adaptive = order.adaptive});
  const auto true_chart =
      massage::BackChart::from(result.person.acupoints, result.person.landmarks);
  if (!true_chart) return tl::unexpected(true_chart.error());
  Witness witness(result.ready.plan, models, base_from_couch.inverse(),
                  massage::ZoneMap(*true_chart, result.person.acupoints, result.person.landmarks));
  const Progress bar = progress_bar(common, "massage");
  // A contact that never ends is a fault of ours, not of the person; it must not hold anyone here.
  const double longest_s = 3.0 * result.ready.plan.duration_s + 60.0;
  std::optional<Keyboard> keyboard;
  if (order.keys) keyboard.emplace();
  const Stopwatch watch;
  double time_s = 0.0;
  while (!massage.finished() && time_s < longest_s) {
    const robot::RobotReading reading = (*plant)->read();
    time_s = reading.time_s;
    constexpr std::uint64_t keys_every_ticks = 10;
    const auto command =
        keyboard && reading.tick % keys_every_ticks == 0 ? keyboard->read() : std::nullopt;
    if (command) {
      massage.obey(*command);
      result.commands.emplace_back(time_s, *command);
    }
    (*plant)->apply(massage.step(reading));
    if ((*plant)->fault() != nullptr) break;
    while (result.touched.size() < massage.performed().size()) {
      result.touched.push_back(witness.touched(massage.performed()[result.touched.size()].arm));
    }
    witness.watch(time_s, massage.view(), (*plant)->truth());
    if (bar && reading.tick % 500 == 0) bar(std::min(0.999, time_s / result.ready.plan.duration_s));
    if (order.real_time) {
      std::this_thread::sleep_for(std::chrono::duration<double>(time_s - watch.seconds()));
    }
  }
  if (bar) bar(1.0);
  if ((*plant)->fault() != nullptr) return fail(Fault::device, "the robot: {}", (*plant)->fault());
  if (!massage.finished()) {
    return fail(Fault::device, "the massage was not done after {:.0f} s; {:.0f} s were planned",
                time_s, result.ready.plan.duration_s);
  }
  result.massage_s = time_s;
  result.real_time_factor = time_s / watch.seconds();
  result.performed = massage.performed();
  result.decisions = massage.decisions();
  result.stops = massage.stops();
  result.min_arm_distance_m = witness.min_arm_distance_m;
  result.distances = std::move(witness.distances);
  result.force = witness.all.errors();
  for (const auto& [technique, sum] : witness.by_technique)
    result.techniques[technique] = sum.errors();
  result.trace = std::move(witness.trace);
  return {};
}

}  // namespace

std::optional<double> tool_to_acupoint_m(const SessionResult& result, std::size_t performed) {
  const auto& path =
      result.ready.plan.paths[static_cast<std::size_t>(result.performed[performed].path)].path;
  const Touched& touched = result.touched[performed];
  if (path.technique != Technique::press || touched.peak_n <= 0.0) return std::nullopt;
  for (const Acupoint& truth : result.person.acupoints) {
    if (truth.name == path.acupoints.front())
      return (touched.at_in_couch - truth.at_in_couch).norm();
  }
  return std::nullopt;
}

double scan_to_touch_s(const SessionResult& result) {
  double first_s = result.massage_s;
  for (const session::Performed& done : result.performed) first_s = std::min(first_s, done.begin_s);
  const double compute_ms = result.scan.compute_ms + result.locate_ms + result.plan_ms;
  return result.scan.sweep_s + 1e-3 * compute_ms + first_s;
}

Result<massage::PlanOptions> plan_options(const session::Config& config,
                                          const std::string& no_go_file) {
  massage::PlanOptions options{.force_scale = config.massage.force_scale,
                               .force_ceiling_n = config.safety.force_ceiling_n,
                               .transfers = {.standoff_m = from_mm(config.massage.standoff_mm)}};
  if (no_go_file.empty()) return options;
  auto no_go = massage::read_no_go(no_go_file);
  if (!no_go) return tl::unexpected(no_go.error());
  options.no_go = std::move(*no_go);
  return options;
}

Result<SessionResult> run_simulated_session(const SessionOrder& order,
                                            const session::Config& config,
                                            const CommonOptions& common) {
  SessionResult result;
  // Nothing is done, not even a scan, before the questions are answered.
  result.consent_toml = session::consent_form("the simulated person", "no");
  if (!order.consent.empty()) {
    constexpr std::size_t largest_bytes = 1 << 20;
    auto text = read_file(order.consent, largest_bytes);
    if (!text) return tl::unexpected(text.error());
    result.consent_toml = std::move(*text);
  }
  const auto consent = session::parse_consent(
      result.consent_toml, order.consent.empty() ? "the simulated person" : order.consent);
  if (!consent) return tl::unexpected(consent.error());
  result.consent = *consent;
  auto person = sim::parse_person(order.person, order.position, common.seed);
  if (!person) return tl::unexpected(person.error());
  result.person = std::move(*person);
  const auto programme = massage::load_programme(order.programme);
  if (!programme) return tl::unexpected(programme.error());
  const auto options = plan_options(config, order.no_go);
  if (!options) return tl::unexpected(options.error());
  const auto atlas = open_atlas(order.atlas);
  if (!atlas) return tl::unexpected(atlas.error());

  sim::LaserScanner scanner(result.person.skin_in_couch, result.person.position,
                            {.amplitude_m = from_mm(config.simulation.breathing_mm),
                             .frequency_hz = config.simulation.breathing_hz},
                            common.seed, {.room_light_dn = config.simulation.room_light_dn});
  const auto calibration = sim::believed_calibration(scanner.true_calibration(), common.seed);
  auto scan = scanner::scan_sweep(scanner, scanner, calibration, session::sweep_options(config),
                                  progress_bar(common, "scan"));
  if (!scan) return tl::unexpected(scan.error());
  result.scan = std::move(*scan);
  result.scan_error_m =
      sim::compare_with_truth(result.scan.cloud_in_couch, result.person.skin_in_couch).rms_error_m;

  const Progress map_bar = progress_bar(common, "map");
  const Stopwatch map_watch;
  const auto back = body::fit_back(result.scan.cloud_in_couch, {.position = order.position});
  if (!back) return tl::unexpected(back.error());
  auto located = body::locate_acupoints(*back, *atlas, order.method);
  if (!located) return tl::unexpected(located.error());
  result.located = std::move(*located);
  result.locate_ms = map_watch.ms();
  if (map_bar) map_bar(1.0);
  result.acupoint_errors_m = errors_of(result.located.acupoints, result.person);

  const Stopwatch plan_watch;
  auto plan = massage::plan(*back, result.located.acupoints, result.located.landmarks, *programme,
                            *options);
  if (!plan) return tl::unexpected(plan.error());
  const robot::RobotMount mount = robot::mount_for(back->position());
  const Transform base_from_couch = believed_pose(mount.base_from_couch, common.seed);
  const PerArm<robot::ArmModel> models = robot::both_models(robot::thesis_arm(), mount);
  auto ready = session::make_ready(std::move(*plan), *back, mount, models, base_from_couch,
                                   from_mm(config.massage.standoff_mm));
  if (!ready) return tl::unexpected(ready.error());
  result.ready = std::move(*ready);
  result.plan_ms = plan_watch.ms();

  if (auto done = massage_person(result, mount, base_from_couch, order, config, common); !done) {
    return tl::unexpected(done.error());
  }
  return result;
}

}  // namespace tuina::app
