// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tuina/core/image.hpp"
#include "tuina/core/result.hpp"

namespace tuina::scanner {

/// One picture with the time of mid-exposure on the camera's clock.
struct Frame {
  double time_s = 0.0;
  Image image;  ///< 8-bit grey, or RGB of which the laser's channel is used
  Image dark;   ///< same view with the laser off; empty if not taken
};

/// Camera interface: simulation, recording or device.
class Camera {
 public:
  virtual ~Camera() = default;
  /// Waits for the next frame. Fault::not_found at the end of a recording or sweep.
  [[nodiscard]] virtual Result<Frame> next_frame() = 0;

 protected:
  Camera() = default;
  Camera(const Camera&) = default;
  Camera& operator=(const Camera&) = default;
};

}  // namespace tuina::scanner
