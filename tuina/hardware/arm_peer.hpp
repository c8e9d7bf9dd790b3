// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "tuina/core/result.hpp"
#include "tuina/hardware/armlink.hpp"
#include "tuina/hardware/udp_socket.hpp"
#include "tuina/robot/arm_table.hpp"
#include "tuina/robot/mount.hpp"

namespace tuina::hardware {

/// What has come from an arm since the session began.
struct ArmTraffic {
  std::uint64_t states = 0;
  std::uint64_t lost = 0;      ///< gaps in the sequence: lost on the way, or read too late
  std::uint64_t late = 0;      ///< came after a newer one
  std::uint64_t unheard = 0;   ///< began without the last command, which came too late or never
  std::uint64_t rejected = 0;  ///< spoilt, or of another session
};

/// One arm at the other end of armlink, as its host sees it: asked once, then heard and told. After
/// `open` nothing takes heap or waits.
class ArmPeer {
 public:
  /// What `hear` has brought.
  enum class Heard : std::uint8_t {
    nothing,
    again,  ///< the newest state once more: the arm waits for its command, or stands
    fresh,
  };

  /// Asks who is there. Fails with Fault::device when nobody answers within half a second.
  [[nodiscard]] static Result<ArmPeer> open(const UdpAddress& address);

  /// Who answered `open`, and the limits of the arm.
  [[nodiscard]] const armlink::Hello& hello() const noexcept { return hello_; }
  /// From question to answer: the fastest and the slowest of `open`'s.
  [[nodiscard]] double min_round_trip_s() const noexcept { return min_round_trip_s_; }
  [[nodiscard]] double max_round_trip_s() const noexcept { return max_round_trip_s_; }
  /// What the arm lacks that the table believes in, said of "the left arm"; empty when it lacks
  /// nothing and is nobody else's.
  [[nodiscard]] std::string lack_of(const robot::ArmTable& table, const robot::RobotMount& mount,
                                    bool carries_rail) const;
  /// Whether the arm is simulated and waits for each command.
  [[nodiscard]] bool waits() const noexcept { return (hello_.flags & armlink::flag::waits) != 0; }

  /// A command in answer to the newest state.
  void send(armlink::Mode mode, const JointVector& values, double rail_m, bool brake) noexcept;
  /// The last command once more, in case it was lost.
  void send_again() noexcept;
  /// Takes what has come.
  Heard hear() noexcept;
  /// The newest one; only after something was heard.
  [[nodiscard]] const armlink::State& state() const noexcept { return *state_; }
  /// Whether any state of the arm has come.
  [[nodiscard]] bool heard_anything() const noexcept { return state_.has_value(); }
  /// How many commands were sent since the one that the arm had obeyed when it told the newest
  /// state; only after something was heard.
  [[nodiscard]] int command_age() const noexcept {
    return static_cast<std::int32_t>(last_.sequence - state_->answers);
  }
  /// Whether the newest state came after the last command.
  [[nodiscard]] bool obeyed() const noexcept { return state_ && command_age() == 0; }
  /// Datagrams counted since `open`.
  [[nodiscard]] const ArmTraffic& traffic() const noexcept { return traffic_; }
  /// Number of the socket, for poll.
  [[nodiscard]] int socket() const noexcept { return socket_.number(); }

  /// What ends the session, said of "the left arm"; null while all is well. It stays.
  [[nodiscard]] const char* fault() const noexcept { return fault_; }

 private:
  explicit ArmPeer(UdpSocket socket) : socket_(std::move(socket)) {}
  [[nodiscard]] bool ask() noexcept;
  Heard take(const armlink::State& state) noexcept;
  void reject(const char* why) noexcept;
  void break_off(const char* why) noexcept;

  UdpSocket socket_;
  armlink::Hello hello_;
  double min_round_trip_s_ = 0.0, max_round_trip_s_ = 0.0;
  std::uint32_t session_ = 0, asked_ = 0;
  std::optional<armlink::State> state_;
  armlink::Command last_;
  ArmTraffic traffic_;
  int rejected_in_row_ = 0;
  const char* fault_ = nullptr;
};

}  // namespace tuina::hardware
