// SPDX-License-Identifier: Apache-2.0
#include "tuina/hardware/can/cia402_robot.hpp"

#include <algorithm>
#include <cmath>
#include <thread>

#include "tuina/core/units.hpp"
#include "tuina/hardware/can/drive_setup.hpp"
#include "tuina/hardware/udp_socket.hpp"

namespace tuina::hardware {
namespace {

using namespace std::chrono_literals;

constexpr auto millisecond = 1ms;
constexpr auto drives_patience = 700us;  // from the SYNC on
constexpr auto enable_patience = 3s;
constexpr double ready_speed_rad_per_s = 15_deg;
constexpr double max_ready_off_rad = 0.5_deg, max_following_rad = 3_deg;
constexpr int settling_cycles = 500;
// Motors bear more than their rated torque for a moment, but none of this size.
constexpr double max_overload = 5.0;

std::string misfit_of(const PerArm<DrivenArm>& arms, const robot::ArmTable& table,
                      const robot::RobotMount& mount) {
  if (mount.max_rail_m > mount.min_rail_m)
    return fmt::format(
        "drives on CAN have no linear base, and the table's goes from {:.0f} to {:.0f} mm",
        to_mm(mount.min_rail_m), to_mm(mount.max_rail_m));
  for (const Arm arm : both_arms) {
    const auto& joints = arms[arm].joints;
    if (joints.size() != static_cast<std::size_t>(table.joints))
      return fmt::format("the {} arm names {} joints, the table has {}", name_of(arm),
                         joints.size(), table.joints);
    for (std::size_t i = 0; i < joints.size(); ++i) {
      const double bears_nm = max_overload * std::abs(joints[i].rated_torque_at_joint_nm());
      if (table.links[i].torque_limit_nm > bears_nm)
        return fmt::format(
            "the {} {} is believed to give {} Nm, which is more than {:g} times the rated {:.1f} "
            "Nm "
            "of its motor and gear",
            name_of(arm), table.links[i].name, table.links[i].torque_limit_nm, max_overload,
            bears_nm / max_overload);
    }
  }
  return fault_of(arms);
}

}  // namespace

Result<std::unique_ptr<Cia402Robot>> Cia402Robot::open(const PerArm<DrivenArm>& arms,
                                                       const robot::ArmTable& table,
                                                       const robot::RobotMount& mount,
                                                       const CanBuses& buses) {
  if (const std::string misfit = misfit_of(arms, table, mount); !misfit.empty())
    return fail(Fault::config, "{}", misfit);
  std::unique_ptr<Cia402Robot> made(new Cia402Robot);
  made->rail_m_ = mount.min_rail_m;
  made->lock_step_ = buses.wait;
  made->patience_ = buses.wait ? Clock::duration(buses.patience) : drives_patience;
  for (const Arm arm : both_arms) {
    for (int i = 0; i < table.joints; ++i) {
      const auto at = static_cast<std::size_t>(i);
      auto added = made->add_drive(arms[arm].joints[at], arm, i, table.links[at], buses);
      if (!added)
        return fail(added.error().fault, "the {} {}: {}", name_of(arm), table.links[at].name,
                    added.error().message);
    }
  }
  return made;
}

Result<void> Cia402Robot::add_drive(const DriveDevice& device, Arm arm, int joint,
                                    const robot::Link& link, const CanBuses& buses) {
  auto bus = std::find_if(buses_.begin(), buses_.end(),
                          [&](const CanBus& one) { return one.name() == device.bus; });
  if (bus == buses_.end()) {
    auto opened = buses.open(device.bus);
    if (!opened) return tl::unexpected(opened.error());
    buses_.push_back(std::move(*opened));
    bus = std::prev(buses_.end());
  }
  const auto found = find_drive(*bus, device);
  if (!found) return tl::unexpected(found.error());
  if (found->joint_rad < link.min_rad || found->joint_rad > link.max_rad)
    return fail(
        Fault::device,
        "stands at {:.1f} deg, beyond {:.1f} to {:.1f}; is it homed, and `zero_count` right?",
        to_deg(found->joint_rad), to_deg(link.min_rad), to_deg(link.max_rad));
  const DriveLimits limits{.max_torque_nm = link.torque_limit_nm,
                           .max_following_rad = max_following_rad};
  if (auto set = set_up_drive(*bus, device, limits); !set) return set;
  seats_.push_back({arm, joint, static_cast<std::size_t>(bus - buses_.begin())});
  drives_.emplace_back(device, link.torque_limit_nm, fmt::format("{} {}", name_of(arm), link.name));
  return {};
}

Cia402Robot::~Cia402Robot() {
  end_rest();
  constexpr int times = 3;  // one of them arrives, or the drives miss their host
  for (int i = 0; standing_ && i < times; ++i) {
    for (std::size_t k = 0; k < drives_.size(); ++k)
      send(k, fault_ ? drives_[k].quick_stop() : drives_[k].order(0.0, true));
    send_to_all_buses(canopen::sync());
  }
}

bool Cia402Robot::all(bool (*holds)(const Drive&)) const noexcept {
  return std::all_of(drives_.begin(), drives_.end(), holds);
}

void Cia402Robot::send(std::size_t drive, const can_frame& frame) noexcept {
  buses_[seats_[drive].bus].send(frame);
}

void Cia402Robot::send_to_all_buses(const can_frame& frame) noexcept {
  for (CanBus& bus : buses_) bus.send(frame);
}

/// Takes what is there. Whoever else is on a bus may speak, but not as the host.
void Cia402Robot::hear() noexcept {
  constexpr int max_frames = 64;  // taken at once; whatever a bus does, a cycle ends
  for (std::size_t b = 0; b < buses_.size(); ++b) {
    for (int i = 0; i < max_frames; ++i) {
      const auto frame = buses_[b].receive();
      if (!frame) break;
      const canopen::Address from = canopen::address_of(*frame);
      if (from.kind == canopen::Kind::network ||
          (from.kind == canopen::Kind::emergency && from.node == 0))
        break_off("the bus ", buses_[b].name(), "has another host");
      for (std::size_t k = 0; k < drives_.size(); ++k)
        if (seats_[k].bus == b && drives_[k].device().node == from.node) drives_[k].take(*frame);
    }
  }
}

void Cia402Robot::begin_cycles() noexcept {
  hear();  // what came while nobody listened is old
  next_ = Clock::now();
  in_cycles_ = true;
}

/// One millisecond: waits for it, sends the SYNC, hears the drives.
void Cia402Robot::cycle() noexcept {
  if (lock_step_) next_ = Clock::now();
  std::this_thread::sleep_until(next_);
  const auto late = lock_step_ ? 0 : (Clock::now() - next_) / millisecond;
  tick_ += static_cast<std::uint64_t>(1 + late);
  next_ += (1 + late) * millisecond;
  hear();
  for (Drive& drive : drives_) drive.begin_cycle(static_cast<int>(1 + late));
  send_to_all_buses(canopen::sync());
  std::array<int, 4> sockets = {};
  for (std::size_t i = 0; i < buses_.size(); ++i) sockets.at(i) = buses_[i].socket();
  const auto deadline = Clock::now() + patience_;
  do {
    wait_for_datagram({sockets.data(), buses_.size()}, deadline);
    hear();
  } while (!all([](const Drive& drive) { return drive.fresh(); }) && Clock::now() < deadline);
  ++traffic_.cycles;
  traffic_.late += static_cast<std::uint64_t>(late);
  for (std::size_t k = 0; k < drives_.size(); ++k)
    traffic_.lost[seats_[k].arm] += drives_[k].fresh() ? 0 : 1;
  note_faults();
}

void Cia402Robot::break_off(const char* whose, const std::string& name, const char* why) noexcept {
  if (fault_) return;
  fault_.note("{}{} {}", whose, name, why);
  for (std::size_t k = 0; k < drives_.size(); ++k) send(k, drives_[k].quick_stop());
  send_to_all_buses(canopen::sync());
}

void Cia402Robot::note_faults() noexcept {
  for (const CanBus& bus : buses_)
    if (bus.fault() != nullptr) break_off("the bus ", bus.name(), bus.fault());
  for (const Drive& drive : drives_)
    if (drive.fault() != nullptr) break_off("the ", drive.name(), drive.fault());
}

Result<void> Cia402Robot::enable_all() {
  for (std::size_t k = 0; k < drives_.size(); ++k)
    send(k, canopen::network(canopen::Network::start, drives_[k].device().node));
  const auto enabled = [](const Drive& drive) { return drive.state() == cia402::State::enabled; };
  const auto deadline = Clock::now() + enable_patience;
  begin_cycles();
  while (Clock::now() < deadline && !fault_) {
    cycle();
    if (all(enabled)) return {};
    for (std::size_t k = 0; k < drives_.size(); ++k) {
      if (!drives_[k].heard_anything()) continue;
      // It stays where it is when its brake opens.
      if (!enabled(drives_[k])) send(k, drives_[k].place(drives_[k].q_rad()));
      send(k, drives_[k].enable());
    }
  }
  if (fault_) return fail(Fault::device, "{}", fault_.words());
  const auto late = std::find_if_not(drives_.begin(), drives_.end(), enabled);
  if (!late->heard_anything())
    return fail(Fault::device, "the {} tells nothing upon a SYNC", late->name());
  return fail(Fault::device, "the {} does not obey: {}; look at its supply and safe torque off",
              late->name(), cia402::name_of(late->state()));
}

Result<void> Cia402Robot::move_to(const std::vector<double>& q_rad) {
  std::vector<double> from;
  double farthest_rad = 0.0;
  for (std::size_t k = 0; k < drives_.size(); ++k) {
    from.push_back(drives_[k].q_rad());
    farthest_rad = std::max(farthest_rad, std::abs(q_rad[k] - from[k]));
  }
  // A cubic from rest to rest is at its fastest one and a half times as fast as a straight line.
  const double duration_s = 1.5 * farthest_rad / ready_speed_rad_per_s;
  const int cycles = static_cast<int>(duration_s / control_period_s) + 1;
  for (int i = 1; i <= cycles + settling_cycles && !fault_; ++i) {
    const double s = std::min(1.0, static_cast<double>(i) / cycles);
    const double share = s * s * (3.0 - 2.0 * s);
    cycle();
    for (std::size_t k = 0; k < drives_.size(); ++k)
      send(k, drives_[k].place(from[k] + share * (q_rad[k] - from[k])));
  }
  if (fault_) return fail(Fault::device, "{}", fault_.words());
  for (std::size_t k = 0; k < drives_.size(); ++k)
    if (std::abs(drives_[k].q_rad() - q_rad[k]) > max_ready_off_rad)
      return fail(Fault::device, "the {} stands at {:.1f} deg, ready is {:.1f}", drives_[k].name(),
                  to_deg(drives_[k].q_rad()), to_deg(q_rad[k]));
  return {};
}

Result<void> Cia402Robot::stand_ready(const robot::ReadyPose& pose) {
  if (standing_) return {};
  standing_ = true;
  std::vector<double> q_rad;
  q_rad.reserve(seats_.size());
  for (const Seat& seat : seats_) q_rad.push_back(pose.q_rad[seat.arm][seat.joint]);
  if (auto enabled = enable_all(); !enabled) return enabled;
  auto moved = move_to(q_rad);
  in_cycles_ = false;
  return moved;
}

std::optional<robot::RobotReading> Cia402Robot::read() noexcept {
  end_rest();
  if (fault_ || !standing_) return std::nullopt;
  if (!in_cycles_) begin_cycles();
  if (!first_tick_) traffic_ = {};
  cycle();
  if (fault_) return std::nullopt;
  if (!first_tick_) first_tick_ = tick_;
  robot::RobotReading reading;
  reading.tick = tick_ - *first_tick_;
  reading.time_s = control_period_s * static_cast<double>(reading.tick);
  reading.rail_m = rail_m_;
  for (const Arm arm : both_arms) {
    robot::ArmReading& told = reading.arms[arm];
    const auto joints = static_cast<Eigen::Index>(drives_.size() / both_arms.size());
    told.q_rad = told.dq_rad_per_s = JointVector::Zero(joints);
    told.command_age = 1;
    if (all([](const Drive& drive) { return drive.follows(); }))
      told.measured_torque_nm = told.q_rad;
  }
  for (std::size_t k = 0; k < drives_.size(); ++k) {
    robot::ArmReading& told = reading.arms[seats_[k].arm];
    told.q_rad[seats_[k].joint] = drives_[k].q_rad();
    told.dq_rad_per_s[seats_[k].joint] = drives_[k].dq_rad_per_s();
    if (told.measured_torque_nm.size() > 0)
      told.measured_torque_nm[seats_[k].joint] = drives_[k].torque_nm();
  }
  return reading;
}

void Cia402Robot::apply(const robot::RobotCommand& command) noexcept {
  if (fault_ || !standing_) return;
  // Who commands lives. Drives watch for heartbeats from the first one on.
  if (commands_++ % cia402::commands_a_heartbeat == 0) say_heartbeat();
  std::array<bool, 4> asked = {};
  for (std::size_t k = 0; k < drives_.size(); ++k) {
    const auto& [arm, joint, bus] = seats_[k];
    send(k, drives_[k].order(command.torque_nm[arm][joint], command.brake[arm]));
    // The torques are known to a drive before it changes to them; one on each bus in each cycle.
    if (drives_[k].torque_begun() || asked.at(bus)) continue;
    send(k, drives_[k].begin_torque());
    asked.at(bus) = true;
  }
  note_faults();
}

}  // namespace tuina::hardware
