// SPDX-License-Identifier: Apache-2.0
#include "apps/simulated/simulated_session.hpp"

#include <algorithm>
#include <thread>

#include "apps/cli/stopwatch.hpp"
#include "apps/simulated/keyboard.hpp"
#include "apps/simulated/truth_recorder.hpp"
#include "tuina/core/io/file.hpp"
#include "tuina/core/random.hpp"
#include "tuina/core/units.hpp"
#include "tuina/robot/clearance.hpp"
#include "tuina/session/massage_step.hpp"
#include "tuina/sim/person/tissue_map.hpp"
#include "tuina/sim/robot/back_contact.hpp"
#include "tuina/sim/robot/plant.hpp"

namespace tuina::app {
namespace {

/// The world of one session: a person under a robot, and somebody who sees the truth.
class Room {
 public:
  [[nodiscard]] static Result<std::unique_ptr<Room>> make(const SessionSetting& setting,
                                                          const sim::Person& person,
                                                          const Preparation& prepared) {
    const motion::ReadyPlan& ready = prepared.ready;
    const auto chart = massage::BackChart::from(person.acupoints, person.landmarks);
    if (!chart) return tl::unexpected(chart.error());
    auto room = std::unique_ptr<Room>(
        new Room(setting, person, prepared.placement,
                 massage::ZoneMap(*chart, person.acupoints, person.landmarks)));
    Random arm_errors = make_random(setting.common.seed, "true arms");
    PerArm<robot::ArmTable> true_arms;
    for (const Arm arm : both_arms) {
      true_arms[arm] =
          sim::draw_arm(prepared.placement.arm,
                        {.friction_scale = setting.config.simulation.friction}, arm_errors);
    }
    auto plant = sim::Plant::make(prepared.placement, true_arms,
                                  {.q_rad = ready.ready_rad, .rail_m = ready.rail_m},
                                  &room->contact_, {.seed = setting.common.seed});
    if (!plant) return tl::unexpected(plant.error());
    room->plant_ = std::move(*plant);
    return room;
  }

  /// Carries a plan out, and then stands still for `rest_s`; what is performed goes to `result`.
  [[nodiscard]] Result<void> carry_out(const motion::ReadyPlan& ready, double rest_s,
                                       SessionResult& result);

  /// The last plan was broken off because the person lies elsewhere.
  [[nodiscard]] bool wants_scan() const { return wants_scan_; }
  /// How far the person has moved from where the session began.
  [[nodiscard]] Vector3 shifted_in_couch() const {
    const auto& shift = setting_.config.simulation;
    const bool moved = shift.shift_mm != 0.0 && time_s_ >= shift.shift_at_s;
    return moved ? Vector3(from_mm(shift.shift_mm) * contact_.mean_normal_in_couch())
                 : Vector3(Vector3::Zero());
  }

  Witness witness;

 private:
  Room(const SessionSetting& setting, const sim::Person& person, const robot::RobotPlacement& robot,
       massage::ZoneMap true_zones)
      : witness(models_, mount_.obstacles, believed_base_from_couch(setting, robot.mount).inverse(),
                std::move(true_zones),
                some_skin(person.skin_in_couch, robot.mount.base_from_couch)),
        setting_(setting),
        mount_(robot.mount),
        models_(robot::both_models(robot.arm, mount_)),
        contact_(person.skin_in_couch, sim::lay_tissue(person, setting.common.seed),
                 {.torso_n_per_m = 1e3 * setting.config.simulation.torso_n_per_mm,
                  .breathing = {.amplitude_m = from_mm(setting.config.simulation.breathing_mm),
                                .frequency_hz = setting.config.simulation.breathing_hz}}) {
    const auto& simulation = setting.config.simulation;
    if (simulation.shift_mm == 0.0) return;
    contact_.add_shift(
        {.start_s = simulation.shift_at_s,
         .by_in_couch = from_mm(simulation.shift_mm) * contact_.mean_normal_in_couch(),
         .speed_m_per_s = 0.05,
         .acceleration_m_per_s2 = 0.5});
  }

