// SPDX-License-Identifier: Apache-2.0
#include <nlohmann/json.hpp>

#include "apps/tuina/doctor/ask_wrists.hpp"
#include "apps/tuina/doctor/check_machine.hpp"
#include "apps/tuina/scan_device.hpp"
#include "apps/tuina/verbs.hpp"
#include "tuina/core/units.hpp"
#include "tuina/hardware/arm_peer.hpp"
#include "tuina/hardware/can/drive_setup.hpp"
#include "tuina/hardware/device_file.hpp"

namespace tuina::app {
namespace {

using nlohmann::ordered_json;

/// What an arm says of itself, and how fast; it is not moved and keeps no session.
struct FoundArm {
  ordered_json json;
  std::string finding;
  bool good = false;
};

/// Why no session can drive an arm that says so; empty where one can.
std::string hindrance(const hardware::armlink::Hello& hello) {
  namespace armlink = hardware::armlink;
  constexpr int needed_modes =
      armlink::bit_of(armlink::Mode::torque) | armlink::bit_of(armlink::Mode::ready);
  if ((hello.modes & needed_modes) != needed_modes)
    return "; it takes no torques, and armlink drives no other arms (docs/position_arms.md)";
  if (hello.cycle_us != 1000) return "; its cycle must be 1000 us";
  if ((hello.flags & armlink::flag::busy) != 0)
    return "; another host has it: end that program, or wait a second";
  return {};
}

FoundArm ask_arm(const hardware::ArmDevice& device) {
  FoundArm found{.json = {{"address", device.address}}};
  const auto peer = hardware::ArmPeer::open(device.udp);
  if (!peer) {
    found.finding = peer.error().message;
    return found;
  }
  const hardware::armlink::Hello& hello = peer->hello();
  namespace flag = hardware::armlink::flag;
  const auto says = [&](std::uint16_t bit) { return (hello.flags & bit) != 0; };
  const auto list = [](const JointVector& joints, double scale) {
    std::vector<double> numbers(joints.begin(), joints.end());
    for (double& number : numbers) number *= scale;
    return numbers;
  };
  const std::string why_not = hindrance(hello);
  found.good = why_not.empty();
  found.json.update(ordered_json{
      {"name", std::string(hello.called())},
      {"joints", hello.max_torque_nm.size()},
      {"cycle_us", hello.cycle_us},
      {"round_trip_ms",
       {{"min", 1e3 * peer->min_round_trip_s()}, {"max", 1e3 * peer->max_round_trip_s()}}},
      {"max_torque_nm", list(hello.max_torque_nm, 1.0)},
      {"max_speed_rad_per_s", list(hello.max_speed_rad_per_s, 1.0)},
      {"min_deg", list(hello.min_rad, to_deg(1.0))},
      {"max_deg", list(hello.max_rad, to_deg(1.0))},
      {"rail_mm", {to_mm(hello.min_rail_m), to_mm(hello.max_rail_m)}},
      {"has_rail", says(flag::has_rail)},
      {"simulated", says(flag::simulated)},
      {"waits", says(flag::waits)},
      {"busy", says(flag::busy)}});
  found.finding = fmt::format(
      "{}: {} joints, {:g} to {:g} Nm, cycle {} us, round trip {:.2f} to {:.2f} ms{}{}{}",
      hello.called(), hello.max_torque_nm.size(), hello.max_torque_nm.minCoeff(),
      hello.max_torque_nm.maxCoeff(), hello.cycle_us, 1e3 * peer->min_round_trip_s(),
      1e3 * peer->max_round_trip_s(),
      says(flag::has_rail) ? fmt::format(", base {:.0f} to {:.0f} mm", to_mm(hello.min_rail_m),
                                         to_mm(hello.max_rail_m))
                           : "",
      says(flag::simulated) ? ", simulated" : "", why_not);
  return found;
}

/// Lines of the answer, each also as JSON; what is not good makes it exit with 3.
struct Findings {
  ordered_json& all;
  Answer& answer;
  void add(const std::string& who, bool good, const std::string& finding, ordered_json json) {
    answer.text += fmt::format("{} {:<18} {}\n", good ? "ok  " : "none", who, finding);
    json.update(ordered_json{{"good", good}, {"finding", finding}});
    all.push_back(std::move(json));
    if (!good) answer.exit_code = 3;
  }
};

void ask_drive(hardware::CanBus& bus, const hardware::DriveDevice& device, Arm arm,
               std::size_t joint, Findings& findings) {
  const auto found = hardware::find_drive(bus, device);
  ordered_json json = {{"device", "drive"},
                       {"arm", tuina::name_of(arm)},
                       {"joint", joint},
                       {"bus", bus.name()},
                       {"node", device.node}};
  std::string finding = found ? "" : found.error().message;
  if (found) {
    finding = fmt::format(
        "node {} at {}: vendor 0x{:X}, product 0x{:X}, serial 0x{:X}, at {:.1f} deg, {}",
        device.node, bus.name(), found->vendor, found->product, found->serial,
        to_deg(found->joint_rad), hardware::cia402::name_of(found->state));
    json.update(ordered_json{{"vendor", found->vendor},
                             {"product", found->product},
                             {"serial", found->serial},
                             {"joint_deg", to_deg(found->joint_rad)},
                             {"state", hardware::cia402::name_of(found->state)}});
  }
  const bool in_fault = found && found->state == hardware::cia402::State::fault;
  findings.add(fmt::format("{} joint {}", tuina::name_of(arm), joint), found && !in_fault, finding,
               std::move(json));
}

/// What each bus has to carry, and who the drives on it are. Nothing is set and nothing moves.
void ask_drives(const PerArm<hardware::DrivenArm>& arms, Findings findings) {
  for (const hardware::BusLoad& load : hardware::bus_loads(arms)) {
    auto bus = hardware::CanBus::open(load.bus);
    findings.add(load.bus, bus.has_value(),
                 bus ? fmt::format("{} drives, {:.0f} % of its bits in each millisecond",
                                   load.drives, 100.0 * load.share)
                     : bus.error().message,
                 {{"device", "bus"}, {"bus", load.bus}, {"load_percent", 100.0 * load.share}});
    if (!bus) continue;
    for (const Arm arm : both_arms)
      for (std::size_t i = 0; i < arms[arm].joints.size(); ++i)
        if (arms[arm].joints[i].bus == load.bus)
          ask_drive(*bus, arms[arm].joints[i], arm, i + 1, findings);
  }
}

/// Says what of this machine tuina could use, and what stands in the way.
class Doctor final : public Verb {
 public:
  [[nodiscard]] const char* name() const override { return "doctor"; }
  [[nodiscard]] const char* summary() const override {
    return "check this machine: devices, permissions, real-time limits";
  }
  [[nodiscard]] const char* example() const override { return "tuina doctor --device device.toml"; }
  void describe(Options& options) override {
    options
        .add("--seconds", seconds_,
             "how long wake-ups are watched; a stall that stops a massage may come once a minute")
        .between(0.1, 3600.0)
        .show_default();
    options.add(
        "--device", device_,
        "ask the arms, the wrist sensors, the camera and the turntable that this file names "
        "(docs/armlink.md, docs/can_drives.md, docs/wrist_sensors.md, docs/build_a_scanner.md); 3 "
        "where one is missing");
  }

