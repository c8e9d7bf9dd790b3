// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <hardware_interface/system_interface.hpp>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "arm_connection.hpp"

namespace tuina_armlink {

/// One arm that speaks armlink as hardware of ros2_control: torques in; joints and wrist out. The
/// controller manager must run at the arm's own rate, 1000 Hz: three cycles without a command stop
/// the arm. Nothing here limits a torque; the arm's own limits and its stop are the last word.
class ArmlinkSystem final : public hardware_interface::SystemInterface {
 public:
  using CallbackReturn = hardware_interface::CallbackReturn;
  using return_type = hardware_interface::return_type;

  /// Reads address, port, the joints' angles `ready` and, of an arm on a linear base, its place
  /// `rail_ready` in metres.
  CallbackReturn on_init(const hardware_interface::HardwareInfo& info) override;
  /// Asks the arm who it is.
  CallbackReturn on_configure(const rclcpp_lifecycle::State&) override;
  /// The arm goes to the angles `ready` by its own drives; waits until it stands there. Its drives
  /// hold it until a controller claims the efforts of all joints.
  CallbackReturn on_activate(const rclcpp_lifecycle::State&) override;
  /// The arm closes its brakes.
  CallbackReturn on_deactivate(const rclcpp_lifecycle::State&) override;

  std::vector<hardware_interface::StateInterface> export_state_interfaces() override;
  std::vector<hardware_interface::CommandInterface> export_command_interfaces() override;

  /// The arm is under torque while efforts of all joints are claimed. Else it holds where it was.
  return_type perform_command_mode_switch(const std::vector<std::string>& start,
                                          const std::vector<std::string>& stop) override;

  /// An error where the arm has stopped, has a fault, or is silent for 100 cycles.
  return_type read(const rclcpp::Time&, const rclcpp::Duration&) override;
  /// An error, and no command, where a torque is no finite number.
  return_type write(const rclcpp::Time&, const rclcpp::Duration&) override;

 private:
  ArmConnection arm_;
  std::string address_;
  int port_ = 0;
  armlink_state state_ = {};
  std::vector<double> ready_rad_, torque_nm_;
  std::vector<double> hold_rad_;  ///< where the arm stands while nobody claims its efforts
  std::optional<double> rail_ready_m_;
  std::set<std::string> claimed_;  ///< names of the efforts that controllers have
  int silent_cycles_ = 0;
};

}  // namespace tuina_armlink
