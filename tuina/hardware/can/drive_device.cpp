// SPDX-License-Identifier: Apache-2.0
#include "tuina/hardware/can/drive_device.hpp"

#include <algorithm>
#include <array>
#include <set>

#include "tuina/core/units.hpp"
#include "tuina/hardware/can/cia402.hpp"
#include "tuina/hardware/can/emulated_bus.hpp"

namespace tuina::hardware {
namespace {

constexpr std::size_t max_buses = 4;
constexpr int max_count = 1 << 30;

DriveDevice read_drive(const TomlTable& table) {
  DriveDevice drive;
  table.only({"zero_count", "reversed"},
             {"bus", "node", "counts_per_turn", "gear", "rated_torque_nm"}, "a drive");
  drive.bus = table.text("bus").value_or("");
  const bool emulated = emulator_of(drive.bus).has_value();
  const std::size_t max_name = emulated ? 80 : 15;  // of an interface of Linux
  if (table.has("bus") && (drive.bus.empty() || drive.bus.size() > max_name))
    table.wrong("bus", "is no CAN interface, such as \"can0\"");
  drive.node =
      static_cast<std::uint8_t>(table.whole("node", 1, canopen::host_node - 1).value_or(1));
  drive.counts_per_turn = table.whole("counts_per_turn", 4, 1 << 24).value_or(4);
  drive.gear =
      table.number("gear", 1.0, 1000.0, "turns of the motor for one of the joint").value_or(1.0);
  drive.rated_torque_nm =
      table.number("rated_torque_nm", 1e-3, 100.0, "at the motor's shaft").value_or(1.0);
  drive.zero_count = table.whole("zero_count", -max_count, max_count).value_or(0);
  drive.reversed = table.flag("reversed").value_or(false);
  // A place of the joint within a turn of its zero is a number of 32 bits.
  if (2.0 * drive.counts_per_turn * drive.gear > max_count)
    table.wrong("counts_per_turn", "and `gear` make more counts a turn of the joint than 2^29");
  return drive;
}

}  // namespace

double DriveDevice::counts_per_rad() const noexcept {
  return (reversed ? -1.0 : 1.0) * counts_per_turn * gear / (2.0 * pi);
}

double DriveDevice::rated_torque_at_joint_nm() const noexcept {
  return (reversed ? -1.0 : 1.0) * rated_torque_nm * gear;
}

DrivenArm read_driven_arm(const TomlTable& table) {
  DrivenArm arm;
  table.only({"bits_per_s"}, {"kind", "joint"});
  constexpr std::array rates = {125'000, 250'000, 500'000, 800'000, 1'000'000};
  arm.bits_per_s = table.whole("bits_per_s", rates.front(), rates.back()).value_or(rates.back());
  if (std::find(rates.begin(), rates.end(), arm.bits_per_s) == rates.end())
    table.wrong("bits_per_s", fmt::format("is not one of {}", fmt::join(rates, ", ")));
  for (const TomlTable& joint : table.tables("joint")) arm.joints.push_back(read_drive(joint));
  if (table.has("joint") && (arm.joints.empty() || arm.joints.size() > max_joints))
    table.reject("joint", fmt::format("{} joints are named by [[joint]], 1 to {} can be",
                                      arm.joints.size(), max_joints));
  return arm;
}

std::vector<BusLoad> bus_loads(const PerArm<DrivenArm>& arms) {
  std::vector<BusLoad> loads;
  for (const DrivenArm& arm : arms.of) {
    for (const DriveDevice& drive : arm.joints) {
      auto load = std::find_if(loads.begin(), loads.end(),
                               [&](const BusLoad& one) { return one.bus == drive.bus; });
      if (load == loads.end()) load = loads.insert(loads.end(), {.bus = drive.bus});
      ++load->drives;
      load->share = std::max(
          load->share, cia402::bits_a_cycle(load->drives) / (control_period_s * arm.bits_per_s));
    }
  }
  return loads;
}

std::string fault_of(const PerArm<DrivenArm>& arms) {
  std::set<std::pair<std::string, int>> named;
  for (const DrivenArm& arm : arms.of)
    for (const DriveDevice& drive : arm.joints)
      if (!named.emplace(drive.bus, drive.node).second)
        return fmt::format("node {} at {} is named twice; each drive has a node of its own",
                           drive.node, drive.bus);
  const auto loads = bus_loads(arms);
  for (const BusLoad& load : loads)
    if (emulator_of(load.bus) != emulator_of(loads.front().bus))
      return fmt::format("{} and {} do not go together: drives are real, or all of one program",
                         loads.front().bus, load.bus);
  for (const BusLoad& load : loads)
    if (load.share > 1.0)
      return fmt::format(
          "{} carries {} drives, which takes {:.0f} % of its bits in each millisecond; share them "
          "among two buses",
          load.bus, load.drives, 100.0 * load.share);
  if (loads.size() > max_buses)
    return fmt::format("{} buses are named, {} can be heard in one millisecond", loads.size(),
                       max_buses);
  return {};
}

}  // namespace tuina::hardware
