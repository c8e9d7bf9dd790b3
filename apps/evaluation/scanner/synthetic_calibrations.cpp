// SPDX-License-Identifier: Apache-2.0
#include "apps/evaluation/scanner/synthetic_calibrations.hpp"

#include <unistd.h>

#include <filesystem>

#include "tuina/calibration/calibrate.hpp"
#include "tuina/sim/scanner/synthetic_shots.hpp"

namespace tuina::app {

namespace fs = std::filesystem;

Result<std::vector<BuiltScanner>> rehearsed_scanners(int count, std::uint64_t seed, bool upright,
                                                     const Progress& progress, double line_share) {
  std::vector<BuiltScanner> scanners;
  for (int k = 0; k < count; ++k) {
    const std::uint64_t own_seed = seed * 1000 + static_cast<std::uint64_t>(k);
    const auto truth = sim::built_scanner(own_seed, upright);
    std::error_code error;
    const fs::path folder = fs::temp_directory_path(error) /
                            fmt::format("tuina-scanner-{}-{}-{}", ::getpid(), own_seed, upright);
    const auto part = [&](double from, double to) -> Progress {
      return [&, from, to](double done) {
        if (progress) progress((k + from + (to - from) * done) / count);
      };
    };
    const auto taken = sim::render_calibration_shots(truth, own_seed, folder,
                                                     {.line_share = line_share}, part(0.0, 0.5));
    if (!taken) return tl::unexpected(taken.error());
    calibration::Views views;
    const auto found = calibration::calibrate_folder(folder, views, part(0.5, 1.0));
    fs::remove_all(folder, error);
    if (!found) return tl::unexpected(found.error());
    scanners.push_back({.truth = truth, .believed = found->calibration});
  }
  return scanners;
}

}  // namespace tuina::app
