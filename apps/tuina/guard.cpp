// SPDX-License-Identifier: Apache-2.0
// The processes that a session can be given: the guard, and a simulated robot, near or far.
#include <unistd.h>

#include <cmath>
#include <csignal>
#include <nlohmann/json.hpp>

#include "apps/simulated/armlink_arms.hpp"
#include "apps/simulated/robot_process.hpp"
#include "apps/simulated/session_order.hpp"
#include "apps/tuina/verbs.hpp"
#include "tuina/core/io/file.hpp"

namespace tuina::app {
namespace {

using nlohmann::ordered_json;

std::atomic<bool> ends = false;

void end_when_asked() {
  for (const int asked : {SIGINT, SIGTERM}) std::signal(asked, [](int) { ends = true; });
}

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

/// The guard of one robot, which has the last word and outlives the session that armed it.
class GuardVerb final : public Verb {
 public:
  [[nodiscard]] const char* name() const override { return "guard"; }
  [[nodiscard]] const char* summary() const override {
    return "guard a robot in a process of its own";
  }
  [[nodiscard]] const char* example() const override {
    return "tuina guard --arm person.arming --link clinic";
  }
  void describe(Options& options) override {
    options.add("--arm", file_, "what a session has written for its guard").required();
    add_link_options(options, link_, pace_);
  }
  [[nodiscard]] Result<Answer> run(const CommonOptions& common) override {
    const auto arming = link::read_arming(file_);
    if (!arming) return tl::unexpected(arming.error());
    auto link = link::Link::open(link_, link::Role::guard);
    if (!link) return tl::unexpected(link.error());
    end_when_asked();
    const std::string granted = link::be_real_time();
    if (!common.quiet) fmt::print(stderr, "armed: {}; {}\n", link::describe(*arming), granted);
    const auto report = link::keep_guard(*link, *arming, pace_of(pace_), ends);
    if (!report) return tl::unexpected(report.error());
    ordered_json json = {{"ticks", report->ticks},
                         {"silent_ticks", report->silent_ticks},
                         {"max_check_us", report->max_check_us}};
    bool stopped = false;
    for (const Arm arm : both_arms) {
      const safety::Verdict& last = report->last[arm];
      json["last"][tuina::name_of(arm)] = {{"action", safety::name_of(last.action)},
                                           {"cause", safety::name_of(last.cause)}};
      stopped = stopped || last.latched;
    }
    return Answer{.json = json.dump(2),
                  .text = fmt::format("{} ticks guarded, {} without a proposal, longest {:.0f} us",
                                      report->ticks, report->silent_ticks, report->max_check_us),
                  .exit_code = stopped ? 4 : 0};
  }

 private:
  std::string file_, link_, pace_ = "real";
};

/// A person and a robot, as `tuina massage` names them.
class SimulatedRobot {
 public:
  void describe(Options& options) {
    options.add("--person", order_.person, "as of `tuina massage`").show_default();
    options.add("--position", position_, "sitting or prone")
        .one_of({"auto", "sitting", "prone"})
        .show_default();
    add_robot_option(options, order_.robot);
  }
  [[nodiscard]] Result<SimulatedRoom> make(const CommonOptions& common, int watchdog_ticks) {
    const auto config = effective_config(common);
    if (!config) return tl::unexpected(config.error());
    if (position_ == "sitting") order_.position = BodyPosture::sitting;
    if (position_ == "prone") order_.position = BodyPosture::prone;
    return make_room(order_, *config, common, watchdog_ticks);
  }
  [[nodiscard]] std::string world_name(const sim::World& world, std::uint64_t seed) const {
    return app::world_name(order_, world, seed);
  }
  [[nodiscard]] static Answer answer(const RobotReport& report) {
    return {.json = ordered_json{{"ticks", report.ticks},
                                 {"silent_ticks", report.silent_ticks},
                                 {"max_force_n", report.max_force_n},
                                 {"max_over_60_n_ms", 1e3 * report.max_over_60_n_s}}
                        .dump(2),
            .text = fmt::format("{} ticks, {} without a command, {:.1f} N at most", report.ticks,
                                report.silent_ticks, report.max_force_n)};
  }

 private:
  SessionOrder order_;
  std::string position_ = "auto";
};

/// A simulated robot before its simulated person, at the other end of a link.
class RobotSimulate final : public Verb {
 public:
  [[nodiscard]] const char* name() const override { return "robot simulate"; }
  [[nodiscard]] const char* summary() const override {
    return "a simulated robot before a person, as a process that a guard drives";
  }
  [[nodiscard]] const char* example() const override {
    return "tuina robot simulate --link clinic --person phantom:hefty --position prone";
  }
  void describe(Options& options) override {
    robot_.describe(options);
    add_link_options(options, link_, pace_);
  }
  [[nodiscard]] Result<Answer> run(const CommonOptions& common) override {
    auto room = robot_.make(common, sim::PlantOptions{}.watchdog_ticks);
    if (!room) return tl::unexpected(room.error());
    auto link = link::Link::open(link_, link::Role::drives);
    if (!link) return tl::unexpected(link.error());
    auto truth = SharedTruth::map(truth_name(link_), link::SharedMemory::Use::write);
    if (!truth) return tl::unexpected(truth.error());
    end_when_asked();
    const auto report = keep_robot(*link, *truth, *room->world, pace_of(pace_), ends);
    if (!report) return tl::unexpected(report.error());
    return SimulatedRobot::answer(*report);
  }

