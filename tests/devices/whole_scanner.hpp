// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <doctest/doctest.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <regex>
#include <string>
#include <thread>
#include <vector>

#include "tests/hardware/pseudo_terminal.hpp"
#include "tests/whole/command.hpp"
#include "tuina/core/io/file.hpp"

// A whole scanner as its host finds it: the firmware of the board in simavr, an emulated motor
// behind it, and an emulated camera that shows the frames of a simulated scan. They keep the time,
// and wait for tuina where the machine is slow.
namespace tuina::test {

#ifdef TUINA_STAGE
inline const bool has_stage = tests::PseudoTerminal::exist();
#else
inline constexpr bool has_stage = false;
#define TUINA_STAGE ""
#define TUINA_FIRMWARE ""
#endif

inline constexpr const char* no_stage =
    "gcc-avr, arduino-core-avr, libsimavr-dev or a pseudo terminal is missing";

/// A turn of 20 degrees, at nine of the motor's units of speed.
inline const std::vector<std::string> turn = {"--set", "scan.sweep_deg=20", "--set",
                                              "scan.sweep_s=3.336670003336670"};

inline std::string text_of(const std::filesystem::path& file) {
  return read_file(file, 1 << 24).value_or("");
}

/// The frames of a simulated back, and its calibration with another latency.
struct Sweep {
  Folder folder;
  std::string at = folder / "sweep";
  explicit Sweep(const std::vector<std::string>& person) {
    std::vector<std::string> words = {"scan", "--record", at, "--quiet"};
    words.insert(words.end(), person.begin(), person.end());
    words.insert(words.end(), turn.begin(), turn.end());
    const Outcome made = run_tuina(words);
    REQUIRE_MESSAGE(made.exit_code == 0, made.err);
  }
  [[nodiscard]] std::string calibration(const std::string& latency_s) const {
    const std::string text = text_of(at + "/calibration.toml");
    return folder.with("calibration_" + latency_s + ".toml",
                       std::regex_replace(text, std::regex("(yaw_axis[^]*?latency_s = )[^ \n]*"),
                                          "$01" + latency_s));
  }
};

struct Scanned {
  Outcome host;
  nlohmann::json stage;
};

/// Camera and turntable of a device file, as the stage in that folder shows them.
inline std::string scanner_of(const std::string& at) {
  return "[camera]\nkind = \"v4l2\"\naddress = \"" + at +
         "/camera\"\nturned_deg = 90\nexposure_ms = 5\n[turntable]\nkind = \"board\"\naddress = "
         "\"" +
         at + "/board\"\n";
}

/// tuina before the whole stage, which goes wrong once that frame has been shown.
/// FOLDER/device.toml is its device file, and `typed` what is typed at its terminal.
inline Scanned on_stage(const Folder& folder, const Sweep& sweep, const std::string& words,
                        const std::string& fault = "", int frame = 40,
                        const std::string& typed = "") {
  const std::string at = folder.path();
  std::string stage = TUINA_STAGE " " TUINA_FIRMWARE " " + sweep.at + " -10 " + at;
  if (!fault.empty()) stage += " " + fault + " " + std::to_string(frame);
  FILE* end = ::popen((stage + " >" + at + "/stage.out 2>&1").c_str(), "we");
  REQUIRE(end != nullptr);
  for (int i = 0; i < 600 && !std::filesystem::exists(at + "/camera"); ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  const std::string host = "echo $$ >" + at + "/host; exec env TUINA_CLOCK=" + at +
                           "/clock LD_PRELOAD='" TUINA_FAKE_V4L2 "' " TUINA_BINARY " " + words +
                           " --json --device " + at + "/device.toml >" + at + "/out 2>" + at +
                           "/err <" + folder.with("typed", typed);
  const int status = std::system(host.c_str());
  // A board whose host has gone has a moment to notice.
  std::this_thread::sleep_for(std::chrono::seconds(1));
  ::pclose(end);
  CHECK_MESSAGE(std::filesystem::exists(at + "/stage.json"), text_of(at + "/stage.out"));
  return {.host = {.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status),
                   .out = text_of(at + "/out"),
                   .err = text_of(at + "/err")},
          .stage = nlohmann::json::parse(text_of(at + "/stage.json"), nullptr, false)};
}

}  // namespace tuina::test
