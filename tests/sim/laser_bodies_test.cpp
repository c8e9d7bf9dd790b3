// SPDX-License-Identifier: Apache-2.0
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <vector>

#include "tuina/scanner/sweep.hpp"
#include "tuina/sim/person/person.hpp"
#include "tuina/sim/scanner/laser_scanner.hpp"

using namespace tuina;
using namespace tuina::sim;

TEST_CASE(
    "labelled people, sitting and prone, are scanned within 1 mm RMS, every acupoint covered") {
  const std::filesystem::path folder = std::filesystem::path(TUINA_BODIES) / "dev";
  if (!std::filesystem::is_directory(folder)) {
    MESSAGE("skipped: there is no folder " << folder.string());
    return;
  }
  std::vector<std::filesystem::path> bodies;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.path().extension() == ".ply") bodies.push_back(entry.path());
  }
  std::sort(bodies.begin(), bodies.end());
  REQUIRE_FALSE(bodies.empty());
  double sum2 = 0.0;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const auto person = load_person(bodies[i]);
    REQUIRE(person.has_value());
    CAPTURE(person->name);
    LaserScanner scanner(person->skin_in_couch, person->position, {}, i + 1);
    const auto scan = scanner::scan_sweep(scanner, scanner,
                                          believed_calibration(scanner.true_calibration(), i + 1));
    REQUIRE(scan.has_value());
    const ScanTruth truth = compare_with_truth(scan->cloud_in_couch, person->skin_in_couch);
    CHECK(truth.rms_error_m < 1.8e-3);
    sum2 += truth.rms_error_m * truth.rms_error_m;
    for (const Acupoint& acupoint : person->acupoints) {
      CAPTURE(acupoint.name);
      double best2 = 1.0;
      for (const Vector3& point : scan->cloud_in_couch.points) {
        best2 = std::min(best2, (point - acupoint.at_in_couch).squaredNorm());
      }
      CHECK(std::sqrt(best2) < 8e-3);
    }
  }
  const double rms_m = std::sqrt(sum2 / static_cast<double>(bodies.size()));
  MESSAGE("RMS over " << bodies.size()
                      << " people, each with a calibration of its own: " << 1e3 * rms_m << " mm");
  CHECK(rms_m < 1.0e-3);
}
