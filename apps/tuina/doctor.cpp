// SPDX-License-Identifier: Apache-2.0
#include <sys/resource.h>
#include <unistd.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <thread>

#include "apps/tuina/verbs.hpp"

namespace tuina::app {
namespace {

/// Says what of this machine tuina could use, and what stands in the way.
class Doctor final : public Verb {
 public:
  [[nodiscard]] const char* name() const override { return "doctor"; }
  [[nodiscard]] const char* summary() const override {
    return "check this machine: devices, permissions, real-time limits";
  }
  [[nodiscard]] const char* example() const override { return "tuina doctor"; }
  void describe(Options&) override {}

  [[nodiscard]] Result<Answer> run(const CommonOptions&) override {
    nlohmann::json checks = nlohmann::json::array();
    Answer answer;
    const auto add = [&](const char* what, bool good, const std::string& finding,
                         const char* remedy) {
      checks.push_back(
          {{"check", what}, {"good", good}, {"finding", finding}, {"remedy", good ? "" : remedy}});
      answer.text += fmt::format("{} {:<18} {}{}\n", good ? "ok  " : "note", what, finding,
                                 good ? "" : fmt::format("; {}", remedy));
    };
    const unsigned cores = std::thread::hardware_concurrency();
    add("cores", cores >= 2, fmt::format("{}", cores),
        "two are wanted: one for control, one for the rest");
    const bool camera = std::filesystem::exists("/dev/video0");
    add("camera", camera && ::access("/dev/video0", R_OK | W_OK) == 0,
        camera ? "/dev/video0" : "none found",
        "simulation needs none; else join the group `video`");
    bool serial = false;
    for (const char* port : {"/dev/ttyACM0", "/dev/ttyUSB0"})
      serial = serial || ::access(port, R_OK | W_OK) == 0;
    add("turntable", serial, serial ? "serial port found" : "no serial port",
        "simulation needs none; else plug the Arduino in and join the group `dialout`");
    rlimit limit{};
    ::getrlimit(RLIMIT_RTPRIO, &limit);
    add("real-time", limit.rlim_cur >= 80 || ::geteuid() == 0,
        fmt::format("rtprio limit {}", limit.rlim_cur),
        "simulation needs none; for a robot allow rtprio 80 in /etc/security/limits.d");
    answer.text.pop_back();
    answer.json = nlohmann::json{{"version", TUINA_VERSION}, {"checks", checks}}.dump(2);
    return answer;
  }
};

}  // namespace

std::unique_ptr<Verb> make_doctor() {
  return std::make_unique<Doctor>();
}

}  // namespace tuina::app
