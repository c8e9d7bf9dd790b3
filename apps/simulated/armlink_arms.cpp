// SPDX-License-Identifier: Apache-2.0
#include "apps/simulated/armlink_arms.hpp"

#include <arpa/inet.h>

#include <algorithm>
#include <chrono>
#include <thread>

#include "tuina/core/units.hpp"
#include "tuina/robot/arm_model.hpp"

namespace tuina::app {
namespace {

namespace armlink = hardware::armlink;
using armlink::Mode;
using std::chrono::steady_clock;
using namespace std::chrono_literals;

constexpr auto lock_step_patience = 6s;  // for a host that computes
constexpr auto gone_patience = 5ms;      // and for one that is gone
constexpr auto min_host_time = 700us;    // from a state to the end of its cycle, at real pace
constexpr auto rest_patience = 300s;     // while the person is scanned again
constexpr int calming_ticks = 500;       // at the end of a way in mode ready
constexpr int max_stopped_ticks = 1000;  // then the arms have long been braked

armlink::Hello hello_of(const std::string& name, const sim::World& world, link::Pace pace) {
  const robot::ArmTable& table = world.robot_table();
  armlink::Hello hello;
  hello.modes =
      armlink::bit_of(Mode::idle) | armlink::bit_of(Mode::torque) | armlink::bit_of(Mode::ready);
  hello.flags = armlink::flag::has_rail | armlink::flag::simulated | armlink::flag::measures_torque;
  if (pace == link::Pace::max) hello.flags |= armlink::flag::waits;
  hello.cycle_us = 1000;
  std::copy_n(name.begin(), std::min(name.size(), hello.name.size() - 1), hello.name.begin());
  hello.max_torque_nm = table.torque_limits_nm();
  for (JointVector* limit : {&hello.max_speed_rad_per_s, &hello.min_rad, &hello.max_rad})
    limit->resize(table.joints);
  for (int i = 0; i < table.joints; ++i) {
    const robot::Link& link = table.links[static_cast<std::size_t>(i)];
    hello.max_speed_rad_per_s[i] = link.speed_limit_rad_per_s;
    hello.min_rad[i] = link.min_rad, hello.max_rad[i] = link.max_rad;
  }
  hello.min_rail_m = world.mount().min_rail_m;
  hello.max_rail_m = world.mount().max_rail_m;
  return hello;
}

}  // namespace

JointVector hold_at(const JointVector& place_rad, const robot::ArmModel& model,
                    const robot::ArmReading& told, double rail_m) {
  constexpr double stiffness_per_s2 = 900.0, damping_per_s = 54.0;
  const auto dynamics = model.evaluate(told.q_rad, told.dq_rad_per_s, rail_m);
  return dynamics.gravity_nm + dynamics.mass_kg_m2 * (stiffness_per_s2 * (place_rad - told.q_rad) -
                                                      damping_per_s * told.dq_rad_per_s);
}

Result<ArmlinkArms> ArmlinkArms::listen(const hardware::UdpAddress& left, const std::string& name,
                                        const sim::World& world, link::Pace pace) {
  hardware::UdpAddress right = left;
  right.of.sin_port = htons(static_cast<std::uint16_t>(ntohs(left.of.sin_port) + 1));
  auto one = hardware::UdpSocket::listen(left);
  if (!one) return tl::unexpected(one.error());
  auto other = hardware::UdpSocket::listen(right);
  if (!other) return tl::unexpected(other.error());
  return ArmlinkArms({.of = {End{std::move(*one)}, End{std::move(*other)}}},
                     hello_of(name, world, pace), pace);
}

void ArmlinkArms::say_hello(End& end, const armlink::Ask& ask, const hardware::UdpAddress& asker) {
  armlink::Hello hello = hello_;
  hello.session = ask.session, hello.sequence = ask.sequence;
  if (end.last.session != 0) hello.flags |= armlink::flag::busy;
  end.socket.send(armlink::encode(hello), asker);
}

// One session only: a simulated person is given one massage.
void ArmlinkArms::obey(End& end, const armlink::Command& command,
                       const hardware::UdpAddress& from) {
  const bool opens = end.last.session == 0 && command.session != 0 && command.mode == Mode::ready;
  const bool own = command.session == end.last.session && from == end.host;
  if ((!opens && !own) || command.values.size() != hello_.max_torque_nm.size()) return;
  const std::uint32_t age = end.state.sequence - command.answers;
  if (own && command.mode == Mode::torque && age > armlink::max_answer_age_cycles) return;
  end.heard = true;
  if (own && static_cast<std::int32_t>(command.sequence - end.last.sequence) <= 0) return;
  if (stopped_ && command.mode != Mode::idle) return;
  if (opens) end.host = from;
  end.last = command;
  end.fresh = true;
}

void ArmlinkArms::hear(steady_clock::time_point until) {
  const std::array sockets = {ends_[Arm::left].socket.number(), ends_[Arm::right].socket.number()};
  hardware::wait_for_datagram(sockets, until);
  constexpr int max_datagrams = 64;  // whatever the network does, a cycle ends
  for (End& end : ends_.of) {
    for (int i = 0; i < max_datagrams; ++i) {
      hardware::UdpAddress from;
      std::array<std::byte, armlink::max_size + 1> in;
      const auto size = end.socket.receive(in, &from);
      if (!size) break;
      const armlink::Bytes datagram(in.data(), *size);
      if (const auto ask = armlink::decode_ask(datagram)) say_hello(end, *ask, from);
      if (const auto command = armlink::decode_command(datagram)) obey(end, *command, from);
    }
  }
  for (auto& wrist : wrists_.of)
    if (wrist) wrist->stand(!both_in(Mode::torque));
}

void ArmlinkArms::tell() {
  for (End& end : ends_.of) {
    end.state.session = end.last.session;
    end.state.answers = end.last.sequence;
    end.state.mode = end.last.mode;
    end.state.status &= static_cast<std::uint16_t>(~armlink::status::stands);
    if (end.last.mode == Mode::ready && !goes()) end.state.status |= armlink::status::stands;
    end.socket.send(armlink::encode(end.state), end.host);
  }
}

bool ArmlinkArms::both_in(Mode mode) const {
  return std::all_of(ends_.of.begin(), ends_.of.end(), [&](const End& end) {
    return end.last.session != 0 && end.last.mode == mode;
  });
}

/// Whether they are told to stand at another place than they do; what a session rests at is where
/// they are.
bool ArmlinkArms::goes() const {
  if (!both_in(Mode::ready)) return false;
  if (way_ && way_->passed < way_->ticks) return true;
  return std::any_of(both_arms.begin(), both_arms.end(), [&](Arm arm) {
    const End& end = ends_[arm];
    if (end.state.q_rad.size() == 0 || (way_ && way_->to[arm] == end.last.values)) return false;
    constexpr double max_off_rad = 1_deg;
    return (end.state.q_rad - end.last.values).cwiseAbs().maxCoeff() > max_off_rad;
  });
}

void ArmlinkArms::begin_way() {
  constexpr double speed_rad_per_s = 20_deg;
  Way way;
  double farthest_rad = 0.0;
  for (const Arm arm : both_arms) {
    way.from[arm] = ends_[arm].state.q_rad;
    way.to[arm] = ends_[arm].last.values;
    farthest_rad = std::max(farthest_rad, (way.to[arm] - way.from[arm]).cwiseAbs().maxCoeff());
  }
  way.ticks =
      static_cast<int>(1.5 * farthest_rad / speed_rad_per_s / control_period_s) + calming_ticks;
  way_ = way;
}

/// From rest to rest, and calming down.
robot::RobotCommand ArmlinkArms::own_drives(const robot::RobotReading& reading,
                                            const sim::World& world) {
  if (!way_ || way_->passed >= way_->ticks) begin_way();
  ++way_->passed;
  const double s = std::min(1.0, static_cast<double>(way_->passed) / (way_->ticks - calming_ticks));
  const double share = s * s * (3.0 - 2.0 * s);
  const auto models = robot::both_models(world.robot_table(), world.mount());
  robot::RobotCommand command{.torque_nm = {}, .rail_m = reading.rail_m};
  for (const Arm arm : both_arms) {
    const JointVector place = way_->from[arm] + share * (way_->to[arm] - way_->from[arm]);
    command.torque_nm[arm] = hold_at(place, models[arm], reading.arms[arm], reading.rail_m);
  }
  return command;
}

bool ArmlinkArms::left() const {
  return std::any_of(ends_.of.begin(), ends_.of.end(),
                     [](const End& end) { return end.last.mode == Mode::idle; });
}

/// Whether both were commanded in this cycle: in lock-step, by an answer to this very state.
bool ArmlinkArms::answered() const {
  return std::all_of(ends_.of.begin(), ends_.of.end(), [&](const End& end) {
    const bool in_time = pace_ == link::Pace::real || end.last.answers == end.state.sequence;
    return end.fresh && end.last.mode == Mode::torque && in_time;
  });
}

/// Whether the host of both still speaks, if only by the torques that move them already.
bool ArmlinkArms::heard() const {
  return pace_ == link::Pace::real && both_in(Mode::torque) &&
         std::all_of(ends_.of.begin(), ends_.of.end(), [](const End& end) { return end.heard; });
}

// While an arm is told to stand, time stands still with it. In lock-step a state is told again, for
// it or its answer may be lost.
void ArmlinkArms::wait_for_commands(steady_clock::time_point next, const std::atomic<bool>& ends) {
  const auto begun = steady_clock::now();
  const bool real = pace_ == link::Pace::real;
  const auto again_every = real ? 1ms : 10ms;
  auto again = begun + again_every;
  while (!ends && !left()) {
    const bool rests = std::any_of(ends_.of.begin(), ends_.of.end(),
                                   [](const End& end) { return end.last.mode == Mode::ready; });
    const auto patience = missed_ == 0 ? steady_clock::duration(lock_step_patience) : gone_patience;
    const auto until = rests ? begun + rest_patience : real ? next : begun + patience;
    const auto now = steady_clock::now();
    if (goes()) return;
    if (now >= until || (!real && answered()) || (real && !rests && now >= next)) return;
    hear(std::min(until, again));
    if (steady_clock::now() < again) continue;
    if (rests || !real) tell();
    again = steady_clock::now() + again_every;
  }
}

void ArmlinkArms::set_states(const robot::RobotReading& reading, const sim::World& world) {
  for (const Arm arm : both_arms) {
    armlink::State& state = ends_[arm].state;
    const robot::ArmReading& seen = reading.arms[arm];
    const bool braked = world.truth().arms[arm].drive == sim::Drive::braked;
    state.sequence = static_cast<std::uint32_t>(reading.tick);
    state.status = static_cast<std::uint16_t>((stopped_ ? armlink::status::stopped : 0) |
                                              (braked ? armlink::status::braked : 0));
    state.time_s = reading.time_s;
    state.wrench_time_s = seen.wrench_time_s;
    state.rail_m = arm == Arm::left ? reading.rail_m : 0.0;
    state.q_rad = seen.q_rad;
    state.dq_rad_per_s = seen.dq_rad_per_s;
    // Before the first command there are no currents yet.
    state.tau_nm = seen.measured_torque_nm.size() == seen.q_rad.size()
                       ? seen.measured_torque_nm
                       : JointVector(JointVector::Zero(seen.q_rad.size()));
    if (wrists_[arm]) {
      wrists_[arm]->feel(reading.time_s, seen.wrench_in_tool);
      state.wrench_time_s = 0.0;
    } else {
      state.wrench_in_tool = seen.wrench_in_tool;
    }
    ends_[arm].fresh = ends_[arm].heard = false;
  }
}

Result<RobotReport> ArmlinkArms::keep(sim::World& world, SharedTruth& truth,
                                      const std::atomic<bool>& ends) {
  RobotReport report;
  while (!ends && !both_in(Mode::ready)) hear(steady_clock::now() + 100ms);
  if (ends) return report;
  const robot::ReadyPose pose = {
      .q_rad = {.of = {ends_[Arm::left].last.values, ends_[Arm::right].last.values}},
      .rail_m = ends_[Arm::left].last.rail_m};
  if (auto stands = world.robot().stand_ready(pose); !stands) return tl::unexpected(stands.error());
  auto next = steady_clock::now();
  for (int stopped_ticks = 0; !ends && !left() && stopped_ticks < max_stopped_ticks;) {
    const auto reading = world.robot().read();
    if (const char* fault = world.robot().fault()) return fail(Fault::device, "{}", fault);
    tell_truth(truth, reading->tick, world.truth());
    report.see(world.truth());
    if (hand_) hand_(world, reading->time_s);
    set_states(*reading, world);
    tell();
    // Computing physics is no part of an arm's cycle: where it took long, the clock of this robot
    // stood still, and the host has its time all the same.
    next = std::max(next + 1ms, steady_clock::now() + min_host_time);
    wait_for_commands(next, ends);
    if (goes()) {
      world.robot().apply(own_drives(*reading, world));
      continue;
    }
    const bool obeys = answered();
    if (!obeys) ++report.silent_ticks;
    if ((obeys || heard()) && !stopped_) {
      robot::RobotCommand command{.torque_nm = {}, .rail_m = ends_[Arm::left].last.rail_m};
      for (const Arm arm : both_arms) {
        command.torque_nm[arm] = ends_[arm].last.values;
        command.brake[arm] = ends_[arm].last.brake;
      }
      world.robot().apply(command);
      missed_ = 0;
      continue;
    }
    stopped_ = ++missed_ >= armlink_watchdog_ticks || stopped_;
    stopped_ticks += stopped_ ? 1 : 0;
  }
  return report;
}

}  // namespace tuina::app