 private:
  SimulatedRobot robot_;
  std::string link_, pace_ = "real";
};

/// The same at the other ends of armlink, one for each arm.
class RobotArmlink final : public Verb {
 public:
  [[nodiscard]] const char* name() const override { return "robot armlink"; }
  [[nodiscard]] const char* summary() const override {
    return "a simulated robot before a person, whose arms are driven over UDP (docs/armlink.md)";
  }
  [[nodiscard]] const char* example() const override {
    return "tuina robot armlink --listen 127.0.0.1:7001 --pace max &\n"
           "  tuina massage --device device.toml";
  }
  void describe(Options& options) override {
    robot_.describe(options);
    options.add("--listen", listen_, "where the left arm is; the right one is at the next port")
        .show_default();
    auto wrist = options.add(
        "--wrist", wrist_,
        "what the arms feel comes by emulated wrist sensors (docs/wrist_sensors.md): where the "
        "left one is; the right one is at the next port");
    options
        .add("--wrist-fault", wrist_fault_,
             "what becomes of the left sensor: silent for 10 ms, stuck, or off")
        .one_of({"silent", "stuck", "off"})
        .needs(wrist);
    options.add("--wrist-fault-at-s", wrist_failure_.at_s, "when, by the arms' clock").needs(wrist);
    options.add("--out", out_, "a device file by which a session finds all of this");
    add_pace_option(options, pace_);
  }
  [[nodiscard]] Result<Answer> run(const CommonOptions& common) override {
    const auto address = pair_of_addresses("--listen", listen_);
    if (!address) return tl::unexpected(address.error());
    auto wrists = emulated_wrists();
    if (!wrists) return tl::unexpected(wrists.error());
    auto room = robot_.make(common, armlink_watchdog_ticks);
    if (!room) return tl::unexpected(room.error());
    // The arms are called as the memory in which this process tells what is true of them.
    const std::string name = fmt::format("simulated-{}", getpid());
    auto truth = SharedTruth::map(truth_name(name), link::SharedMemory::Use::make);
    if (!truth) return tl::unexpected(truth.error());
    auto& world = (*truth)->world;
    robot_.world_name(*room->world, common.seed).copy(world.data(), world.size());
    for (const Arm arm : both_arms) {
      auto& page = (*truth)->wrists[arm];
      if ((*wrists)[arm]) (*wrists)[arm]->address().copy(page.data(), page.size());
    }
    auto arms = ArmlinkArms::listen((*address)[Arm::left].udp, name, *room->world, pace_of(pace_));
    if (!arms) return tl::unexpected(arms.error());
    if (const auto written = write_device_file(*address, *wrists); !written)
      return tl::unexpected(written.error());
    arms->feel_by(std::move(*wrists));
    end_when_asked();
    const std::string granted = pace_ == "real" ? "; " + link::be_real_time() : "";
    if (!common.quiet) fmt::print(stderr, "the arms wait for their host{}\n", granted);
    const auto report = arms->keep(*room->world, *truth, ends);
    if (!report) return tl::unexpected(report.error());
    return SimulatedRobot::answer(*report);
  }

 private:
  using Wrists = PerArm<std::unique_ptr<EmulatedWrist>>;
  /// The address that an option gives, and the one at the next port.
  [[nodiscard]] static Result<PerArm<hardware::ArmDevice>> pair_of_addresses(
      const char* option, const std::string& left) {
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
  [[nodiscard]] Result<Wrists> emulated_wrists() {
    Wrists wrists;
    if (wrist_.empty()) return wrists;
    if (wrist_fault_.empty() == std::isfinite(wrist_failure_.at_s))
      return fail(Fault::usage, "--wrist-fault and --wrist-fault-at-s belong together");
    using Kind = WristFailure::Kind;
    wrist_failure_.kind = wrist_fault_ == "silent"  ? Kind::silent
                          : wrist_fault_ == "stuck" ? Kind::stuck
                          : wrist_fault_ == "off"   ? Kind::off
                                                    : Kind::none;
    const auto addresses = pair_of_addresses("--wrist", wrist_);
    if (!addresses) return tl::unexpected(addresses.error());
    for (const Arm arm : both_arms) {
      const hardware::ArmDevice& at = (*addresses)[arm];
      auto wrist = EmulatedWrist::listen(at.udp, at.address,
                                         arm == Arm::left ? wrist_failure_ : WristFailure{});
      if (!wrist) return tl::unexpected(wrist.error());
      wrists[arm] = std::move(*wrist);
    }
    return wrists;
  }
  [[nodiscard]] Result<void> write_device_file(const PerArm<hardware::ArmDevice>& arms,
                                               const Wrists& wrists) const {
    if (out_.empty()) return {};
    std::string text;
    for (const Arm arm : both_arms) {
      text += fmt::format("[arm.{}]\nkind = \"armlink\"\naddress = \"{}\"\n", tuina::name_of(arm),
                          arms[arm].address);
      if (wrists[arm]) text += wrists[arm]->section(arm);
    }
    return write_file(out_, text);
  }

  SimulatedRobot robot_;
  std::string listen_ = "127.0.0.1:7001", pace_ = "real", wrist_, wrist_fault_, out_;
  WristFailure wrist_failure_;
};

}  // namespace

std::unique_ptr<Verb> make_guard() {
  return std::make_unique<GuardVerb>();
}

std::unique_ptr<Verb> make_robot_armlink() {
  return std::make_unique<RobotArmlink>();
}

std::unique_ptr<Verb> make_robot_simulate() {
  return std::make_unique<RobotSimulate>();
}

}  // namespace tuina::app
