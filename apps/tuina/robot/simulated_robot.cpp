// SPDX-License-Identifier: Apache-2.0
#include "apps/tuina/robot/simulated_robot.hpp"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "apps/cli/options.hpp"

namespace tuina::app {
void add_pace_option(Options& options, std::string& pace) {
  options.add("--pace", pace, "real, or max: each waits for the others")
      .one_of({"max", "real"})
      .show_default();
}

void add_link_options(Options& options, std::string& link, std::string& pace) {
  options.add("--link", link, "name of the memory that the processes of a robot share").required();
  add_pace_option(options, pace);
}

link::Pace pace_of(const std::string& name) {
  return name == "real" ? link::Pace::real : link::Pace::max;
}

void SimulatedRobot::describe(Options& options) {
  options.add("--person", order_.person, "as of `tuina massage`").show_default();
  position_.describe(options, "sitting or prone");
  add_robot_option(options, order_.robot);
}

Result<SimulatedRoom> SimulatedRobot::make(const CommonOptions& common,
                                           const sim::PlantOptions& devices) {
  const auto config = effective_config(common);
  if (!config) return tl::unexpected(config.error());
  order_.position = position_.position();
  return make_room(order_, *config, common, devices);
}

Answer SimulatedRobot::answer(const RobotReport& report) {
  return {.json = nlohmann::ordered_json{{"ticks", report.ticks},
                                         {"silent_ticks", report.silent_ticks},
                                         {"max_force_n", report.max_force_n},
                                         {"max_over_60_n_ms", 1e3 * report.max_over_60_n_s}}
                      .dump(2),
          .text = fmt::format("{} ticks, {} without a command, {:.1f} N at most", report.ticks,
                              report.silent_ticks, report.max_force_n)};
}

Result<PerArm<hardware::ArmDevice>> pair_of_addresses(const char* option, const std::string& left) {
  auto udp = hardware::parse_udp_address(left);
  if (!udp || ntohs(udp->of.sin_port) == UINT16_MAX)
    return fail(Fault::usage,
                "{} {}: is no IPv4 address and port below 65535, such as 127.0.0.1:7001", option,
                left);
  PerArm<hardware::ArmDevice> both;
  both[Arm::left] = {.address = left, .udp = *udp};
  const int next = ntohs(udp->of.sin_port) + 1;
  udp->of.sin_port = htons(static_cast<std::uint16_t>(next));
  both[Arm::right] = {.address = fmt::format("{}:{}", left.substr(0, left.rfind(':')), next),
                      .udp = *udp};
  return both;
}

void WristsOption::describe(Options& options, const std::string& usual) {
  wrist_ = usual;
  auto wrist = options.add(
      "--wrist", wrist_,
      "what the arms feel comes by emulated wrist sensors (docs/wrist_sensors.md): where the left "
      "one is; the right one is at the next port");
  if (!usual.empty()) wrist.show_default();
  auto fault = options.add("--wrist-fault", fault_,
                           "what becomes of the left sensor: silent for 10 ms, stuck, or off");
  fault.one_of({"silent", "stuck", "off"});
  auto at = options.add("--wrist-fault-at-s", failure_.at_s, "when, by the arms' clock");
  if (usual.empty()) fault.needs(wrist), at.needs(wrist);
}

Result<WristsOption::Wrists> WristsOption::make() {
  Wrists wrists;
  if (wrist_.empty()) return wrists;
  if (fault_.empty() == std::isfinite(failure_.at_s))
    return fail(Fault::usage, "--wrist-fault and --wrist-fault-at-s belong together");
  using Kind = WristFailure::Kind;
  failure_.kind = fault_ == "silent"  ? Kind::silent
                  : fault_ == "stuck" ? Kind::stuck
                  : fault_ == "off"   ? Kind::off
                                      : Kind::none;
  const auto addresses = pair_of_addresses("--wrist", wrist_);
  if (!addresses) return tl::unexpected(addresses.error());
  for (const Arm arm : both_arms) {
    const hardware::ArmDevice& at = (*addresses)[arm];
    auto wrist =
        EmulatedWrist::listen(at.udp, at.address, arm == Arm::left ? failure_ : WristFailure{});
    if (!wrist) return tl::unexpected(wrist.error());
    wrists[arm] = std::move(*wrist);
  }
  return wrists;
}

Result<SharedTruth> share_truth(const std::string& name, const std::string& world,
                                const WristsOption::Wrists& wrists) {
  auto truth = SharedTruth::map(truth_name(name), link::SharedMemory::Use::make);
  if (!truth) return tl::unexpected(truth.error());
  world.copy((*truth)->world.data(), (*truth)->world.size());
  for (const Arm arm : both_arms) {
    auto& page = (*truth)->wrists[arm];
    if (wrists[arm]) wrists[arm]->address().copy(page.data(), page.size());
  }
  return truth;
}

}  // namespace tuina::app
