// SPDX-License-Identifier: Apache-2.0
// A massage whose arms are another program, over UDP.
#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "tests/devices/armlink_stage.hpp"
#include "tuina/core/io/file.hpp"

using nlohmann::json;
using namespace tuina::test;

namespace {

const Words slim = {"--person", "phantom:slim", "--position", "prone"};
/// A person who is scanned again, since the back moves.
const Words moving =
    slim +
    Words{"--seed", "7", "--set", "simulation.shift_mm=20", "--set", "simulation.shift_at_s=5"};

/// The words of a brief massage, but where its record goes.
Words brief_massage(const Folder& folder) {
  return {"massage", "--quiet", "--programme",
          folder.with("brief.toml",
                      "name = \"brief\"\n[[part]]\ntechnique = \"press\"\n"
                      "points = [\"BL47\"]\nrepeats = 1\n"),
          "--out"};
}

json session_of(const Folder& folder, const char* name) {
  const auto file = std::filesystem::path(folder / name) / "session.json";
  return json::parse(tuina::read_file(file).value());
}

/// Another person than the arms are before, and a sensor that cannot feel what they touch.
void refuses_strangers(const Folder& folder, const Words& massage, const std::string& device) {
  const Outcome stranger =
      run_tuina(massage + Words{folder / "stranger", "--device", device, "--seed", "8"} + slim);
  CHECK(stranger.exit_code == 3);
  CHECK(stranger.err.find("the arms are before phantom_slim_prone_7, seed 7") != std::string::npos);
  // Another robot in a file of the same name.
  std::string table = tuina::read_file(TUINA_SOURCE_DIR "/models/robots/thesis.toml").value();
  table.replace(table.find("mass_kg = 1.15"), 14, "mass_kg = 1.25");
  const Outcome other = run_tuina(massage +
                                  Words{folder / "other", "--device", device, "--seed", "7",
                                        "--robot", folder.with("thesis.toml", table)} +
                                  slim);
  CHECK(other.exit_code == 3);
  CHECK_MESSAGE(other.err.find("robot thesis (table ") != std::string::npos, other.err);
  const std::string numb = folder.with(
      "numb.toml", tuina::read_file(device).value() +
                       "[wrist_sensor.left]\nkind = \"ati_udp\"\naddress = \"127.0.0.1:9\"\n"
                       "counts_per_n = [1, 1, 1]\ncounts_per_nm = [1, 1, 1]\nx = [1, 0, 0]\n"
                       "z = [0, 0, 1]\nat_mm = [0, 0, 0]\nzero_at_start = true\n");
  const Outcome real =
      run_tuina(massage + Words{folder / "real", "--device", numb, "--seed", "7"} + slim);
  CHECK(real.exit_code == 3);
  CHECK_MESSAGE(real.err.find("no real sensor feels what they touch") != std::string::npos,
                real.err);
}

/// The same massage with what the arms feel coming by wrist sensors only.
void feels_by_wrists(const Folder& folder, const Words& massage, double own_n) {
  const int port = own_port();
  const std::string other = device_file(folder, port);
  Arms arms(port, moving + Words{"--wrist", "127.0.0.1:" + std::to_string(port + 2), "--out",
                                 folder / "feeling.toml"});
  REQUIRE(is_there(other));
  const Outcome deaf = run_tuina(massage + Words{folder / "deaf", "--device", other} + moving);
  CHECK(deaf.exit_code == 3);
  CHECK_MESSAGE(
      deaf.err.find("the left arm feels by the wrist sensor 127.0.0.1:") != std::string::npos,
      deaf.err);
  const Outcome felt =
      run_tuina(massage + Words{folder / "felt", "--device", folder / "feeling.toml"} + moving);
  REQUIRE_MESSAGE(felt.exit_code == 0, felt.err);
  CHECK(arms.end().exit_code == 0);
  const json session = session_of(folder, "felt");
  const double felt_n = session["massage"]["force"]["rmse_n"];
  MESSAGE("force error, N RMS: arms' own sensors " << own_n << ", wrist sensors " << felt_n);
  CHECK(std::abs(felt_n - own_n) < 0.1);
  CHECK(session["rescans_s"].size() == 1);
  const std::string said = session["devices"]["left"]["wrist"];
  CHECK_MESSAGE(said.find(" samples, 0 lost") != std::string::npos, said);
  const auto page =
      tuina::read_file(std::filesystem::path(folder / "felt") / "report.html").value();
  CHECK(page.find("left wrist sensor " + said) != std::string::npos);
}

}  // namespace

