// SPDX-License-Identifier: Apache-2.0
#include "tuina/record/session_file.hpp"

#include <doctest/doctest.h>

#include "tests/folder.hpp"
#include "tests/reason.hpp"
#include "tuina/core/io/file.hpp"
#include "tuina/core/units.hpp"
#include "tuina/record/session_tables.hpp"

using namespace tuina;
using namespace tuina::record;

TEST_CASE("a session that is written is the session that is read, and what is amiss is named") {
  SessionFile file{.seed = 7, .person = "phantom:slim", .position = BodyPosture::prone};
  file.order.position = BodyPosture::prone;
  file.order.facts.mass_index = 21.5;
  file.order.commands = {{3.5, session::LiveCommand::softer}};
  file.base_from_couch.translate(Vector3(0.1, -0.2, 0.3))
      .rotate(Eigen::AngleAxisd(0.3, Vector3::UnitZ()));
  file.acupoints.points = {{{"GV4", Vector3(0.0, 0.1, 0.3), Vector3::UnitY(), 8_mm}, std::nullopt}};
  file.massage.late = Lateness{.median_s = 2e-5, .p999_s = 4.5e-4, .max_s = 12.3e-3};
  file.massage.techniques = {{Technique::rub, 0.5, 16.0}};
  file.massage.performed = {{.name = "press GV4",
                             .contact_fault = "none",
                             .programme_n = 22.0,
                             .lowered_by = sentence("by_zone", "{}", "GV4"),
                             .ordered_n = 8.0,
                             .given_n = 7.1,
                             .why = sentence("why_too_short", "the tool did not reach it")}};
  file.plan.notes = {sentence("note_cut", "{}: cut at the {}", "rub GV4", "spine"), {"unsaid"}};
  file.tissue = {{.name = "GV4", .truth = TangentTissue{4.5, 250.0}, .mapped = true}};
  file.stops = {{9.25, sentence("stopped_arm_by", "{} arm: {}", "left", "force over the trip")}};
  file.devices = DeviceRecord{.arms = "armlink", .pace = "real", .traffic = {}, .truth_missed = 2};
  file.devices->traffic[Arm::right] = {.cycles = 900,
                                       .lost = 3,
                                       .late = 1,
                                       .unheard = 4,
                                       .wrist = "127.0.0.1:7003: 9 samples, 0 lost"};
  const std::string text = to_json(file);
  const auto again = parse_session(text, "session.json");
  REQUIRE_MESSAGE(again.has_value(), test::reason(again));
  CHECK(to_json(*again) == text);
  CHECK(again->order.commands == file.order.commands);
  CHECK(again->stops[0].cause == file.stops[0].cause);
  CHECK(again->massage.performed[0].why == file.massage.performed[0].why);
  CHECK(again->plan.notes == file.plan.notes);
  CHECK(again->base_from_couch.isApprox(file.base_from_couch));
  REQUIRE(again->devices.has_value());
  CHECK(again->devices->traffic[Arm::right].lost == 3);
  CHECK(again->devices->traffic[Arm::right].wrist == "127.0.0.1:7003: 9 samples, 0 lost");
  CHECK(again->devices->traffic[Arm::left].wrist.empty());
  REQUIRE(again->massage.late.has_value());
  CHECK(again->massage.late->p999_s == doctest::Approx(4.5e-4));
  CHECK(text.find("\"max\": 12.3\n") != std::string::npos);
  REQUIRE(again->massage.techniques.size() == 1);
  CHECK(again->massage.techniques[0].technique == Technique::rub);

  const auto fault_with = [&](const std::string& right, const std::string& wrong) {
    std::string spoilt = text;
    spoilt.replace(spoilt.find(right), right.size(), wrong);
    return parse_session(spoilt, "session.json").error().message;
  };
  CHECK(fault_with("\"seed\": 7", "\"seed\": -7") ==
        "session.json: is no record of a session: seed is -7, a whole number is needed");
  CHECK(fault_with("\"trouble\": \"none\"", "\"trouble\": null") ==
        "session.json: is no record of a session: massage.performed[0].trouble is null, a text is "
        "needed");
  CHECK(fault_with("\"softer\"", "\"louder\"")
            .find("commands[0].command is \"louder\", \"pause\",") != std::string::npos);
  CHECK(fault_with("\"stops\"", "\"halts\"").find("stops is missing") != std::string::npos);
}

TEST_CASE("an area that rules out nothing is refused, not passed over") {
  const auto said = [](const char* corners) {
    return parse_said(
        fmt::format(R"({{"lay": [], "fixed": [], "no_go": [{{"name": "scar", "corners_m": {}}}]}})",
                    corners),
        "anna");
  };
  REQUIRE_MESSAGE(said("[[0, 0, 0], [1, 0, 0], [0, 1, 0]]").has_value(),
                  test::reason(said("[[0, 0, 0], [1, 0, 0], [0, 1, 0]]")));
  for (const char* few : {"[]", "[[0, 0, 0], [1, 0, 0]]"}) {
    const auto read = said(few);
    REQUIRE_FALSE(read.has_value());
    CAPTURE(read.error().message);
    CHECK(read.error().message.find("anna: no_go `scar` has ") == 0);
  }
}

TEST_CASE("the tables of a session are read as they were written, to the digits that they state") {
  const test::Folder folder;
  const auto kept = [&](const std::string& name, const std::string& text) {
    REQUIRE(write_file(folder / name, text).has_value());
    return std::filesystem::path(folder / name);
  };
  const std::vector<telemetry::TraceRow> trace = {
      {.time_s = 0.005, .arm = Arm::right, .technique = Technique::rub, .depth_m = 4_mm},
      {.time_s = 0.010, .target_n = 12.5, .tool_in_couch = Vector3(0.1, -0.2, 0.3)}};
  const std::string trace_csv = csv_of(trace);
  CHECK(csv_of(read_trace(kept("trace.csv", trace_csv)).value()) == trace_csv);
  JointRow row{.time_s = 0.05, .rail_m = 12_mm};
  for (const Arm arm : both_arms) row.q_rad[arm] = row.torque_nm[arm] = JointVector::Constant(7, 1);
  const std::string joints_csv = csv_of(std::vector{row, row});
  const auto joints = read_joints(kept("joints.csv", joints_csv)).value();
  CHECK(csv_of(joints) == joints_csv);
  CHECK(joints[1].q_rad[Arm::right].size() == 7);
  const std::string distances_csv = csv_of(std::vector<telemetry::ArmDistance>{{.apart_m = 0.3}});
  CHECK(csv_of(read_distances(kept("distances.csv", distances_csv)).value()) == distances_csv);
  CHECK(read_trace(kept("empty.csv", "")).error().message.find("empty.csv:1: no empty of") !=
        std::string::npos);
  const auto cut = read_trace(kept("short.csv", trace_csv.substr(0, trace_csv.size() - 12)));
  REQUIRE_FALSE(cut.has_value());
  CHECK(cut.error().message.find("short.csv:3: `0.010,left,none") != std::string::npos);
}
