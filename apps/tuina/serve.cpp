// SPDX-License-Identifier: Apache-2.0
#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <thread>

#include "apps/cli/installed.hpp"
#include "apps/serve/live_site.hpp"
#include "apps/simulated/pace_option.hpp"
#include "apps/tuina/verbs.hpp"

namespace tuina::app {
namespace {

std::atomic<bool> serve_ends = false;

/// The live page of this machine.
class Serve final : public Verb {
 public:
  [[nodiscard]] const char* name() const override { return "serve"; }
  [[nodiscard]] const char* summary() const override {
    return "a page to start, watch and steer massages of simulated people in a browser";
  }
  [[nodiscard]] const char* example() const override { return "tuina serve --port 8642"; }
  void describe(Options& options) override {
    options.add("--port", port_, "of this machine; 0 takes a free one")
        .between(0, 65535)
        .show_default();
    options.add("--listen", listen_, "127.0.0.1 or ::1: no other address is listened at")
        .show_default();
    pace_.describe(options, "real unless given");
    add_robot_option(options, robot_);
    options.add("--out", out_, "folder for the sessions and audit.log").show_default();
    options.add("--page", page_, "folder of the built page, as `./run serve` makes it")
        .show_default();
  }

  [[nodiscard]] Result<Answer> run(const CommonOptions& common) override {
    auto config = effective_config(common);
    if (!config) return tl::unexpected(config.error());
    auto address = web::loopback_address(listen_);
    if (!address) return tl::unexpected(address.error());
    auto robot = robot::load_robot(robot_);
    if (!robot) return tl::unexpected(robot.error());
    std::error_code fault;
    std::filesystem::create_directories(out_, fault);
    if (!std::filesystem::is_directory(out_))
      return fail(Fault::file, "--out {}: the folder cannot be made: {}", out_, fault.message());
    auto site = LiveSite::open({.address = *address,
                                .port = port_,
                                .page = page_,
                                .session = {.config = std::move(*config),
                                            .common = common,
                                            .pace = pace_.pace(1.0),
                                            .robot = robot_,
                                            .robot_model = std::move(*robot),
                                            .folder = out_}});
    if (!site) return tl::unexpected(site.error());
    for (const int asked : {SIGINT, SIGTERM}) std::signal(asked, [](int) { serve_ends = true; });
    const std::string lines = fmt::format("{}\n{}  (Foxglove, Lichtblick: docs/page.md)\n",
                                          (*site)->invite(), (*site)->program_address());
    std::fputs(lines.c_str(), common.json ? stderr : stdout);
    std::fflush(nullptr);
    while (!serve_ends) std::this_thread::sleep_for(std::chrono::milliseconds(50));
    const int port = (*site)->port();
    site->reset();
    return Answer{.json = nlohmann::json{{"port", port}, {"folder", out_}}.dump(2),
                  .text = fmt::format("ended; sessions and audit.log are in {}", out_)};
  }

 private:
  PaceOption pace_;
  int port_ = 8642;
  std::string listen_ = "127.0.0.1";
  std::string robot_ = "thesis";
  std::string out_ = "tuina-sessions";
  std::string page_ = installed_or("page", TUINA_PAGE).string();
};

}  // namespace

std::unique_ptr<Verb> make_serve() {
  return std::make_unique<Serve>();
}

}  // namespace tuina::app
