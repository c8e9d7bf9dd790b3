// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <mutex>
#include <optional>

#include "apps/evaluation/safety/sessions.hpp"
#include "apps/simulated/session_order.hpp"
#include "tuina/core/parallel.hpp"
#include "tuina/core/units.hpp"
#include "tuina/session/scan_step.hpp"
#include "tuina/sim/scanner/faulty_scanner.hpp"

namespace tuina::app {
namespace {

using sim::ScanFault;

constexpr double max_point_error_m = 15_mm;
constexpr double max_lit_s = 0.25;

struct ScanClass {
  int number;
  const char* name;
  sim::TimedScanFault fault;
  bool silent = false;  ///< the laser has to be dark soon
};

const std::vector<ScanClass>& scan_classes() {
  static const std::vector<ScanClass> all = {
      {26, "3 % of the frames lost", {ScanFault::frames_lost, 0.03, 0.0}},
      {26, "20 % of the frames lost", {ScanFault::frames_lost, 0.2, 0.0}},
      {26, "camera frozen for 0.5 s", {ScanFault::frames_frozen, 0.5, 2.0}, true},
      {26, "frames cut in half for 0.5 s", {ScanFault::frames_cut, 0.5, 2.0}},
      {26, "frames in the wrong order", {ScanFault::frames_swapped, 0.0, 1.0}},
      {26, "camera silent", {ScanFault::camera_silent, 0.0, 2.0}, true},
      {27, "blurred over 15 pixels", {ScanFault::blurred, 15.0, 0.0}},
      {27, "lamp in a quarter of the picture", {ScanFault::lamp, 120.0, 0.0}},
      {27, "second line beside the line", {ScanFault::second_line, 60.0, 0.0}},
      {27, "band of 10 % covered", {ScanFault::covered, 0.1, 0.0}},
      {27, "band of 40 % covered", {ScanFault::covered, 0.4, 0.0}},
      {28, "motor silent", {ScanFault::motor_silent, 0.0, 2.0}, true},
      {28, "yaw readings stuck for 1 s", {ScanFault::yaw_stuck, 1.0, 2.0}},
      {28, "yaw skips by 2 degrees", {ScanFault::yaw_skips, 2_deg, 3.0}},
  };
  return all;
}

double max_error_m(const sim::Person& person, const body::Mapping& located) {
  double max_m = 0.0;
  for (const Acupoint& found : located.acupoints) {
    for (const Acupoint& truth : person.acupoints) {
      if (truth.name == found.name)
        max_m = std::max(max_m, (found.at_in_couch - truth.at_in_couch).norm());
    }
  }
  return max_m;
}

Result<SessionCell> run_scan_cell(const ScanClass& kind, BodyPosture position, std::uint64_t seed,
                                  const session::Config& config) {
  auto room = make_room({.position = position}, config, {.quiet = true, .seed = seed});
  if (!room) return tl::unexpected(room.error());
  sim::FaultyScanner faulty(room->world->camera(), room->world->turntable(), kind.fault, seed);
  session::Observers nobody({});
  const auto mapped = session::scan_and_map(faulty, faulty, room->order, config, nobody);
  SessionCell cell{.number = kind.number,
                   .name = kind.name,
                   .state = "scan",
                   .person = fmt::format("{} medium", name_of(position))};
  if (mapped) {
    const double error_m = max_error_m(room->world->person(), mapped->located);
    cell.found = fmt::format("accepted, acupoints within {:.1f} mm", to_mm(error_m));
    if (error_m > max_point_error_m)
      cell.broken.push_back(fmt::format("an acupoint is {:.0f} mm off, {:.0f} allowed",
                                        to_mm(error_m), to_mm(max_point_error_m)));
  } else {
    cell.found = "refused: " + mapped.error().message;
  }
  if (faulty.lit()) cell.broken.emplace_back("the laser stays lit");
  if (kind.silent && faulty.lit_after_onset_s() > max_lit_s)
    cell.broken.push_back(fmt::format("the laser is lit for {:.0f} ms more, {:.0f} allowed",
                                      1e3 * faulty.lit_after_onset_s(), 1e3 * max_lit_s));
  return cell;
}

}  // namespace

Result<std::vector<SessionCell>> run_scan_cells(std::uint64_t seed, const session::Config& config,
                                                const Progress& progress) {
  constexpr std::array positions = {BodyPosture::sitting, BodyPosture::prone};
  std::vector<SessionCell> cells(positions.size() * scan_classes().size());
  std::mutex guard;
  std::optional<Error> failure;
  for_each_in_parallel(
      cells.size(),
      [&](std::size_t k) {
        auto cell = run_scan_cell(scan_classes()[k / 2], positions[k % 2], seed, config);
        const std::lock_guard lock(guard);
        if (cell) cells[k] = std::move(*cell);
        if (!cell && !failure) failure = cell.error();
      },
      progress);
  if (failure) return tl::unexpected(*failure);
  return cells;
}

}  // namespace tuina::app
