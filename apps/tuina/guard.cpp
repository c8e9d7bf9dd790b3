// SPDX-License-Identifier: Apache-2.0
// The guard as a process of its own.
#include <nlohmann/json.hpp>

#include "apps/cli/asked_to_end.hpp"
#include "apps/cli/say.hpp"
#include "apps/tuina/robot/simulated_robot.hpp"
#include "apps/tuina/verbs.hpp"
#include "tuina/link/guard_process.hpp"
#include "tuina/link/real_time.hpp"

namespace tuina::app {
namespace {

using nlohmann::ordered_json;

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
    end_when_asked(AskedAgain::is_nothing_new);
    const std::string granted = link::be_real_time(link::Priority::guard);
    if (!common.quiet) say(fmt::format("armed: {}; {}\n", link::describe(*arming), granted));
    const auto report = link::keep_guard(*link, *arming, pace_of(pace_), asked_to_end());
    link::Link::clear_left(link_);
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

}  // namespace

std::unique_ptr<Verb> make_guard() {
  return std::make_unique<GuardVerb>();
}

}  // namespace tuina::app
