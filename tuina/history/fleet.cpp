// SPDX-License-Identifier: Apache-2.0
#include "tuina/history/fleet.hpp"

#include <fmt/chrono.h>

#include <chrono>

namespace tuina::history {
namespace {

double mean_uncertainty_m(const std::vector<telemetry::FoundAcupoint>& points) {
  if (points.empty()) return MachineSession::unknown;
  double sum_m = 0.0;
  for (const telemetry::FoundAcupoint& point : points) sum_m += point.acupoint.uncertainty_m;
  return sum_m / static_cast<double>(points.size());
}

}  // namespace

MachineSession machine_session_of(const record::SessionFile& file,
                                  std::span<const telemetry::TraceRow> trace) {
  MachineSession session{.id = {},
                         .machine = {},
                         .began = {},
                         .ended = true,
                         .duration_s = file.massage.duration_s,
                         .stops = static_cast<std::int64_t>(file.stops.size()),
                         .stop_cause = file.stops.empty() ? "" : file.stops.front().cause.words,
                         .force_rmse_n = file.massage.force.rmse_n,
                         .force_peak_n = file.massage.force.peak_n,
                         .scan_rms_m = file.scan.rms_error_m,
                         .uncertainty_m = mean_uncertainty_m(file.acupoints.points)};
  PerArm<double> sum_n = {0.0, 0.0}, rows = {0.0, 0.0};
  for (const telemetry::TraceRow& row : trace) {
    if (row.technique) continue;
    sum_n[row.arm] += row.measured_force_n;
    rows[row.arm] += 1.0;
  }
  for (const Arm arm : both_arms) {
    if (rows[arm] > 0.0) session.zero_n[arm] = sum_n[arm] / rows[arm];
  }
  return session;
}

Result<void> enter(Database& database, const Machine& machine) {
  // A time that lies ahead was said by a clock that was wrong.
  const auto soon = std::chrono::floor<std::chrono::seconds>(std::chrono::system_clock::now()) +
                    std::chrono::minutes(1);
  const Value row[] = {machine.name,
                       machine.model,
                       machine.version,
                       machine.calibrated,
                       machine.seen,
                       machine.doing,
                       fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(soon))};
  return database.run(
      "INSERT INTO machine (name, model, version, calibrated, seen, doing) "
      "VALUES ($1, $2, $3, $4, $5, $6) ON CONFLICT (name) DO UPDATE SET model = excluded.model, "
      "version = excluded.version, calibrated = excluded.calibrated, seen = excluded.seen, "
      "doing = excluded.doing WHERE machine.seen <= excluded.seen OR machine.seen > $7",
      row);
}

Result<void> enter(Database& database, const MachineSession& session) {
  const Value row[] = {session.id,
                       session.machine,
                       session.began,
                       std::int64_t{session.ended},
                       session.duration_s,
                       session.stops,
                       session.stop_cause,
                       session.force_rmse_n,
                       session.force_peak_n,
                       session.scan_rms_m,
                       session.uncertainty_m,
                       session.zero_n[Arm::left],
                       session.zero_n[Arm::right]};
  return database.run(
      "INSERT INTO machine_session (id, machine, began, ended, duration_s, stops, stop_cause, "
      "force_rmse_n, force_peak_n, scan_rms_m, uncertainty_m, left_zero_n, right_zero_n) VALUES "
      "($1, $2, $3, $4, $5, $6, $7, $8, $9, $10, $11, $12, $13) ON CONFLICT (id) DO UPDATE SET "
      "ended = excluded.ended, duration_s = excluded.duration_s, stops = excluded.stops, "
      "stop_cause = excluded.stop_cause, force_rmse_n = excluded.force_rmse_n, "
      "force_peak_n = excluded.force_peak_n, scan_rms_m = excluded.scan_rms_m, "
      "uncertainty_m = excluded.uncertainty_m, left_zero_n = excluded.left_zero_n, "
      "right_zero_n = excluded.right_zero_n WHERE machine_session.ended <= excluded.ended",
      row);
}

Result<std::vector<MachineHistory>> fleet_of(Database& database) {
  const auto machines = database.query(
      "SELECT name, model, version, calibrated, seen, doing FROM machine ORDER BY name", {});
  if (!machines) return tl::unexpected(machines.error());
  std::vector<MachineHistory> fleet;
  for (const Row& row : *machines) {
    MachineHistory& one = fleet.emplace_back();
    one.machine = {as_text(row[0]), as_text(row[1]), as_text(row[2]),
                   as_text(row[3]), as_text(row[4]), as_text(row[5])};
    const Value name[] = {one.machine.name};
    const auto sessions = database.query(
        "SELECT id, began, ended, duration_s, stops, stop_cause, force_rmse_n, force_peak_n, "
        "scan_rms_m, uncertainty_m, left_zero_n, right_zero_n FROM machine_session "
        "WHERE machine = $1 ORDER BY began, id",
        name);
    if (!sessions) return tl::unexpected(sessions.error());
    for (const Row& did : *sessions) {
      one.sessions.push_back({.id = as_text(did[0]),
                              .machine = one.machine.name,
                              .began = as_text(did[1]),
                              .ended = as_whole(did[2]) != 0,
                              .duration_s = as_number(did[3]),
                              .stops = as_whole(did[4]),
                              .stop_cause = as_text(did[5]),
                              .force_rmse_n = as_number(did[6]),
                              .force_peak_n = as_number(did[7]),
                              .scan_rms_m = as_number(did[8]),
                              .uncertainty_m = as_number(did[9]),
                              .zero_n = {as_number(did[10]), as_number(did[11])}});
    }
  }
  return fleet;
}

}  // namespace tuina::history
