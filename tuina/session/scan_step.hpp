// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tuina/body/back_surface.hpp"
#include "tuina/session/run.hpp"

namespace tuina::session {

/// How the configuration wants a sweep: symmetric about straight ahead.
[[nodiscard]] scanner::SweepOptions sweep_options(const Config& config);

/// A person as scanned, and where the acupoints are on them.
struct MappedPerson {
  scanner::Scan scan;
  body::BackSurface back;
  body::Mapping located;
  double locate_ms = 0.0;  ///< computing time of back and acupoints
};
/// Scans the person and finds back and acupoints in the scan; the observer is told of each as it is
/// there. Fails as scanner::scan_sweep, body::fit_back and body::locate_acupoints do.
[[nodiscard]] Result<MappedPerson> scan_and_map(scanner::Camera& camera,
                                                scanner::Turntable& turntable, const Order& order,
                                                const Config& config, Observer& observer);

}  // namespace tuina::session
