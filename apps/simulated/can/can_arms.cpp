// SPDX-License-Identifier: Apache-2.0
#include "apps/simulated/can/can_arms.hpp"

#include <fmt/format.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>

#include "apps/simulated/armlink_arms.hpp"
#include "tuina/hardware/can/cia402.hpp"
#include "tuina/hardware/can/emulated_bus.hpp"
#include "tuina/robot/ready_posture.hpp"

namespace tuina::app {
namespace {

using namespace std::chrono_literals;

constexpr int buses_an_arm = 2;
constexpr double gear = 100.0, max_overload = 2.0;  // a motor gives twice its rated torque
constexpr int standing_syncs = 300;                 // at one place, before the first torque
constexpr int ever_ms = 1'000'000;
constexpr int max_ms_alone = 1000;   // then the arms have long been braked
constexpr auto host_patience = 60s;  // with one that is there and computes

hardware::DriveDevice device_of(const std::string& bus, int number, const robot::Link& link,
                                int counts_per_turn) {
  return {.bus = bus,
          .node = static_cast<std::uint8_t>(number + 1),
          .counts_per_turn = counts_per_turn,
          .gear = gear,
          .rated_torque_nm = link.torque_limit_nm / (max_overload * gear),
          .zero_count = 1000 * (number + 1),
          .reversed = number % 2 == 1};
}

}  // namespace

CanArms::CanArms(const sim::World& world)
    : models_(robot::both_models(world.robot_table(), world.mount())) {}

CanArms::~CanArms() {
  for (Bus& bus : buses_) {
    hang_up(bus);
    if (bus.door >= 0) ::close(bus.door);
  }
}

Result<std::unique_ptr<CanArms>> CanArms::listen(const std::string& name, const sim::World& world,
                                                 int counts_per_turn) {
  std::unique_ptr<CanArms> made(new CanArms(world));
  made->add_drives(name, world.robot_table(), counts_per_turn);
  const PerArm<JointVector> ready = robot::ready_posture(world.robot_table(), world.mount());
  for (std::size_t k = 0; k < made->drives_.size(); ++k)
    made->drives_[k].place_at(ready[made->seats_[k].arm][made->seats_[k].joint]);
  for (Bus& bus : made->buses_) {
    const auto door = hardware::listen_as_emulated(bus.name);
    if (!door) return tl::unexpected(door.error());
    bus.door = *door;
  }
  return made;
}

void CanArms::add_drives(const std::string& name, const robot::ArmTable& table,
                         int counts_per_turn) {
  for (const Arm arm : both_arms) {
    const std::size_t first = buses_.size();
    for (int i = 0; i < buses_an_arm; ++i)
      buses_.push_back({.name = fmt::format("emulated:{}/can{}", name, buses_.size())});
    for (int joint = 0; joint < table.joints; ++joint) {
      const auto upper = static_cast<std::size_t>(joint * buses_an_arm / table.joints);
      const std::size_t at = first + upper;
      const auto number = static_cast<int>(drives_.size());
      const robot::Link& link = table.links[static_cast<std::size_t>(joint)];
      drives_.emplace_back(device_of(buses_[at].name, number, link, counts_per_turn),
                           [this, at](const can_frame& frame) {
                             (void)::send(buses_[at].host, &frame, sizeof frame,
                                          MSG_NOSIGNAL | MSG_DONTWAIT);
                           });
      // The host may think for as long as it likes; its silence is told by milliseconds.
      drives_.back().host_patience_ms = ever_ms;
      seats_.push_back({.arm = arm, .joint = joint, .bus = at});
    }
  }
}

std::string CanArms::section(Arm arm) const {
  std::string text = fmt::format("[arm.{}]\nkind = \"cia402\"\n", name_of(arm));
  for (std::size_t k = 0; k < drives_.size(); ++k) {
    if (seats_[k].arm != arm) continue;
    const hardware::DriveDevice& device = drives_[k].device();
    text += fmt::format(
        "[[arm.{}.joint]]\nbus = \"{}\"\nnode = {}\ncounts_per_turn = {}\ngear = {:g}\n"
        "rated_torque_nm = {:g}\nzero_count = {}\nreversed = {}\n",
        name_of(arm), device.bus, device.node, device.counts_per_turn, device.gear,
        device.rated_torque_nm, device.zero_count, device.reversed);
  }
  return text;
}

void CanArms::hang_up(Bus& bus) {
  if (bus.host >= 0) ::close(bus.host);
  bus.host = -1;
  bus.synced = false;
}

/// Waits a millisecond at most for a frame or a host.
void CanArms::hear() {
  std::vector<pollfd> wanted;
  for (const Bus& bus : buses_)
    if (!bus.synced && !bus.unplugged)
      wanted.push_back({.fd = bus.host >= 0 ? bus.host : bus.door, .events = POLLIN, .revents = 0});
  (void)::poll(wanted.data(), wanted.size(), 1);
  for (std::size_t b = 0; b < buses_.size(); ++b) {
    Bus& bus = buses_[b];
    if (bus.host < 0 && !bus.unplugged && !begun_)
      bus.host = ::accept4(bus.door, nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC);
    serve(b);
  }
  for (EmulatedDrive& drive : drives_) drive.live();
}

void CanArms::serve(std::size_t b) {
  Bus& bus = buses_[b];
  can_frame frame = {};
  while (bus.host >= 0 && !bus.synced) {
    const ssize_t size = ::recv(bus.host, &frame, sizeof frame, MSG_DONTWAIT);
    if (size < 0 && (errno == EAGAIN || errno == EINTR)) return;
    if (size != sizeof frame) return hang_up(bus);
    bus.synced = frame.can_id == hardware::canopen::sync().can_id;
    for (std::size_t k = 0; k < drives_.size() && !bus.synced; ++k)
      if (seats_[k].bus == b) drives_[k].take(frame);
  }
}

bool CanArms::all_synced() const {
  return std::all_of(buses_.begin(), buses_.end(),
                     [](const Bus& bus) { return bus.synced || bus.unplugged; });
}

/// Who has asked and left before the arms stood ready was not the host of a session.
bool CanArms::host_gone() const {
  return seen_ && std::any_of(buses_.begin(), buses_.end(),
                              [](const Bus& bus) { return bus.host < 0 && !bus.unplugged; });
}

bool CanArms::given_up() const {
  return begun_ && Clock::now() > last_sync_ + host_patience;
}

/// Before the first torque a place at which the host leaves them is the one where they stand ready.
void CanArms::look_whether_they_stand(sim::World& world, SharedTruth& truth) {
  std::vector<std::uint32_t> wanted;
  bool enabled = true;
  for (EmulatedDrive& drive : drives_) {
    wanted.push_back(drive.value(0x607A));
    enabled = enabled && drive.enabled();
  }
  syncs_at_rest_ = enabled && wanted == wanted_ ? syncs_at_rest_ + 1 : 0;
  wanted_ = std::move(wanted);
  if (syncs_at_rest_ < standing_syncs) return;
  robot::ReadyPose pose{.rail_m = world.mount().min_rail_m};
  for (const Arm arm : both_arms) pose.q_rad[arm].resize(world.robot_table().joints);
  for (std::size_t k = 0; k < drives_.size(); ++k) {
    pose.q_rad[seats_[k].arm][seats_[k].joint] = drives_[k].q_rad();
    drives_[k].blocked = true;  // from here on the plant turns it
  }
  if (const auto stands = world.robot().stand_ready(pose); !stands) {
    fault_ = stands.error().message;
    return;
  }
  held_rad_ = pose.q_rad;
  seen_ = world.robot().read();
  tell_truth(truth, 0, world.truth());
  for (const Arm arm : both_arms)
    if (wrists_[arm]) wrists_[arm]->feel(0.0, seen_->arms[arm].wrench_in_tool);
}

/// What is measured at the SYNC: the wrists' samples are there before the drives have told.
void CanArms::begin_millisecond(sim::World& world, SharedTruth& truth) {
  ++tick_;
  sim::PlantTruth now = world.truth();
  now.time_s = control_period_s * static_cast<double>(tick_);
  tell_truth(truth, tick_, now);
  for (const Arm arm : both_arms)
    if (wrists_[arm]) wrists_[arm]->feel(now.time_s, seen_->arms[arm].wrench_in_tool);
}

/// The plant goes on by what the drives give. A joint whose drive obeys no torques is held where it
/// is, by the drive or by its brake; an arm of which all are off stands on its brakes.
void CanArms::end_millisecond(sim::World& world, RobotReport& report) {
  robot::RobotCommand command{.torque_nm = {}, .rail_m = world.mount().min_rail_m};
  for (const Arm arm : both_arms) {
    command.torque_nm[arm] = hold_at(held_rad_[arm], models_[arm], seen_->arms[arm], seen_->rail_m);
    command.brake[arm] = true;
  }
  for (std::size_t k = 0; k < drives_.size(); ++k) {
    const auto& [arm, joint, bus] = seats_[k];
    if (drives_[k].enabled()) command.brake[arm] = false;
    if (!drives_[k].obeys_torques()) continue;
    command.torque_nm[arm][joint] = drives_[k].torque_nm();
    held_rad_[arm][joint] = seen_->arms[arm].q_rad[joint];
  }
  if (hand_) hand_(world, control_period_s * static_cast<double>(tick_));
  world.robot().apply(command);
  seen_ = world.robot().read();
  report.see(world.truth());
  if (const char* fault = world.robot().fault()) fault_ = fault;
}

void CanArms::pass_alone(sim::World& world, SharedTruth& truth, RobotReport& report) {
  begin_millisecond(world, truth);
  ++report.silent_ticks;
  miss_host();
  end_millisecond(world, report);
}

/// Drives that hear their host no more stop by themselves, in time.
void CanArms::miss_host() {
  constexpr std::uint16_t heartbeat_lost = 0x8130;
  if (++ms_without_host_ < hardware::cia402::max_host_silence_ms) return;
  const bool all = host_gone();
  for (std::size_t k = 0; k < drives_.size(); ++k)
    if (drives_[k].enabled() && (all || buses_[seats_[k].bus].unplugged))
      drives_[k].fall_into_fault(heartbeat_lost);
}

void CanArms::cycle(sim::World& world, SharedTruth& truth, RobotReport& report) {
  last_sync_ = Clock::now();
  const auto torques = [](EmulatedDrive& drive) { return drive.obeys_torques(); };
  if (seen_ && !begun_ && std::any_of(drives_.begin(), drives_.end(), torques)) {
    begun_ = true;
    for (auto& wrist : wrists_.of)
      if (wrist) wrist->stand(false);
  }
  if (begun_) {
    begin_millisecond(world, truth);
    if (1e-3 * static_cast<double>(tick_) >= unplug_.at_s) {
      hang_up(buses_[unplug_.bus]);
      buses_[unplug_.bus].unplugged = true;
      miss_host();
    }
  }
  for (std::size_t k = 0; k < drives_.size(); ++k) {
    if (seen_) drives_[k].turn_to(seen_->arms[seats_[k].arm].q_rad[seats_[k].joint]);
    if (buses_[seats_[k].bus].synced) drives_[k].take(hardware::canopen::sync());
  }
  for (Bus& bus : buses_) bus.synced = false;
  if (begun_) end_millisecond(world, report);
  if (!seen_) look_whether_they_stand(world, truth);
}

Result<RobotReport> CanArms::keep(sim::World& world, SharedTruth& truth,
                                  const std::atomic<bool>& ends) {
  RobotReport report;
  for (int ms_alone = 0; !ends && fault_.empty() && ms_alone < max_ms_alone;) {
    if (host_gone()) {
      if (!begun_) break;
      ++ms_alone;
      pass_alone(world, truth, report);
      continue;
    }
    hear();
    if (all_synced()) cycle(world, truth, report);
    if (given_up()) break;
  }
  if (!fault_.empty()) return fail(Fault::device, "{}", fault_);
  return report;
}

}  // namespace tuina::app
