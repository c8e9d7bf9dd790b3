// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "tuina/calibration/calibrate.hpp"

namespace tuina::app {

/// Every board as the camera saw it, near ones red and far ones blue, with the line on it; as SVG.
[[nodiscard]] std::string boards_in_image(const calibration::Calibrated& result,
                                          const calibration::Views& views);

/// Camera, axis, light plane and boards seen along the rows of the image (from above a scanner that
/// stands upright); as SVG.
[[nodiscard]] std::string boards_from_above(const calibration::Calibrated& result,
                                            const calibration::Views& views);

}  // namespace tuina::app
