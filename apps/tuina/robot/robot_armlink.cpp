// SPDX-License-Identifier: Apache-2.0
// Simulated robots as processes: for a guard in a process of its own, and for a host of armlink.
#include <unistd.h>

#include "apps/cli/asked_to_end.hpp"
#include "apps/cli/options.hpp"
#include "apps/cli/say.hpp"
#include "apps/simulated/armlink_arms.hpp"
#include "apps/tuina/robot/hand_option.hpp"
#include "apps/tuina/robot/simulated_robot.hpp"
#include "apps/tuina/verbs.hpp"
#include "tuina/core/io/file.hpp"
#include "tuina/link/real_time.hpp"

namespace tuina::app {
namespace {

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
    auto room = robot_.make(common);
    if (!room) return tl::unexpected(room.error());
    auto link = link::Link::open(link_, link::Role::drives);
    if (!link) return tl::unexpected(link.error());
    auto truth = SharedTruth::map(truth_name(link_), link::SharedMemory::Use::write);
    if (!truth) return tl::unexpected(truth.error());
    end_when_asked(AskedAgain::is_nothing_new);
    if (pace_ == "real") {
      const std::string granted = link::be_real_time(link::Priority::loop);
      if (!common.quiet) say(fmt::format("the arms wait for their guard; {}\n", granted));
    }
    const auto report = keep_robot(*link, *truth, *room->world, pace_of(pace_), asked_to_end());
    clear_left(link_);
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
    wrists_.describe(options, {});
    options.add("--out", out_, "a device file by which a session finds all of this");
    hand_.describe(options);
    add_pace_option(options, pace_);
  }
  [[nodiscard]] Result<Answer> run(const CommonOptions& common) override {
    const auto address = pair_of_addresses("--listen", listen_);
    if (!address) return tl::unexpected(address.error());
    auto wrists = wrists_.make();
    if (!wrists) return tl::unexpected(wrists.error());
    auto room = robot_.make(common, {.watchdog_ticks = armlink_watchdog_ticks});
    if (!room) return tl::unexpected(room.error());
    // The arms are called as the memory in which this process tells what is true of them.
    const std::string name = fmt::format("simulated-{}", getpid());
    auto truth = share_truth(name, robot_.world_name(*room->world, common.seed), *wrists);
    if (!truth) return tl::unexpected(truth.error());
    auto arms = ArmlinkArms::listen((*address)[Arm::left].udp, name, *room->world, pace_of(pace_));
    if (!arms) return tl::unexpected(arms.error());
    if (const auto written = write_device_file(*address, *wrists); !written)
      return tl::unexpected(written.error());
    arms->feel_by(std::move(*wrists));
    auto hand = hand_.make(*room);
    if (!hand) return tl::unexpected(hand.error());
    arms->lead_by(std::move(*hand));
    end_when_asked(AskedAgain::is_nothing_new);
    const std::string granted =
        pace_ == "real" ? "; " + link::be_real_time(link::Priority::loop) : "";
    if (!common.quiet) say(fmt::format("the arms wait for their host{}\n", granted));
    const auto report = arms->keep(*room->world, *truth, asked_to_end());
    if (!report) return tl::unexpected(report.error());
    return SimulatedRobot::answer(*report);
  }

 private:
  [[nodiscard]] Result<void> write_device_file(const PerArm<hardware::ArmDevice>& arms,
                                               const WristsOption::Wrists& wrists) const {
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
  WristsOption wrists_;
  HandOption hand_;
  std::string listen_ = "127.0.0.1:7001", pace_ = "real", out_;
};

}  // namespace

std::unique_ptr<Verb> make_robot_armlink() {
  return std::make_unique<RobotArmlink>();
}

std::unique_ptr<Verb> make_robot_simulate() {
  return std::make_unique<RobotSimulate>();
}

}  // namespace tuina::app
