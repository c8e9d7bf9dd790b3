// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "tuina/body/learn/labelled_body.hpp"
#include "tuina/core/progress.hpp"
#include "tuina/core/result.hpp"

namespace tuina::app {

/// One labelled person as a scan shows them, and how long scanning took.
struct Seen {
  PointCloud cloud_in_couch;
  double sweep_s = 0.0;
  double compute_ms = 0.0;
};
/// How somebody is scanned: every point of the skin; the simulated scanner with its calibration
/// errors; one picture of a depth camera, of about so many points.
struct Scan {
  enum class By : std::uint8_t { ideal, laser, depth } by = By::ideal;
  int depth_points = 300'000;
};
[[nodiscard]] Scan::By parse_scan(std::string_view name);
[[nodiscard]] Result<Seen> see(const body::LabelledBody& person, const Scan& scan,
                               std::uint64_t seed);

/// Somebody scanned by the simulated scanner. Who is a cloud already stays as they are.
void scan_body(body::LabelledBody& person, std::uint64_t seed);
/// Everybody scanned by the simulated scanner, so that an atlas learns what a scan leaves open. Who
/// is a cloud already stays as they are.
void scan_everybody(std::vector<body::LabelledBody>& people, std::uint64_t seed,
                    const Progress& progress);

}  // namespace tuina::app
