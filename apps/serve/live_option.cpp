// SPDX-License-Identifier: Apache-2.0
#include "apps/serve/live_option.hpp"

#include <chrono>
#include <cstdio>
#include <thread>

#include "apps/cli/asked_to_end.hpp"
#include "apps/serve/page_port.hpp"

namespace tuina::app {

Option LiveOption::describe(Options& options) {
  auto live = options.flag("--live", asked_,
                           "show the session in a browser, where it is armed, steered and stopped "
                           "(docs/page.md)");
  add_page_port(options, port_, &live);
  return live;
}

Result<void> LiveOption::begin(const SessionOrder& order, const session::Config& config,
                               const CommonOptions& common, const Ros2Option& ros2,
                               const std::filesystem::path& folder) {
  if (!asked_) return {};
  auto robot = robot::load_robot(order.robot);
  if (!robot) return tl::unexpected(robot.error());
  auto devices = served_devices(order, common.seed);
  if (!devices) return tl::unexpected(devices.error());
  auto site = LiveSite::open({.place = {.port = port_},
                              .session = {.config = config,
                                          .common = common,
                                          .pace = order.pace,
                                          .robot = order.robot,
                                          .robot_model = std::move(*robot),
                                          .folder = folder,
                                          .ordered = true,
                                          .devices = std::move(*devices)},
                              .node = ros2.node(),
                              .reach = ros2.reach()});
  if (!site) return tl::unexpected(site.error());
  site_ = std::move(*site);
  const std::string line = fmt::format("{}\n", site_->invite());
  std::fputs(line.c_str(), common.json ? stderr : stdout);
  std::fflush(nullptr);
  return {};
}

Attendant LiveOption::attendant() {
  if (!site_) return {};
  site_->session().begin_ordered();
  return site_->session().attendant();
}

void LiveOption::end(const std::string& outcome, std::vector<SentenceLine> said) {
  if (!site_) return;
  site_->session().end_ordered(outcome, std::move(said));
  end_when_asked();
  while (site_->watched() && !asked_to_end())
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
}

}  // namespace tuina::app
