// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

/// What `ros2/tuina_armlink` uses of ros2_control, by the names and signatures that it has there
/// from Humble to Jazzy. It takes the place of those headers where there is no ROS 2; nothing of it
/// is theirs.
namespace rclcpp {
class Time {};
class Duration {};
}  // namespace rclcpp
namespace rclcpp_lifecycle {
class State {};
}  // namespace rclcpp_lifecycle

namespace hardware_interface {

enum class CallbackReturn { SUCCESS, FAILURE, ERROR };
enum class return_type { OK, ERROR };

struct ComponentInfo {
  std::string name;
  std::unordered_map<std::string, std::string> parameters = {};
};
struct HardwareInfo {
  std::unordered_map<std::string, std::string> hardware_parameters;
  std::vector<ComponentInfo> joints, sensors;
};

/// The name of a value, and where it stands.
struct Interface {
  Interface(std::string of, std::string what, double* where)
      : prefix(std::move(of)), name(std::move(what)), value(where) {}
  std::string prefix, name;
  double* value;
};
using StateInterface = Interface;
using CommandInterface = Interface;

class SystemInterface {
 public:
  virtual ~SystemInterface() = default;
  virtual CallbackReturn on_init(const HardwareInfo& info) {
    info_ = info;
    return CallbackReturn::SUCCESS;
  }
  virtual CallbackReturn on_configure(const rclcpp_lifecycle::State&) = 0;
  virtual CallbackReturn on_activate(const rclcpp_lifecycle::State&) = 0;
  virtual CallbackReturn on_deactivate(const rclcpp_lifecycle::State&) = 0;
  virtual std::vector<StateInterface> export_state_interfaces() = 0;
  virtual std::vector<CommandInterface> export_command_interfaces() = 0;
  virtual return_type perform_command_mode_switch(const std::vector<std::string>&,
                                                  const std::vector<std::string>&) {
    return return_type::OK;
  }
  virtual return_type read(const rclcpp::Time&, const rclcpp::Duration&) = 0;
  virtual return_type write(const rclcpp::Time&, const rclcpp::Duration&) = 0;

 protected:
  HardwareInfo info_;
};

}  // namespace hardware_interface
