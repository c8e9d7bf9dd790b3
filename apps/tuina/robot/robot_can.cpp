// SPDX-License-Identifier: Apache-2.0
#include <unistd.h>

#include <cmath>

#include "apps/cli/asked_to_end.hpp"
#include "apps/cli/options.hpp"
#include "apps/cli/say.hpp"
#include "apps/simulated/can/can_arms.hpp"
#include "apps/tuina/robot/hand_option.hpp"
#include "apps/tuina/robot/simulated_robot.hpp"
#include "apps/tuina/verbs.hpp"
#include "tuina/core/io/file.hpp"

namespace tuina::app {
namespace {

/// A simulated robot whose joints are emulated drives of CiA 402.
class RobotCan final : public Verb {
 public:
  [[nodiscard]] const char* name() const override { return "robot can"; }
  [[nodiscard]] const char* summary() const override {
    return "a simulated robot before a person, driven by emulated drives (docs/can_drives.md)";
  }
  [[nodiscard]] const char* example() const override {
    return "tuina robot can --robot standing.toml --out device.toml &\n"
           "  tuina massage --device device.toml --robot standing.toml";
  }
  void describe(Options& options) override {
    robot_.describe(options);
    options.add("--out", out_, "a device file by which a session finds all of this").required();
    wrists_.describe(options, "127.0.0.1:7003");
    options.add("--counts", counts_, "of the motors' encoders in a turn")
        .between(256, 1 << 20)
        .show_default();
    options.add("--unplug", unplugged_, "a bus whose plug is pulled")
        .one_of({"can0", "can1", "can2", "can3"});
    options.add("--unplug-at-s", unplug_.at_s, "when, by the arms' clock");
    hand_.describe(options);
  }
  [[nodiscard]] Result<Answer> run(const CommonOptions& common) override {
    if (unplugged_.empty() == std::isfinite(unplug_.at_s))
      return fail(Fault::usage, "--unplug and --unplug-at-s belong together");
    auto wrists = wrists_.make();
    if (!wrists) return tl::unexpected(wrists.error());
    // Joints are told exactly: it is the emulated encoders that count.
    auto room = robot_.make(common, {.encoder_counts = 0.0});
    if (!room) return tl::unexpected(room.error());
    // The buses are called after the memory in which this process tells what is true of the arms.
    const std::string name = fmt::format("simulated-{}", getpid());
    auto truth = share_truth(name, robot_.world_name(*room->world, common.seed), *wrists);
    if (!truth) return tl::unexpected(truth.error());
    auto arms = CanArms::listen(name, *room->world, counts_);
    if (!arms) return tl::unexpected(arms.error());
    auto hand = hand_.make(*room);
    if (!hand) return tl::unexpected(hand.error());
    (*arms)->lead_by(std::move(*hand));
    if (!unplugged_.empty()) {
      unplug_.bus = static_cast<std::size_t>(unplugged_.back() - '0');
      (*arms)->unplug(unplug_);
    }
    std::string devices;
    for (const Arm arm : both_arms) devices += (*arms)->section(arm) + (*wrists)[arm]->section(arm);
    if (const auto written = write_file(out_, devices); !written)
      return tl::unexpected(written.error());
    (*arms)->feel_by(std::move(*wrists));
    end_when_asked(AskedAgain::is_nothing_new);
    if (!common.quiet) say("the drives wait for their host\n");
    const auto report = (*arms)->keep(*room->world, *truth, asked_to_end());
    if (!report) return tl::unexpected(report.error());
    return SimulatedRobot::answer(*report);
  }

 private:
  SimulatedRobot robot_;
  WristsOption wrists_;
  HandOption hand_;
  CanArms::Unplug unplug_;
  int counts_ = 4096;
  std::string out_, unplugged_;
};

}  // namespace

std::unique_ptr<Verb> make_robot_can() {
  return std::make_unique<RobotCan>();
}

}  // namespace tuina::app
