// SPDX-License-Identifier: Apache-2.0
// `tuina doctor --device` with emulated wrist sensors, and `tuina calibrate --wrist` with what it
// says.
#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <nlohmann/json.hpp>

#include "tests/hardware/scripted_wrist.hpp"
#include "tests/whole/command.hpp"
#include "tuina/core/io/file.hpp"

using namespace tuina;
using nlohmann::json;
using test::Outcome;
using test::run_tuina;
using tests::ScriptedWrist;

TEST_CASE("the doctor says of each wrist sensor who it is, its rate, gaps, noise and drift" *
          doctest::skip(!tests::PseudoTerminal::exist())) {
  ScriptedWrist left({.kind = ScriptedWrist::Kind::hex_serial});
  ScriptedWrist right({.kind = ScriptedWrist::Kind::ati_udp});
  const test::Folder folder;
  const std::string file =
      folder.with("device.toml", left.section("left") + right.section("right"));
  // A busy machine may hold the scripted sensors up for longer than a guard would bear, and the
  // doctor rightly says so; a sensor that is amiss is so each time.
  Outcome done = run_tuina({"doctor", "--device", file, "--json"});
  for (int again = 0; again < 3 && done.exit_code != 0; ++again)
    done = run_tuina({"doctor", "--device", file, "--json"});
  REQUIRE_MESSAGE(done.exit_code == 0, (done.out + done.err));
  const json devices = json::parse(done.out)["devices"];
  REQUIRE(devices.size() == 2);
  for (const json& one : devices) {
    CHECK(one["good"] == true);
    CHECK(one["rate_hz"].get<double>() == doctest::Approx(1000.0).epsilon(0.08));
    CHECK(one["lost"] == 0);
    // Counts move by 2 at most, of 50 a newton, on three axes: sqrt(2 * 3) / 50.
    CHECK(one["noise_n"].get<double>() == doctest::Approx(0.049).epsilon(0.05));
    CHECK(std::abs(one["force_in_tool_n"][1].get<double>() + 4.0) < 0.01);
    CHECK(std::abs(one["torque_in_tool_nm"][2].get<double>() - 0.03) < 0.001);
    CHECK(one["drift_n_per_min"].get<double>() < 1.0);
  }
  CHECK(devices[0]["arm"] == "left");
  CHECK(devices[1]["finding"].get<std::string>().find("status 0") != std::string::npos);
}

TEST_CASE("the doctor names what is amiss with a wrist sensor and exits with 3" *
          doctest::skip(!tests::PseudoTerminal::exist())) {
  ScriptedWrist left({.sample = [](auto& sample) { sample.status = 0x400; }});
  ScriptedWrist right({.kind = ScriptedWrist::Kind::hex_udp,
                       .sample = [](auto& sample) { sample.counts[2] += sample.counter / 4; }});
  const test::Folder folder;
  const std::string file =
      folder.with("device.toml", left.section("left") + right.section("right"));
  const Outcome done = run_tuina({"doctor", "--device", file});
  CHECK(done.exit_code == 3);
  const std::string said = done.out + done.err;
  CHECK_MESSAGE(said.find("none left wrist") != std::string::npos, said);
  CHECK(said.find("it has failed or is not at its box") != std::string::npos);
  // A quarter of a count each millisecond, of 50 a newton: 300 N a minute.
  CHECK(said.find("note right wrist") != std::string::npos);
  CHECK(said.find("let the sensor warm up") != std::string::npos);
}

TEST_CASE("the doctor says which CAN bus of the arms is not there, and exits with 3") {
  ScriptedWrist left({.kind = ScriptedWrist::Kind::ati_udp});
  ScriptedWrist right({.kind = ScriptedWrist::Kind::hex_udp});
  std::string text = left.section("left") + right.section("right");
  for (const char* arm : {"left", "right"})
    text += fmt::format(
        "[arm.{0}]\nkind = \"cia402\"\n[[arm.{0}.joint]]\nbus = \"no_{0}\"\nnode = 1\n"
        "counts_per_turn = 4096\ngear = 100\nrated_torque_nm = 0.6\n",
        arm);
  const test::Folder folder;
  const Outcome done =
      run_tuina({"doctor", "--device", folder.with("device.toml", text), "--json"});
  CHECK(done.exit_code == 3);
  const json devices = json::parse(done.out)["devices"];
  REQUIRE(devices.size() == 4);
  CHECK(devices[0]["bus"] == "no_left");
  CHECK(devices[0]["good"] == false);
  CHECK(devices[0]["load_percent"].get<double>() == doctest::Approx(29.9).epsilon(0.01));
  CHECK(devices[1]["finding"].get<std::string>().find("no_right: there is no such CAN interface") !=
        std::string::npos);
}

#ifdef TUINA_CALIBRATION
TEST_CASE("calibrate --wrist finds a tool from a table, and refuses what is none") {
  std::string rows =
      "qw,qx,qy,qz,force_x_n,force_y_n,force_z_n,torque_x_nm,torque_y_nm,torque_z_nm\n";
  const Eigen::Vector3d com_m(0.03, 0.0, -0.01);
  for (int i = 0; i < 12; ++i) {
    const Eigen::Quaterniond turn(
        Eigen::AngleAxisd(1.2, Eigen::Vector3d(std::cos(i), std::sin(i), 0)) *
        Eigen::AngleAxisd(2.3 * i, Eigen::Vector3d::UnitZ()));
    const Eigen::Vector3d weight_n = turn.inverse() * Eigen::Vector3d(0, 0, -0.5 * 9.81);
    const Eigen::Vector3d torque_nm = com_m.cross(weight_n);
    rows += fmt::format("{},{},{},{},{},{},{},{},{},{}\n", turn.w(), turn.x(), turn.y(), turn.z(),
                        weight_n.x() + 3.0, weight_n.y(), weight_n.z() - 1.0, torque_nm.x(),
                        torque_nm.y() + 0.1, torque_nm.z());
  }
  const test::Folder folder;
  const std::string poses = folder.with("poses.csv", rows), out = folder / "wrist.toml";
  const Outcome done = run_tuina({"calibrate", "--wrist", poses, "--out", out, "--json"});
  REQUIRE_MESSAGE(done.exit_code == 0, done.err);
  const json found = json::parse(done.out);
  CHECK(found["poses"] == 12);
  CHECK(found["mass_kg"].get<double>() == doctest::Approx(0.5));
  CHECK(found["com_mm"][0].get<double>() == doctest::Approx(30.0));
  CHECK(found["offset_n"][0].get<double>() == doctest::Approx(3.0));
  CHECK(found["offset_nm"][1].get<double>() == doctest::Approx(0.1));
  CHECK(read_file(out)->find("[wrist]") != std::string::npos);
  const std::string few = folder.with("few.csv", rows.substr(0, rows.find('\n', 700) + 1));
  const Outcome refused = run_tuina({"calibrate", "--wrist", few, "--out", folder / "no.toml"});
  CHECK(refused.exit_code == 2);
  CHECK(refused.err.find("few.csv") != std::string::npos);
  CHECK_FALSE(read_file(folder / "no.toml").has_value());
  CHECK(run_tuina({"calibrate", "--wrist", poses}).exit_code == 1);
}
#endif
