// SPDX-License-Identifier: Apache-2.0
#include "apps/evaluation/safety/fault_table.hpp"

#include <algorithm>
#include <cassert>

#include "tuina/core/units.hpp"

namespace tuina::app {
namespace {

using sim::RobotFault;

const std::vector<Stage> near_skin = {Stage::approach, Stage::contact, Stage::retract};
const std::vector<Stage> moving = {Stage::travel, Stage::approach, Stage::contact, Stage::retract};
const std::vector<Stage> in_contact = {Stage::contact};
const std::vector<Stage> in_the_air = {Stage::idle, Stage::travel};

Injection on_robot(const sim::TimedFault& fault) {
  return {.robot = fault};
}

Injection mad(Madness madness, double size = 0.0, double hz = 0.0) {
  return {.madness = madness, .size = size, .hz = hz};
}

/// Axis 0 of the wrist sensor is the tool's shaft: pressed, it reads negative, so that a positive
/// error hides force and the controller presses more.
std::vector<FaultClass> wrist_classes() {
  return {
      {.number = 1,
       .name = "wrist drops out",
       .injection = on_robot({.kind = RobotFault::wrench_dropout}),
       .promise = {.highest_n = 60.0, .act_ms = 5.0, .causes = {"force sensor stale"}}},
      {.number = 2,
       .name = "wrist stuck",
       .injection = on_robot({.kind = RobotFault::wrench_stuck}),
       .promise = {.over_set_n = 15.0, .act_ms = 25.0}},
      {.number = 3,
       .name = "wrist not a number",
       .injection = on_robot({.kind = RobotFault::wrench_nan}),
       .promise = {.highest_n = 60.0, .act_ms = 5.0, .causes = {"force sensor stale"}}},
      {.number = 3,
       .name = "readings doubled",
       .injection = on_robot({.kind = RobotFault::readings_doubled}),
       .promise = {.highest_n = 60.0,
                   .act_ms = 5.0,
                   .causes = {"force sensor stale", "late tick"}}},
      {.number = 4,
       .name = "wrist spike",
       .injection = on_robot({.kind = RobotFault::wrench_spikes, .size = 500.0, .rate_hz = 1.0}),
       .promise = {.duty = Duty::ride, .over_set_n = 2.0}},
      // The fifth within a second comes after 400 ms and is named with the next sample.
      {.number = 4,
       .name = "wrist spikes",
       .injection = on_robot({.kind = RobotFault::wrench_spikes, .size = 500.0, .rate_hz = 10.0}),
       .promise = {.over_set_n = 2.0, .act_ms = 405.0, .causes = {"force sensor spikes"}}},
      {.number = 5,
       .name = "wrist off by 10 N",
       .injection = on_robot({.kind = RobotFault::wrench_bias, .size = 10.0}),
       .promise = {.over_set_n = 12.0, .act_ms = 200.0}},
      // 10 N of disagreement come after 5 s, and 200 ms are left to notice them.
      {.number = 5,
       .name = "wrist drifts",
       .injection = on_robot({.kind = RobotFault::wrench_drift, .size = 2.0}),
       .promise = {.over_set_n = 12.0, .act_ms = 5200.0},
       .stages = in_contact,
       .watched_s = 8.0},
      {.number = 6,
       .name = "wrist reversed",
       .injection = on_robot({.kind = RobotFault::wrench_flip}),
       .promise = {.act_ms = 20.0}},
      {.number = 6,
       .name = "wrist ends at 20 N",
       .injection = on_robot({.kind = RobotFault::wrench_saturation, .size = 20.0}),
       .promise = {.duty = Duty::either}},
  };
}

std::vector<FaultClass> joint_classes() {
  return {
      {.number = 7,
       .name = "encoder frozen",
       .injection = on_robot({.kind = RobotFault::encoder_frozen}),
       .promise = {.highest_n = 75.0, .act_ms = 10.0},
       .stages = moving,
       .strokes = true},
      {.number = 8,
       .name = "encoder jumps",
       .injection = on_robot({.kind = RobotFault::encoder_jump, .size = 20e-3}),
       .promise = {.act_ms = 2.0, .causes = {"encoder jump"}}},
      {.number = 8,
       .name = "encoder jumps back",
       .injection = on_robot({.kind = RobotFault::encoder_jump, .size = -20e-3}),
       .promise = {.act_ms = 2.0, .causes = {"encoder jump"}}},
      {.number = 8,
       .name = "encoder not a number",
       .injection = on_robot({.kind = RobotFault::encoder_nan}),
       .promise = {.act_ms = 2.0, .causes = {"joint state not finite"}}},
      {.number = 9,
       .name = "drive gives half",
       .injection = on_robot({.kind = RobotFault::drive_gain, .size = 0.5}),
       .promise = {.highest_n = 75.0, .act_ms = 15.0}},
      {.number = 9,
       .name = "drive reversed",
       .injection = on_robot({.kind = RobotFault::drive_gain, .size = -1.0}),
       .promise = {.highest_n = 75.0, .act_ms = 15.0}},
      {.number = 9,
       .name = "drive dead",
       .injection = on_robot({.kind = RobotFault::drive_gain, .size = 0.0}),
       .promise = {.highest_n = 75.0, .act_ms = 15.0}},
      {.number = 43,
       .name = "drives grow hot",
       .injection = on_robot({.kind = RobotFault::drives_fade, .size = 0.5}),
       .promise = {.highest_n = 75.0, .act_ms = 1000.0},
       .watched_s = 3.0},
      {.number = 9,
       .name = "drives noisy",
       .injection = on_robot({.kind = RobotFault::drive_noise, .size = 1.0}),
       .promise = {.duty = Duty::either, .highest_n = 75.0}},
  };
}

/// A stall stops the guard too, so what acts in a long one is the watchdog of the drives.
std::vector<FaultClass> time_classes() {
  const auto stall = [](double duration_s) {
    return on_robot({.kind = RobotFault::stall, .duration_s = duration_s});
  };
  return {
      {.number = 10,
       .name = "stall of 2 ms",
       .injection = stall(2e-3),
       .promise = {.duty = Duty::ride, .over_set_n = 5.0}},
      {.number = 10,
       .name = "stall of 5 ms",
       .injection = stall(5e-3),
       .promise = {.duty = Duty::ride, .over_set_n = 5.0}},
      {.number = 10,
       .name = "stall of 50 ms",
       .injection = stall(50e-3),
       .promise = {.over_set_n = 5.0, .act_ms = 25.0}},
      {.number = 10,
       .name = "stall of 1 s",
       .injection = stall(1.0),
       .promise = {.over_set_n = 5.0, .act_ms = 25.0}},
      {.number = 10,
       .name = "readings lost for 5 ms",
       .injection = on_robot({.kind = RobotFault::readings_lost, .duration_s = 5e-3}),
       .promise = {.duty = Duty::ride, .over_set_n = 5.0}},
      {.number = 10,
       .name = "readings lost",
       .injection = on_robot({.kind = RobotFault::readings_lost}),
       .promise = {.over_set_n = 5.0, .act_ms = 25.0}},
      {.number = 41,
       .name = "clock an hour ahead",
       .injection = on_robot({.kind = RobotFault::clock_jump, .size = 3600.0}),
       .promise = {.duty = Duty::ride, .over_set_n = 2.0}},
      {.number = 41,
       .name = "clock an hour behind",
       .injection = on_robot({.kind = RobotFault::clock_jump, .size = -3600.0}),
       .promise = {.duty = Duty::ride, .over_set_n = 2.0}},
      {.number = 41,
       .name = "clock stands still",
       .injection = on_robot({.kind = RobotFault::clock_stopped}),
       .promise = {.duty = Duty::either, .over_set_n = 2.0}},
  };
}

std::vector<FaultClass> controller_classes() {
  return {
      // The third in a row is answered; none of them is let out.
      {.number = 11,
       .name = "torque not a number",
       .injection = mad(Madness::nan_torque),
       .promise = {.over_set_n = 3.0, .act_ms = 3.0, .causes = {"torque not finite"}}},
      {.number = 11,
       .name = "every drive at its end",
       .injection = mad(Madness::huge_torque),
       .promise = {.over_set_n = 3.0, .act_ms = 1.0}},
      {.number = 11,
       .name = "pushes 100 N inward",
       .injection = mad(Madness::inward_push, 100.0),
       .promise = {.over_set_n = 3.0, .act_ms = 1.0}},
      {.number = 11,
       .name = "pushes 400 N inward",
       .injection = mad(Madness::inward_push, 400.0),
       .promise = {.over_set_n = 3.0, .act_ms = 1.0}},
      {.number = 11,
       .name = "trembles at 20 Hz",
       .injection = mad(Madness::oscillation, 25.0, 20.0),
       .promise = {.duty = Duty::either, .over_set_n = 3.0}},
      // To the guard it is as dead as one that proposes nothing.
      {.number = 11,
       .name = "repeats itself",
       .injection = mad(Madness::stale_repeat),
       .promise = {.over_set_n = 3.0, .act_ms = 10.0}},
      {.number = 20,
       .name = "joint pushed to its end",
       .injection = mad(Madness::joint_push, 20.0),
       .promise = {.highest_n = 75.0, .apart_mm = 5.0}},
      {.number = 12,
       .name = "controller killed",
       .injection = mad(Madness::killed),
       .promise = {.act_ms = 10.0, .released_ms = 600.0}},
      {.number = 13,
       .name = "guard killed",
       .injection = on_robot({.kind = RobotFault::commands_lost}),
       .promise = {.act_ms = 25.0}},
      // The guard gives the controller 300 ms to let go by itself.
      {.number = 37,
       .name = "asked to stop, controller deaf",
       .injection = {.stop_ignored = true},
       .promise = {.over_set_n = 2.0, .act_ms = 350.0, .released_ms = 600.0},
       .stages = in_contact},
      {.number = 23,
       .name = "estimate not a number",
       .injection = mad(Madness::bad_tissue),
       .promise = {.duty = Duty::either, .over_set_n = 2.0},
       .stages = in_contact},
      {.number = 40,
       .name = "power lost",
       .injection = {.power_lost = true},
       .promise = {.act_ms = 52.0, .further_mm = 5.0}},
  };
}

/// What an arm meets in its room, tools that are not those of the table, and the button on the
/// wall.
std::vector<FaultClass> room_classes() {
  const auto strays = [](Stray stray) { return Injection{.stray = stray}; };
  const Promise refused = {.highest_n = 1.0, .act_ms = 100.0};
  return {
      {.number = 19,
       .name = "other arm comes",
       .injection = strays(Stray::other_arm),
       .promise = {.apart_mm = 10.0},
       .watched_s = 5.0},
      {.number = 20,
       .name = "sent into the robot's body",
       .injection = strays(Stray::own_body),
       .promise = {.apart_mm = 5.0},
       .stages = in_the_air,
       .watched_s = 5.0},
      {.number = 20,
       .name = "sent into the couch",
       .injection = strays(Stray::couch),
       .promise = {.apart_mm = 5.0},
       .stages = in_the_air,
       .watched_s = 5.0},
      {.number = 24,
       .name = "tool 0.5 kg heavier",
       .injection = {.tool_kg = 0.5},
       .promise = refused,
       .stages = {Stage::idle},
       .whole = true,
       .watched_s = 6.0},
      {.number = 24,
       .name = "tool lost",
       .injection = {.tool_kg = -0.15},
       .promise = refused,
       .stages = {Stage::idle},
       .whole = true,
       .watched_s = 6.0},
      {.number = 44,
       .name = "emergency stop",
       .injection = {.emergency_stop = true},
       .promise = {.act_ms = 20.0, .further_mm = 5.0}},
  };
}

std::vector<FaultClass> person_classes() {
  const auto moves = [](const PersonMove& move) { return Injection{.person = move}; };
  return {
      {.number = 14,
       .name = "breathes deeply",
       .injection = {.breathing = {.amplitude_m = 12_mm, .frequency_hz = 0.5}},
       .promise = {.duty = Duty::ride, .rmse_n = 3.0},
       .stages = in_contact,
       .watched_s = 4.0},
      {.number = 15,
       .name = "coughs",
       .injection = moves({15_mm, 0.15, 2.0 * gravity_m_per_s2, 0.15}),
       .promise = {.over_set_n = 15.0, .act_ms = 10.0},
       .stages = in_contact},
      {.number = 16,
       .name = "sits up",
       .injection = moves({200_mm, 0.5, gravity_m_per_s2}),
       .promise = {.highest_n = 75.0, .act_ms = 15.0},
       .stages = near_skin},
      {.number = 16,
       .name = "starts up",
       .injection = moves({60_mm, 0.4, 2.0 * gravity_m_per_s2}),
       .promise = {.highest_n = 75.0, .act_ms = 15.0},
       .stages = near_skin},
      {.number = 17,
       .name = "leaves",
       .injection = moves({-100_mm, 0.5, gravity_m_per_s2}),
       .promise = {.act_ms = 60.0, .further_mm = 3.0},
       .stages = in_contact},
      {.number = 18,
       .name = "pulls the arm aside",
       .injection = {.hand_aside_n = 40.0},
       .promise = {.act_ms = 15.0}},
      {.number = 18,
       .name = "leans on the arm",
       .injection = {.hand_inward_n = 40.0},
       .promise = {.act_ms = 15.0}},
      {.number = 21,
       .name = "slips onto bone",
       .injection = {.hand_aside_n = 40.0, .bone_beside = true},
       .promise = {.highest_n = 45.0, .act_ms = 20.0},
       .stages = in_contact},
      {.number = 22,
       .name = "ten times harder",
       .injection = {.harder = 10.0},
       .promise = {.duty = Duty::either, .over_set_n = 10.0},
       .stages = in_contact,
       .strokes = true},
  };
}

/// Faults behind the currents that drives measure: a weak magnet, or a motor that was wired the
/// wrong way round. They stand at the end, so that the seeds of the others stay.
std::vector<FaultClass> hidden_classes() {
  return {
      {.number = 9,
       .name = "motor gives half",
       .injection = on_robot({.kind = RobotFault::motor_gain, .size = 0.5}),
       .promise = {.highest_n = 75.0, .act_ms = 15.0}},
      {.number = 9,
       .name = "motor reversed",
       .injection = on_robot({.kind = RobotFault::motor_gain, .size = -1.0}),
       .promise = {.highest_n = 75.0, .act_ms = 15.0}},
  };
}

}  // namespace

const std::vector<FaultClass>& fault_classes() {
  static const std::vector<FaultClass> all = [] {
    std::vector<FaultClass> classes;
    for (auto& part : {wrist_classes(), joint_classes(), time_classes(), controller_classes(),
                       room_classes(), person_classes(), hidden_classes()})
      classes.insert(classes.end(), part.begin(), part.end());
    return classes;
  }();
  return all;
}

const FaultClass& fault_class(const std::string& name) {
  const auto& all = fault_classes();
  const auto found =
      std::find_if(all.begin(), all.end(), [&](const FaultClass& one) { return one.name == name; });
  assert(found != all.end());
  return *found;
}

}  // namespace tuina::app
