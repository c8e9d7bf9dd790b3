// SPDX-License-Identifier: Apache-2.0
#include "armlink_system.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <hardware_interface/types/hardware_interface_type_values.hpp>
#include <pluginlib/class_list_macros.hpp>
#include <rclcpp/logging.hpp>
#include <stdexcept>
#include <thread>

namespace tuina_armlink {
namespace {

using hardware_interface::HardwareInfo;

constexpr int max_silent_cycles = 100;
constexpr std::chrono::seconds ready_within(60);
constexpr std::uint16_t faults = ARMLINK_STOPPED | ARMLINK_DRIVE_FAULT | ARMLINK_EMERGENCY_STOP;

hardware_interface::CallbackReturn refuse(const std::string& why) {
  RCLCPP_ERROR(rclcpp::get_logger("tuina_armlink"), "%s", why.c_str());
  return hardware_interface::CallbackReturn::ERROR;
}

}  // namespace

ArmlinkSystem::CallbackReturn ArmlinkSystem::on_init(const HardwareInfo& info) {
  if (SystemInterface::on_init(info) != CallbackReturn::SUCCESS) return CallbackReturn::ERROR;
  if (info.joints.empty() || info.joints.size() > ARMLINK_MAX_JOINTS)
    return refuse("an arm of armlink has 1 to 7 joints");
  try {
    address_ = info.hardware_parameters.at("address");
    port_ = std::stoi(info.hardware_parameters.at("port"));
    for (const auto& joint : info.joints)
      ready_rad_.push_back(std::stod(joint.parameters.at("ready")));
    if (const auto rail = info.hardware_parameters.find("rail_ready");
        rail != info.hardware_parameters.end())
      rail_ready_m_ = std::stod(rail->second);
  } catch (const std::exception&) {
    return refuse(
        "the hardware needs `address` and `port`, and each joint the angle `ready`, as numbers");
  }
  torque_nm_.assign(info.joints.size(), 0.0);
  return CallbackReturn::SUCCESS;
}

ArmlinkSystem::CallbackReturn ArmlinkSystem::on_configure(const rclcpp_lifecycle::State&) {
  if (!arm_.open(address_, port_)) return refuse(address_ + ": no address of IPv4");
  const auto hello = arm_.ask();
  if (!hello) return refuse(address_ + ": no arm answers");
  if (hello->joints != torque_nm_.size()) return refuse(address_ + ": another number of joints");
  constexpr int needed = 1 << ARMLINK_TORQUE | 1 << ARMLINK_READY;
  if ((hello->modes & needed) != needed) return refuse(address_ + ": no torque mode");
  if ((hello->flags & ARMLINK_HAS_RAIL) != 0 && !rail_ready_m_)
    return refuse(address_ + ": it is on a linear base; say where by `rail_ready`, in metres");
  if ((hello->flags & ARMLINK_BUSY) != 0) return refuse(address_ + ": another host has the arm");
  return CallbackReturn::SUCCESS;
}

ArmlinkSystem::CallbackReturn ArmlinkSystem::on_activate(const rclcpp_lifecycle::State&) {
  std::fill(torque_nm_.begin(), torque_nm_.end(), 0.0);
  silent_cycles_ = 0;
  claimed_.clear();
  hold_rad_ = ready_rad_;
  // A stopped arm begins anew with another session only.
  if (!arm_.open(address_, port_)) return refuse(address_ + ": no address of IPv4");
  const auto end = std::chrono::steady_clock::now() + ready_within;
  while (std::chrono::steady_clock::now() < end) {
    arm_.command(ARMLINK_READY, ready_rad_, rail_ready_m_.value_or(0.0));
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
    const auto state = arm_.newest_state();
    if (!state) continue;
    state_ = *state;
    if ((state_.status & faults) != 0) return refuse(address_ + ": the arm has a fault");
    if (state_.mode == ARMLINK_READY && (state_.status & ARMLINK_STANDS) != 0)
      return CallbackReturn::SUCCESS;
  }
  (void)on_deactivate({});
  return refuse(address_ + ": the arm does not come to its angles `ready`");
}

ArmlinkSystem::CallbackReturn ArmlinkSystem::on_deactivate(const rclcpp_lifecycle::State&) {
  arm_.command(ARMLINK_IDLE, std::vector<double>(torque_nm_.size(), 0.0),
               rail_ready_m_.value_or(0.0));
  return CallbackReturn::SUCCESS;
}

ArmlinkSystem::return_type ArmlinkSystem::perform_command_mode_switch(
    const std::vector<std::string>& start, const std::vector<std::string>& stop) {
  const bool drove = claimed_.size() == torque_nm_.size();
  for (const auto& joint : info_.joints) {
    const std::string effort = joint.name + "/" + hardware_interface::HW_IF_EFFORT;
    if (std::find(stop.begin(), stop.end(), effort) != stop.end()) claimed_.erase(effort);
    if (std::find(start.begin(), start.end(), effort) != start.end()) claimed_.insert(effort);
  }
  const bool drives = claimed_.size() == torque_nm_.size();
  if (drove && !drives) hold_rad_.assign(state_.q_rad, state_.q_rad + torque_nm_.size());
  // Until the new controller has said something, the arm bears itself as it does now.
  if (drives && !drove) std::copy_n(state_.tau_nm, torque_nm_.size(), torque_nm_.begin());
  return return_type::OK;
}

std::vector<hardware_interface::StateInterface> ArmlinkSystem::export_state_interfaces() {
  std::vector<hardware_interface::StateInterface> all;
  for (std::size_t i = 0; i < info_.joints.size(); ++i) {
    const std::string& name = info_.joints[i].name;
    all.emplace_back(name, hardware_interface::HW_IF_POSITION, &state_.q_rad[i]);
    all.emplace_back(name, hardware_interface::HW_IF_VELOCITY, &state_.dq_rad_per_s[i]);
    all.emplace_back(name, hardware_interface::HW_IF_EFFORT, &state_.tau_nm[i]);
  }
  constexpr std::array axes = {"force.x", "force.y", "force.z", "torque.x", "torque.y", "torque.z"};
  for (const auto& sensor : info_.sensors) {
    for (std::size_t i = 0; i < axes.size(); ++i)
      all.emplace_back(sensor.name, axes[i], &state_.wrench_in_tool[i]);
  }
  return all;
}

std::vector<hardware_interface::CommandInterface> ArmlinkSystem::export_command_interfaces() {
  std::vector<hardware_interface::CommandInterface> all;
  for (std::size_t i = 0; i < info_.joints.size(); ++i)
    all.emplace_back(info_.joints[i].name, hardware_interface::HW_IF_EFFORT, &torque_nm_[i]);
  return all;
}

ArmlinkSystem::return_type ArmlinkSystem::read(const rclcpp::Time&, const rclcpp::Duration&) {
  const auto state = arm_.newest_state();
  silent_cycles_ = state ? 0 : silent_cycles_ + 1;
  if (state) state_ = *state;
  const bool lost = silent_cycles_ >= max_silent_cycles || (state_.status & faults) != 0;
  return lost ? return_type::ERROR : return_type::OK;
}

ArmlinkSystem::return_type ArmlinkSystem::write(const rclcpp::Time&, const rclcpp::Duration&) {
  // Torques of nobody would make the arm limp, and nobody drives an arm blind.
  const bool driven = claimed_.size() == torque_nm_.size();
  const bool finite = std::all_of(torque_nm_.begin(), torque_nm_.end(),
                                  [](double torque_nm) { return std::isfinite(torque_nm); });
  // Without a command the arm stops by itself.
  if (driven && !finite) return return_type::ERROR;
  if (silent_cycles_ < ARMLINK_MAX_MISSED)
    arm_.command(driven ? ARMLINK_TORQUE : ARMLINK_READY, driven ? torque_nm_ : hold_rad_,
                 rail_ready_m_.value_or(0.0));
  return return_type::OK;
}

}  // namespace tuina_armlink

PLUGINLIB_EXPORT_CLASS(tuina_armlink::ArmlinkSystem, hardware_interface::SystemInterface)
