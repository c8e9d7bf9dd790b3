// SPDX-License-Identifier: Apache-2.0
#include "tuina/history/fleet.hpp"

#include <doctest/doctest.h>

#include "tests/folder.hpp"
#include "tuina/history/fleet_page.hpp"
#include "tuina/history/history.hpp"

using namespace tuina;
using namespace tuina::history;

namespace {

const std::string now = "2026-03-01T12:00:00Z";

std::string cell(const telemetry::Table& table, std::size_t row, const std::string& key) {
  for (std::size_t i = 0; i < table.columns.size(); ++i) {
    if (table.columns[i].key == key)
      return telemetry::shown(table.rows[row].cells[i], table.columns[i]);
  }
  return "no such column";
}

MachineHistory machine_called(const std::string& name, const std::string& seen,
                              const std::string& doing) {
  return {.machine = {.name = name,
                      .model = "thesis",
                      .version = "0.1",
                      .calibrated = "2026-02-19T12:00:00Z",
                      .seen = seen,
                      .doing = doing},
          .sessions = {{.id = name + "-a",
                        .machine = name,
                        .began = "2026-02-28T09:00:00Z",
                        .ended = true,
                        .duration_s = 600.0,
                        .stops = 1,
                        .stop_cause = "wrist sensor silent",
                        .force_rmse_n = 0.25,
                        .force_peak_n = 20.0,
                        .scan_rms_m = 0.5e-3,
                        .uncertainty_m = 6e-3,
                        .zero_n = {0.5, -0.25}},
                       {.id = name + "-b", .machine = name, .began = "2026-03-01T11:55:00Z"}}};
}

}  // namespace

TEST_CASE("time between two stamps counts days of all months, and nothing else is a stamp") {
  CHECK(seconds_between("2026-02-28T23:59:59Z", "2026-03-01T00:00:01Z") == 2.0);
  CHECK(seconds_between("2024-02-28T00:00:00Z", "2024-03-01T00:00:00Z") == 2.0 * 86400.0);
  CHECK(std::isnan(seconds_between("yesterday", now)));
}

TEST_CASE("a session under way is told from one that was cut short") {
  const std::vector<MachineHistory> fleet = {
      machine_called("at-it", "2026-03-01T11:59:50Z", "massage"),
      machine_called("silent", "2026-03-01T11:56:00Z", "massage"),
      machine_called("idle", "2026-03-01T11:59:50Z", "idle"),
      machine_called("off", "2026-03-01T11:57:00Z", "switched off")};
  const telemetry::Table table = fleet_table(fleet, now);
  CHECK(cell(table, 0, "doing") == "massage");
  CHECK(cell(table, 0, "cut_short") == "0");
  CHECK(cell(table, 1, "doing") == "not heard for 4 minutes, then: massage");
  CHECK(cell(table, 2, "doing") == "idle");
  CHECK(cell(table, 3, "doing") == "off since 2026-03-01 11:57");
  for (const std::size_t row : {1U, 2U, 3U}) CHECK(cell(table, row, "cut_short") == "1");
  CHECK(cell(table, 0, "stopped") == "1");
  CHECK(cell(table, 0, "calibration_age_days") == "10");
  CHECK(cell(table, 0, "left_zero_n") == "0.50");
  CHECK(cell(table, 0, "right_zero_n") == "-0.25");
}

TEST_CASE("the page of robots names stops with their causes, and draws what is known") {
  std::vector<MachineHistory> fleet = {machine_called("room-1", now, "massage"),
                                       {.machine = {.name = "new", .seen = now, .doing = "idle"}}};
  const std::string page = fleet_page(fleet, now);
  CHECK(page.find("wrist sensor silent: 1") != std::string::npos);
  CHECK(page.find("Drift of the wrist sensors") != std::string::npos);
  CHECK(page.find("No session with a record yet.") != std::string::npos);
  CHECK(page.find("cut short") == page.rfind("cut short"));  // the head of its column alone
  fleet[0].sessions[0].stops = 0;
  CHECK(fleet_page(fleet, now).find("No session was stopped or cut short.") != std::string::npos);
}

TEST_CASE(
    "a session that has ended without a record leaves the forces of the one before in sight") {
  std::vector<MachineHistory> fleet = {machine_called("room-1", now, "idle")};
  fleet[0].sessions[1].ended = true;
  const telemetry::Table table = fleet_table(fleet, now);
  CHECK(cell(table, 0, "force_rmse_n") == "0.25");
  CHECK(cell(table, 0, "left_zero_n") == "0.50");
  CHECK(fleet_page(fleet, now).find("1 robot, 2 sessions;") != std::string::npos);
}

TEST_CASE("what a wrist feels in the air is told apart from contact") {
  std::vector<telemetry::TraceRow> trace(4);
  trace[0].measured_force_n = 0.2;
  trace[1].measured_force_n = 0.4;
  trace[2].measured_force_n = 20.0;
  trace[2].technique = Technique::press;
  trace[3].arm = Arm::right;
  trace[3].technique = Technique::press;
  const MachineSession session = machine_session_of({}, trace);
  CHECK(session.zero_n[Arm::left] == doctest::Approx(0.3));
  CHECK(std::isnan(session.zero_n[Arm::right]));  // was never in the air
  CHECK(std::isnan(session.uncertainty_m));
}
