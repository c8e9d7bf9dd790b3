// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <vector>

#include "tuina/core/random.hpp"
#include "tuina/hardware/armlink.hpp"
#include "tuina/robot/robot.hpp"

namespace tuina::app {

/// What becomes of armlink's datagrams between the arms and their host, each way.
struct Network {
  double delay_s = 0.0;
  double jitter_s = 0.0;  ///< standard deviation of the delay, which is never below zero
  double loss = 0.0;      ///< share of datagrams that never come
  int max_answer_age_cycles = hardware::armlink::max_answer_age_cycles;
  double deaf_from_s = std::numeric_limits<double>::infinity();  ///< then no state comes any more
  bool sent_again = true;  ///< whether the host sends its last command again every half cycle
};

/// A simulated robot behind such a network, by the rules of docs/armlink.md, in simulated time: a
/// state is sent in each cycle, its host answers at once, and a command counts for the step at
/// whose begin it has come. The host hears no state that is older than one it has heard; the arms
/// hear no command that answers too old a state, and stop by themselves after some cycles without
/// one. The host sends its last command again until it hears the next state or has waited for
/// three reads of 2 ms. Both arms are at one cable. A network that does nothing
/// changes nothing, to the last bit.
class NetworkedArms final : public robot::Robot {
 public:
  /// `arms` must outlive it, and bear three readings without a command.
  NetworkedArms(robot::Robot& arms, const Network& network, std::uint64_t seed);

  [[nodiscard]] Result<void> stand_ready(const robot::ReadyPose& pose) override {
    return arms_.stand_ready(pose);
  }
  [[nodiscard]] std::optional<robot::RobotReading> read() noexcept override;
  void apply(const robot::RobotCommand& command) noexcept override;
  [[nodiscard]] const char* fault() const noexcept override { return arms_.fault(); }

  /// Whether the arms have stopped by themselves, or their host has broken off.
  [[nodiscard]] bool stopped() const noexcept { return stopped_; }
  /// Cycles that began without a new command.
  [[nodiscard]] int missed() const noexcept { return missed_; }

 private:
  struct State {
    double at_s;  ///< when the host has it
    robot::RobotReading reading;
    int obeyed;  ///< command that moved the arms before it
  };
  struct Command {
    double at_s;  ///< when the arms have it
    int number;
    std::uint64_t answers;
    robot::RobotCommand command;
  };
  [[nodiscard]] std::optional<double> arrival_s(double sent_s) noexcept;
  void send(const Command& command, double sent_s) noexcept;
  void send_again_until(double time_s) noexcept;
  [[nodiscard]] bool step() noexcept;

  robot::Robot& arms_;
  Network network_;
  Random random_;
  std::vector<State> states_;                    ///< under way
  std::vector<Command> commands_;                ///< under way
  std::optional<Command> last_;                  ///< of the host, while it waits for a state
  robot::RobotCommand torques_;                  ///< that move the arms
  double cycle_s_ = 0.0;                         ///< begin of the arms' cycle
  double host_s_ = 0.0;                          ///< when the host heard the state that it answers
  double again_s_ = 0.0;                         ///< when its last command is due once more
  std::uint64_t tick_ = 0;                       ///< newest state
  std::optional<std::uint64_t> heard_, obeyed_;  ///< by host and arms, of the state's tick
  int sent_ = 0, moving_ = 0;  ///< commands of the host, and the one that moves the arms
  int missed_ = 0, missed_in_row_ = 0, unheard_ = 0;
  bool stopped_ = false;
};

}  // namespace tuina::app
