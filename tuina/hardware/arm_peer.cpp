// SPDX-License-Identifier: Apache-2.0
#include "tuina/hardware/arm_peer.hpp"

#include <algorithm>
#include <cmath>
#include <random>

#include "tuina/core/units.hpp"

namespace tuina::hardware {
namespace {

using armlink::Mode;
using std::chrono::steady_clock;
using namespace std::chrono_literals;

constexpr int max_in_row = 3;    // rejected datagrams, before somebody else must be speaking
constexpr int max_unheard = 10;  // commands that an arm under torque has not yet obeyed
constexpr double max_clock_off_s = 2e-3;
constexpr int max_datagrams = 64;  // taken at once; whatever the network does, a cycle ends
constexpr int questions = 10;
constexpr auto patience = 50ms;  // for each answer

std::uint32_t some_session() {
  std::random_device device;
  return std::max<std::uint32_t>(1, device());
}

}  // namespace

Result<ArmPeer> ArmPeer::open(const UdpAddress& address) {
  auto socket = UdpSocket::connect(address);
  if (!socket) return tl::unexpected(socket.error());
  ArmPeer peer(std::move(*socket));
  peer.session_ = some_session();
  int answered = 0;
  for (int i = 0; i < questions && peer.fault_ == nullptr; ++i) answered += peer.ask() ? 1 : 0;
  if (peer.fault_ != nullptr) return fail(Fault::device, "it {}", peer.fault_);
  if (answered == 0) return fail(Fault::device, "nobody answers");
  return peer;
}

std::string ArmPeer::lack_of(const robot::ArmTable& table, const robot::RobotMount& mount,
                             bool carries_rail) const {
  if ((hello_.flags & armlink::flag::busy) != 0) return "is driven by another host";
  if (hello_.max_torque_nm.size() != table.joints)
    return fmt::format("has {} joints, the table {}", hello_.max_torque_nm.size(), table.joints);
  const auto can = [&](Mode mode) { return (hello_.modes & armlink::bit_of(mode)) != 0; };
  if (!can(Mode::torque) || !can(Mode::ready)) return "cannot be driven by torques";
  if (hello_.cycle_us != 1000)
    return fmt::format("has a cycle of {} us, 1000 are needed", hello_.cycle_us);
  for (int i = 0; i < table.joints; ++i) {
    const robot::Link& link = table.links[static_cast<std::size_t>(i)];
    if (hello_.max_torque_nm[i] < link.torque_limit_nm)
      return fmt::format("gives {} Nm at {}, the table believes in {}", hello_.max_torque_nm[i],
                         link.name, link.torque_limit_nm);
    if (hello_.max_speed_rad_per_s[i] < link.speed_limit_rad_per_s)
      return fmt::format("turns {} by {} rad/s, the table believes in {}", link.name,
                         hello_.max_speed_rad_per_s[i], link.speed_limit_rad_per_s);
    if (hello_.min_rad[i] > link.min_rad || hello_.max_rad[i] < link.max_rad)
      return fmt::format(
          "turns {} from {:.1f} to {:.1f} deg, the table believes in {:.1f} to {:.1f}", link.name,
          to_deg(hello_.min_rad[i]), to_deg(hello_.max_rad[i]), to_deg(link.min_rad),
          to_deg(link.max_rad));
  }
  const bool moves = carries_rail && mount.max_rail_m > mount.min_rail_m;
  if (moves && (hello_.flags & armlink::flag::has_rail) == 0)
    return "has no linear base, and the left arm is to carry it";
  if (moves && (hello_.min_rail_m > mount.min_rail_m || hello_.max_rail_m < mount.max_rail_m))
    return fmt::format(
        "moves its base from {:.0f} to {:.0f} mm, the table believes in {:.0f} to "
        "{:.0f}",
        to_mm(hello_.min_rail_m), to_mm(hello_.max_rail_m), to_mm(mount.min_rail_m),
        to_mm(mount.max_rail_m));
  return {};
}

bool ArmPeer::ask() noexcept {
  const auto asked_at = steady_clock::now();
  socket_.send(armlink::encode(armlink::Ask{.session = session_, .sequence = ++asked_}));
  std::array<std::byte, armlink::max_size + 1> bytes;
  while (steady_clock::now() < asked_at + patience) {
    const int number = socket_.number();
    wait_for_datagram({&number, 1}, asked_at + patience);
    const auto size = socket_.receive(bytes);
    if (!size) continue;
    const auto hello = armlink::decode_hello({bytes.data(), *size});
    if (!hello && hello.error() == armlink::Spoilt::version)
      break_off(armlink::name_of(hello.error()));
    if (fault_ != nullptr) return false;
    if (!hello || hello->session != session_ || hello->sequence != asked_) continue;
    const double took_s = std::chrono::duration<double>(steady_clock::now() - asked_at).count();
    min_round_trip_s_ = max_round_trip_s_ > 0.0 ? std::min(min_round_trip_s_, took_s) : took_s;
    max_round_trip_s_ = std::max(max_round_trip_s_, took_s);
    hello_ = *hello;
    return true;
  }
  return false;
}

void ArmPeer::send(Mode mode, const JointVector& values, double rail_m, bool brake) noexcept {
  last_ = {.session = session_,
           .sequence = last_.sequence + 1,
           .answers = state_ ? state_->sequence : 0,
           .mode = mode,
           .brake = brake,
           .rail_m = rail_m,
           .values = values};
  socket_.send(armlink::encode(last_));
}

void ArmPeer::send_again() noexcept {
  socket_.send(armlink::encode(last_));
}

ArmPeer::Heard ArmPeer::hear() noexcept {
  Heard newest = Heard::nothing;
  std::array<std::byte, armlink::max_size + 1> bytes;
  for (int i = 0; i < max_datagrams; ++i) {
    const auto size = socket_.receive(bytes);
    if (!size) break;
    const armlink::Bytes datagram(bytes.data(), *size);
    const auto state = armlink::decode_state(datagram);
    if (state) {
      newest = std::max(newest, take(*state));
    } else if (armlink::decode_hello(datagram)) {
      continue;  // a late answer to a question
    } else {
      reject(armlink::name_of(state.error()));
    }
  }
  return newest;
}

ArmPeer::Heard ArmPeer::take(const armlink::State& state) noexcept {
  if (state.session != session_) {
    reject("obeys another host as well");
    return Heard::nothing;
  }
  if (state.q_rad.size() != hello_.max_torque_nm.size()) break_off("has another number of joints");
  const auto ahead = state_ ? static_cast<std::int32_t>(state.sequence - state_->sequence) : 1;
  if (ahead < 0) {
    ++traffic_.late;
    reject("counts its states backwards");
    return Heard::nothing;
  }
  if (state_) {
    const double due_s = state_->time_s + 1e-6 * ahead * hello_.cycle_us;
    if (std::abs(state.time_s - due_s) > max_clock_off_s) break_off("has a clock that jumps");
    traffic_.lost += static_cast<std::uint64_t>(std::max(ahead - 1, 0));
  }
  const auto unheard = static_cast<std::int32_t>(last_.sequence - state.answers);
  if (last_.mode == Mode::torque && unheard > max_unheard) break_off("does not hear its commands");
  traffic_.unheard += last_.mode == Mode::torque && ahead > 0 && unheard > 0 ? 1 : 0;
  namespace status = armlink::status;
  if ((state.status & status::emergency_stop) != 0) break_off("was stopped by an emergency stop");
  if ((state.status & status::drive_fault) != 0) break_off("has a fault in its drives");
  if ((state.status & status::stopped) != 0)
    break_off("has stopped by itself: three commands did not reach it in time");
  state_ = state;
  rejected_in_row_ = 0;
  ++traffic_.states;
  return ahead > 0 ? Heard::fresh : Heard::again;
}

void ArmPeer::reject(const char* why) noexcept {
  ++traffic_.rejected;
  if (++rejected_in_row_ >= max_in_row) break_off(why);
}

void ArmPeer::break_off(const char* why) noexcept {
  if (fault_ == nullptr) fault_ = why;
}

}  // namespace tuina::hardware
