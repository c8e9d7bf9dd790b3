// SPDX-License-Identifier: Apache-2.0
// A massage, and a stroke that a hand shows, in which every torque and every reading goes over CAN,
// to and from emulated drives.
#include <doctest/doctest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <regex>
#include <sstream>
#include <thread>

#include "tests/devices/own_port.hpp"
#include "tests/whole/command.hpp"
#include "tuina/core/io/file.hpp"
#include "tuina/core/units.hpp"
#include "tuina/robot/arm_model.hpp"

using nlohmann::json;
using tuina::test::Folder;
using tuina::test::Outcome;
using tuina::test::run_tuina;

namespace {

using Words = std::vector<std::string>;

Words operator+(Words words, const Words& more) {
  words.insert(words.end(), more.begin(), more.end());
  return words;
}

std::string text_of(const std::filesystem::path& file) {
  return tuina::read_file(file, 1 << 24).value_or("");
}

/// The person, and the thesis' robot on a base that stands, for drives on CAN have none.
Words same_world(const Folder& folder, const std::string& position = "prone") {
  const std::string thesis = text_of(TUINA_SOURCE_DIR "/models/robots/thesis.toml");
  const std::string standing =
      std::regex_replace(thesis, std::regex("rail_mm = [^\n]*"), "rail_mm = [0, 0]");
  return {"--person",   "phantom:slim",
          "--position", position,
          "--seed",     "7",
          "--robot",    folder.with("standing.toml", standing)};
}

Words brief_massage(const Folder& folder) {
  return {"massage", "--quiet", "--programme",
          folder.with("brief.toml",
                      "name = \"brief\"\n[[part]]\ntechnique = \"press\"\n"
                      "points = [\"BL47\"]\nrepeats = 1\n"),
          "--out"};
}

/// The program with the drives, which ends with the session of its host.
class Drives {
 public:
  Drives(const Folder& folder, const Words& words, const std::string& position = "prone")
      : device_(folder / "device.toml") {
    std::filesystem::remove(device_);
    const Words all =
        Words{"robot",  "can",     "--quiet",
              "--json", "--wrist", "127.0.0.1:" + std::to_string(tuina::test::own_port()),
              "--out",  device_} +
        same_world(folder, position) + words;
    constexpr int max_s = 600;
    thread_ = std::thread([this, all] { outcome_ = run_tuina(all, max_s); });
    for (int i = 0; i < 600 && !std::filesystem::exists(device_); ++i)
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
    if (std::filesystem::exists(device_)) return;
    thread_.join();
    FAIL("no drives: ", outcome_.err);
  }
  ~Drives() {
    if (thread_.joinable()) thread_.join();
  }
  [[nodiscard]] const Outcome& end() {
    thread_.join();
    return outcome_;
  }
  [[nodiscard]] const std::string& device() const { return device_; }

 private:
  std::string device_;
  Outcome outcome_;
  std::thread thread_;
};

/// Rows of a table of numbers.
std::vector<std::vector<double>> samples_of(const std::string& file) {
  std::istringstream rows(text_of(file));
  std::vector<std::vector<double>> all;
  std::string row, cell;
  std::getline(rows, row);
  while (std::getline(rows, row)) {
    std::istringstream cells(row);
    all.emplace_back();
    while (std::getline(cells, cell, ',')) all.back().push_back(std::stod(cell));
  }
  return all;
}

json session_of(const Folder& folder, const char* name) {
  return json::parse(text_of(std::filesystem::path(folder / name) / "session.json"));
}

}  // namespace