  [[nodiscard]] Result<Answer> run(const CommonOptions& common) override {
    hardware::DeviceFile devices;
    if (!device_.empty()) {
      auto read = hardware::read_device_file(device_);
      if (!read) return tl::unexpected(read.error());
      devices = std::move(*read);
    }
    nlohmann::json checks = nlohmann::json::array();
    Answer answer;
    constexpr double long_s = 2.0;
    const Progress bar = seconds_ > long_s ? progress_bar(common, "wake-ups") : nullptr;
    for (const MachineCheck& check : check_machine(seconds_, bar)) {
      checks.push_back({{"check", check.what},
                        {"good", check.good},
                        {"finding", check.finding},
                        {"remedy", check.remedy}});
      answer.text += fmt::format("{} {:<18} {}{}{}\n", check.good ? "ok  " : "note", check.what,
                                 check.finding, check.good ? "" : "; ", check.remedy);
    }
    ordered_json json = {{"version", TUINA_VERSION}, {"checks", checks}};
    if (device_.empty()) {
      answer.text +=
          "A note is no fault: `tuina massage` simulates every device and needs none of this.\n";
    } else {
      json["devices"] = ask_devices(devices, answer);
    }
    answer.text.pop_back();
    answer.json = json.dump(2);
    return answer;
  }

 private:
  static ordered_json ask_devices(const hardware::DeviceFile& devices, Answer& answer) {
    ordered_json all = ordered_json::array();
    for (const Arm arm : both_arms) {
      if (!devices.arms) break;
      const hardware::ArmDevice& device = (*devices.arms)[arm];
      FoundArm found = ask_arm(device);
      answer.text +=
          fmt::format("{} {:<18} {}: {}\n", found.good ? "ok  " : "none",
                      fmt::format("{} arm", tuina::name_of(arm)), device.address, found.finding);
      found.json["arm"] = tuina::name_of(arm);
      found.json["good"] = found.good;
      found.json["finding"] = found.finding;
      all.push_back(std::move(found.json));
      if (!found.good) answer.exit_code = 3;
    }
    if (devices.driven_arms) ask_drives(*devices.driven_arms, {all, answer});
    ask_wrists(devices, all, answer);
    ask_scanner(devices, all, answer);
    return all;
  }

  std::string device_;
  double seconds_ = 0.3;
};

}  // namespace

std::unique_ptr<Verb> make_doctor() {
  return std::make_unique<Doctor>();
}

}  // namespace tuina::app