  const SessionSetting& setting_;
  robot::RobotMount mount_;
  PerArm<robot::ArmModel> models_;
  sim::BackContact contact_;
  std::unique_ptr<sim::Plant> plant_;
  bool wants_scan_ = false;
  double time_s_ = 0.0;
};

Result<void> Room::carry_out(const motion::ReadyPlan& ready, double rest_s, SessionResult& result) {
  const session::Config& config = setting_.config;
  const SessionOrder& order = setting_.order;
  session::MassageStep massage(ready.plan, ready.jobs, models_,
                               {.base_from_couch = believed_base_from_couch(setting_, mount_),
                                .rail_m = ready.rail_m,
                                .standoff_m = from_mm(config.massage.standoff_mm),
                                .force_ceiling_n = config.safety.force_ceiling_n,
                                .steer = config.massage.steer,
                                .adaptive = order.adaptive,
                                .obstacles = mount_.obstacles});
  witness.follow(ready.plan);
  const Progress bar = progress_bar(setting_.common, "massage");
  // A contact that never ends is a fault of ours, not of the person; it must not hold anyone here.
  const double began_s = time_s_, max_duration_s = 3.0 * ready.plan.duration_s + 60.0;
  const std::size_t performed_before = result.touched.size();
  std::optional<Keyboard> keyboard;
  if (order.keys) keyboard.emplace();
  const Stopwatch watch;
  double ended_s = -1.0;
  while (ended_s < 0.0 || time_s_ - ended_s < rest_s) {
    const robot::RobotReading reading = plant_->read();
    time_s_ = reading.time_s;
    constexpr std::uint64_t keys_every_ticks = 10;
    const auto obey = [&](session::LiveCommand command) {
      massage.obey(command);
      result.commands.emplace_back(time_s_, command);
    };
    const std::size_t given = result.commands.size();
    if (given < order.commands.size() && time_s_ >= order.commands[given].first) {
      obey(order.commands[given].second);
    }
    if (keyboard && reading.tick % keys_every_ticks == 0) {
      if (const auto command = keyboard->read()) obey(*command);
    }
    const robot::RobotCommand torques = massage.step(reading);
    constexpr std::uint64_t joints_every_ticks = 50;
    if (reading.tick % joints_every_ticks == 0) {
      result.joints.push_back(
          {.time_s = time_s_,
           .rail_m = reading.rail_m,
           .q_rad = {.of = {reading.arms[Arm::left].q_rad, reading.arms[Arm::right].q_rad}},
           .torque_nm = torques.torque_nm});
    }
    plant_->apply(torques);
    if (plant_->fault() != nullptr) return fail(Fault::device, "the robot: {}", plant_->fault());
    while (result.touched.size() - performed_before < massage.performed().size()) {
      const auto next = result.touched.size() - performed_before;
      result.touched.push_back(witness.touched(massage.performed()[next].arm));
    }
    witness.watch(time_s_, massage.view(), plant_->truth(),
                  mount_.base_from_couch.linear() * shifted_in_couch());
    if (ended_s < 0.0 && massage.finished()) {
      ended_s = time_s_;
      if (!massage.wants_scan()) break;
    }
    const double past_s = time_s_ - began_s;
    if (ended_s < 0.0 && past_s >= max_duration_s) {
      return fail(Fault::device, "the massage was not done after {:.0f} s; {:.0f} s were planned",
                  past_s, ready.plan.duration_s);
    }
    if (bar && reading.tick % 500 == 0) bar(std::min(0.999, past_s / ready.plan.duration_s));
    if (order.real_time)
      std::this_thread::sleep_for(std::chrono::duration<double>(past_s - watch.seconds()));
  }
  if (bar) bar(1.0);
  wants_scan_ = massage.wants_scan();
  result.massage_s = time_s_;
  result.compute_s += watch.seconds();
  result.performed.insert(result.performed.end(), massage.performed().begin(),
                          massage.performed().end());
  result.decisions.insert(result.decisions.end(), massage.decisions().begin(),
                          massage.decisions().end());
  result.stops = massage.stops();
  return {};
}

/// Puts what earlier plans have done before the paths of the last one, so that one plan tells all.
void join(SessionResult& result, std::vector<massage::PlannedPath> done_before) {
  auto& paths = result.ready.plan.paths;
  paths.insert(paths.begin(), done_before.begin(), done_before.end());
}

/// After a plan was broken off: keeps of it what was performed, and says which of it is done.
std::vector<std::string> set_aside(SessionResult& result, std::size_t from_performed,
                                   std::size_t from_decision,
                                   std::vector<massage::PlannedPath>& kept) {
  std::vector<std::string> done;
  std::vector<int> place(result.ready.plan.paths.size(), -1);
  const auto keep = [&](int path) {
    int& at = place[static_cast<std::size_t>(path)];
    if (at < 0) {
      at = static_cast<int>(kept.size());
      kept.push_back(result.ready.plan.paths[static_cast<std::size_t>(path)]);
    }
    return at;
  };
  for (std::size_t i = from_performed; i < result.performed.size(); ++i) {
    session::Performed& performed = result.performed[i];
    if (performed.whole)
      done.push_back(result.ready.plan.paths[static_cast<std::size_t>(performed.path)].path.name);
    performed.path = keep(performed.path);
  }
  for (std::size_t i = from_decision; i < result.decisions.size(); ++i)
    result.decisions[i].path = keep(result.decisions[i].path);
  return done;
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

Result<SessionResult> run_simulated_session(const SessionOrder& order,
                                            const session::Config& config,
                                            const CommonOptions& common) {
  SessionResult result;
  // Nothing is done, not even a scan, before the questions are answered.
  result.consent_toml = session::consent_form("the simulated person", "no");
  if (!order.consent.empty()) {
    constexpr std::size_t max_bytes = 1 << 20;
    auto text = read_file(order.consent, max_bytes);
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
  const auto setting = read_setting(order, config, common);
  if (!setting) return tl::unexpected(setting.error());

  auto prepared = prepare(*setting, result.person);
  if (!prepared) return tl::unexpected(prepared.error());
  static_cast<Preparation&>(result) = std::move(*prepared);
  auto room = Room::make(*setting, result.person, result);
  if (!room) return tl::unexpected(room.error());

  constexpr std::size_t max_rescans = 3;
  std::vector<massage::PlannedPath> kept;  // of plans that were broken off
  Resumed resumed{.rail_m = result.ready.rail_m, .done = {}};
  for (;;) {
    const std::size_t performed = result.performed.size(), decided = result.decisions.size();
    const std::size_t kept_before = kept.size();
    if (auto done = (*room)->carry_out(result.ready, config.scan.sweep_s, result); !done)
      return tl::unexpected(done.error());
    if (!(*room)->wants_scan()) {
      for (std::size_t i = performed; i < result.performed.size(); ++i)
        result.performed[i].path += static_cast<int>(kept_before);
      for (std::size_t i = decided; i < result.decisions.size(); ++i)
        result.decisions[i].path += static_cast<int>(kept_before);
      break;
    }
    for (std::string& name : set_aside(result, performed, decided, kept))
      resumed.done.push_back(std::move(name));
    sim::Person moved = result.person;
    const Vector3 by = (*room)->shifted_in_couch();
    for (Vector3& point : moved.skin_in_couch.vertices) point += by;
    for (Acupoint& point : moved.acupoints) point.at_in_couch += by;
    for (Landmark& point : moved.landmarks) point.at_in_couch += by;
    auto again = result.rescans_s.size() < max_rescans
                     ? prepare(*setting, moved, resumed)
                     : Result<Preparation>(fail(Fault::bad_input, "the person keeps moving"));
    if (!again) {
      result.stops.push_back({result.massage_s, Arm::left, safety::Cause::person_moved});
      result.ready.plan.notes.push_back("after the person had moved: " + again.error().message);
      result.ready.plan.paths.clear();
      break;
    }
    result.rescans_s.push_back(result.massage_s);
    static_cast<Preparation&>(result) = std::move(*again);
  }
  join(result, std::move(kept));
  (*room)->witness.tell(result);
  return result;
}

}  // namespace tuina::app