// The emulated sensors' zero, and the sphere and handle of the thesis' tool.
TEST_CASE("an arm weighs its own tool, in twelve ways to hold it") {
  const Folder folder;
  const int port = own_port();
  Arms arms(port, slim + Words{"--seed", "7", "--wrist", "127.0.0.1:" + std::to_string(port + 2),
                               "--out", folder / "feeling.toml"});
  REQUIRE(is_there(device_file(folder, port)));
  const Outcome done = run_tuina({"calibrate", "--wrist", folder / "poses.csv", "--turn", "left",
                                  "--device", folder / "feeling.toml", "--position", "prone",
                                  "--out", folder / "wrist.toml", "--json", "--quiet"});
  REQUIRE_MESSAGE(done.exit_code == 0, done.err);
  CHECK(arms.end().exit_code == 0);
  const json found = json::parse(done.out);
  CHECK(found["poses"] == 12);
  CHECK(found["condition"].get<double>() < 10.0);
  CHECK(std::abs(found["mass_kg"].get<double>() - 0.16) < 0.02);
  constexpr std::array zero_in_tool_n = {3.0, 2.0, 1.5};
  for (std::size_t i = 0; i < 3; ++i)
    CHECK(std::abs(found["offset_n"][i].get<double>() - zero_in_tool_n.at(i)) < 0.3);
  MESSAGE("mass " << found["mass_kg"].get<double>() << " kg, condition "
                  << found["condition"].get<double>() << ", force left "
                  << found["force_rms_n"].get<double>() << " N RMS, offset "
                  << found["offset_n"].dump() << " N");
}

TEST_CASE("a massage over UDP is the massage in one program, to the last bit, rescan and all") {
  const Folder folder;
  const Words massage = brief_massage(folder);
  const int port = own_port();
  const std::string device = device_file(folder, port);
  Arms arms(port, moving);
  REQUIRE(is_there(device));
  refuses_strangers(folder, massage, device);
  const Outcome far = run_tuina(massage + Words{folder / "far", "--device", device} + moving);
  REQUIRE_MESSAGE(far.exit_code == 0, far.err);
  const Outcome& ended = arms.end();
  CHECK_MESSAGE(ended.exit_code == 0, ended.err);
  CHECK(json::parse(ended.out)["silent_ticks"] == 1);  // the last one, which nobody answers
  const Outcome one = run_tuina(massage + Words{folder / "one"} + moving);
  REQUIRE_MESSAGE(one.exit_code == 0, one.err);
  for (const char* file : {"joints.csv", "trace.csv", "distances.csv"}) {
    CAPTURE(file);
    const auto here = tuina::read_file(std::filesystem::path(folder / "one") / file);
    const auto there = tuina::read_file(std::filesystem::path(folder / "far") / file);
    REQUIRE(here.has_value());
    REQUIRE(there.has_value());
    CHECK(*here == *there);
  }
  const json session = session_of(folder, "far");
  CHECK(session["rescans_s"].size() == 1);
  CHECK(session["devices"]["scanner"] == "simulated");
  CHECK(session["devices"]["left"]["lost"] == 0);
  CHECK(session["devices"]["truth_missed_ms"] == 0);
  const auto page = tuina::read_file(std::filesystem::path(folder / "far") / "report.html").value();
  CHECK(page.find("camera and turntable: simulated") != std::string::npos);
  feels_by_wrists(folder, massage, session_of(folder, "one")["massage"]["force"]["rmse_n"]);
}

TEST_CASE("without arms, or with a wrong file, a session ends before it begins") {
  const Folder folder;
  const auto told = [&](const std::string& device, int exit_code) {
    const Outcome outcome =
        run_tuina({"massage", "--device", device, "--out", folder / "out", "--quiet"});
    CHECK(outcome.exit_code == exit_code);
    CHECK_FALSE(std::filesystem::exists(folder / "out"));
    return outcome.err;
  };
  const int port = own_port();
  CHECK(told(device_file(folder, port), 3).find("nobody answers") != std::string::npos);
  CHECK(told(folder / "missing.toml", 2).find("missing.toml") != std::string::npos);
  CHECK(told(folder.with("typo.toml", "[arm.left]\nkind = \"armlink\"\nadress = \"x\"\n"), 2)
            .find("typo.toml:3: `arm.left.adress` is unknown; is `address` meant?") !=
        std::string::npos);
  CHECK(run_tuina({"massage", "--device", "x", "--processes"}).exit_code == 1);
}

TEST_CASE("a doctor names who is missing, one line each, in less than two seconds") {
  const Folder folder;
  const auto begun = std::chrono::steady_clock::now();
  const Outcome outcome =
      run_tuina({"doctor", "--device", device_file(folder, own_port()), "--json"});
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begun;
  CHECK(outcome.exit_code == 3);
  CHECK(took.count() < 2.0);
  const json found = json::parse(outcome.out)["devices"];
  REQUIRE(found.size() == 2);
  for (const json& arm : found) {
    CHECK(arm["good"] == false);
    CHECK(arm["finding"] == "nobody answers");
  }
}