TEST_CASE("a massage over CAN has the force of the massage in one program to 0.1 N") {
  const Folder folder;
  const Words massage = brief_massage(folder), world = same_world(folder);
  Drives drives(folder, {});
  const Outcome asked = run_tuina({"doctor", "--device", drives.device(), "--json"});
  CHECK_MESSAGE(asked.exit_code == 0, asked.out);
  CHECK(json::parse(asked.out)["devices"].size() == 18);  // of it four buses and two sensors
  const Outcome stranger =
      run_tuina(massage + Words{folder / "stranger", "--device", drives.device(), "--seed", "8"});
  CHECK(stranger.exit_code == 3);
  CHECK_MESSAGE(stranger.err.find("the arms are before") != std::string::npos, stranger.err);

  const Outcome far =
      run_tuina(massage + Words{folder / "far", "--device", drives.device()} + world);
  REQUIRE_MESSAGE(far.exit_code == 0, far.err);
  const Outcome& ended = drives.end();
  REQUIRE_MESSAGE(ended.exit_code == 0, ended.err);
  const Outcome one = run_tuina(massage + Words{folder / "one"} + world);
  REQUIRE_MESSAGE(one.exit_code == 0, one.err);
  const json over_can = session_of(folder, "far"), here = session_of(folder, "one");
  const double far_n = over_can["massage"]["force"]["rmse_n"];
  const double one_n = here["massage"]["force"]["rmse_n"];
  const json& traffic = over_can["devices"]["left"];
  MESSAGE("force error, N RMS: one process ", one_n, ", over CAN ", far_n, "; ",
          traffic["cycles"].get<int>(), " cycles, ", traffic["lost"].get<int>(), " lost, ",
          traffic["late"].get<int>(), " late; ", json::parse(ended.out).dump());
  CHECK(std::abs(far_n - one_n) < 0.1);
  CHECK(over_can["massage"]["performed"].size() == here["massage"]["performed"].size());
  CHECK(over_can["devices"]["arms"].get<std::string>().find("/can3") != std::string::npos);
  CHECK(traffic["cycles"] > 10'000);
  CHECK(traffic["lost"] == 0);
  CHECK(over_can["devices"]["truth_missed_ms"] == 0);
}

TEST_CASE("a person who has moved is scanned again, while the arms stand on their brakes") {
  const Folder folder;
  const Words moves = {"--set", "simulation.shift_mm=20", "--set", "simulation.shift_at_s=5"};
  Drives drives(folder, moves);
  const Outcome moved =
      run_tuina(brief_massage(folder) + Words{folder / "moved", "--device", drives.device()} +
                same_world(folder) + moves);
  REQUIRE_MESSAGE(moved.exit_code == 0, moved.err);
  const Outcome& ended = drives.end();
  REQUIRE_MESSAGE(ended.exit_code == 0, ended.err);
  const json session = session_of(folder, "moved");
  const double error_n = session["massage"]["force"]["rmse_n"];
  MESSAGE("force error ", error_n, " N RMS, scanned again at ", session["rescans_s"].dump(), " s");
  CHECK(session["rescans_s"].size() == 1);
  CHECK(session["stops"].empty());
  CHECK(session["devices"]["left"]["lost"] == 0);
  CHECK(error_n < 0.4);
  const json& performed = session["massage"]["performed"];
  CHECK(std::any_of(performed.begin(), performed.end(), [&](const json& done) {
    return done["begin_s"] > session["rescans_s"][0];  // the arms move again after it
  }));
}

TEST_CASE("a bus that is unplugged in a press ends the massage, and no tool presses harder") {
  const Folder folder;
  Drives drives(folder, {"--unplug", "can1", "--unplug-at-s", "10"});
  const Outcome cut =
      run_tuina(brief_massage(folder) + Words{folder / "cut", "--device", drives.device()} +
                same_world(folder));
  CHECK(cut.exit_code == 3);
  CHECK_MESSAGE(cut.err.find("/can1 was unplugged") != std::string::npos, cut.err);
  const Outcome& ended = drives.end();
  REQUIRE_MESSAGE(ended.exit_code == 0, ended.err);
  const json report = json::parse(ended.out);
  MESSAGE(cut.err, report.dump());
  CHECK(report["max_force_n"] < 22.0);  // of the programme
}

TEST_CASE("what a hand shows to an arm on CAN is what it shows to one in this program") {
  const Folder folder;
  const auto record = [&](const std::string& to, const Words& more) {
    return run_tuina(Words{"teach", "record", "--quiet", "--json", "--out", folder / to} +
                     same_world(folder, "sitting") + more);
  };
  const Outcome here = record("here.toml", {});
  REQUIRE_MESSAGE(here.exit_code == 0, here.err);
  Drives drives(folder, {"--hand", "stroke"}, "sitting");
  const Outcome there = record("there.toml", {"--device", drives.device()});
  REQUIRE_MESSAGE(there.exit_code == 0, there.err);
  const Outcome& ended = drives.end();
  REQUIRE_MESSAGE(ended.exit_code == 0, ended.err);
  const json far = json::parse(there.out), one = json::parse(here.out);
  CHECK(far["peak_hand_n"].is_null());
  CHECK(one["contact_s"] > 10.0);
  CHECK(far["contact_s"].get<double>() ==
        doctest::Approx(one["contact_s"].get<double>()).epsilon(0.02));
  const auto a = samples_of(folder / "here.csv"), b = samples_of(folder / "there.csv");
  REQUIRE(a.size() == b.size());
  REQUIRE(a.size() > 2000);
  // Joints in degrees, force in newtons.
  const auto model = tuina::robot::both_models(
      tuina::robot::thesis_arm(),
      tuina::robot::mount_for(tuina::BodyPosture::sitting))[tuina::Arm::left];
  const auto tool = [&](const std::vector<double>& sample) -> tuina::Vector3 {
    tuina::JointVector q_rad(6);
    for (int i = 0; i < 6; ++i) q_rad[i] = tuina::from_deg(sample[static_cast<std::size_t>(i) + 1]);
    return model.base_from_tool(q_rad, 0.0).translation();
  };
  double off2_m2 = 0.0, max_off_m = 0.0, off2_n2 = 0.0, max_off_deg = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const double off_m = (tool(a[i]) - tool(b[i])).norm();
    max_off_m = std::max(max_off_m, off_m);
    off2_m2 += off_m * off_m;
    off2_n2 += std::pow(a[i].back() - b[i].back(), 2);
    for (std::size_t k = 1; k <= 6; ++k)
      max_off_deg = std::max(max_off_deg, std::abs(a[i][k] - b[i][k]));
  }
  const auto count = static_cast<double>(a.size());
  const double off_mm = 1e3 * std::sqrt(off2_m2 / count), off_n = std::sqrt(off2_n2 / count);
  MESSAGE("over CAN and in one program: the tool ", off_mm, " mm RMS apart, at most ",
          1e3 * max_off_m, " mm, the force ", off_n, " N RMS, a joint at most ", max_off_deg,
          " deg");
  CHECK(off_mm < 1.0);
  CHECK(off_n < 0.2);
  CHECK(max_off_deg < 2.0);
}
