// SPDX-License-Identifier: Apache-2.0
#include "apps/simulated/scanned_people.hpp"

#include "tuina/core/units.hpp"
#include "tuina/scanner/sweep.hpp"
#include "tuina/sim/scanner/depth_camera.hpp"
#include "tuina/sim/scanner/laser_scanner.hpp"

namespace tuina::app {

Scan::By parse_scan(std::string_view name) {
  return name == "laser" ? Scan::By::laser : name == "depth" ? Scan::By::depth : Scan::By::ideal;
}

Result<Seen> see(const body::LabelledBody& person, const Scan& look, std::uint64_t seed) {
  if (look.by == Scan::By::ideal) {
    return Seen{.cloud_in_couch = body::sample(person.skin_in_couch, 4_mm)};
  }
  if (look.by == Scan::By::depth) {
    return Seen{.cloud_in_couch = sim::depth_picture(person.skin_in_couch, person.position, seed,
                                                     {.points = look.depth_points})};
  }
  sim::LaserScanner scanner(person.skin_in_couch, person.position, {}, seed);
  const auto calibration = sim::believed_calibration(scanner.true_calibration(), seed);
  auto scan = scanner::scan_sweep(scanner, scanner, calibration);
  if (!scan) return tl::unexpected(scan.error());
  return Seen{.cloud_in_couch = std::move(scan->cloud_in_couch),
              .sweep_s = scan->sweep_s,
              .compute_ms = scan->compute_ms};
}

void scan_body(body::LabelledBody& person, std::uint64_t seed) {
  if (person.skin_in_couch.triangles.empty()) return;
  auto seen = see(person, {.by = Scan::By::laser}, seed);
  // Whom the scanner cannot see is learned from as the skin is.
  if (seen) person.scan_in_couch.points = std::move(seen->cloud_in_couch.points);
}

void scan_everybody(std::vector<body::LabelledBody>& people, std::uint64_t seed,
                    const Progress& progress) {
  for (std::size_t i = 0; i < people.size(); ++i) {
    scan_body(people[i], seed + i);
    if (progress) progress(static_cast<double>(i + 1) / static_cast<double>(people.size()));
  }
}

}  // namespace tuina::app
