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

/// Time after which a camera that takes 30 frames a second and gives none is broken. The laser is
/// lit while a frame is waited for, and has to be dark 0.2 s after the last one.
inline constexpr double frame_timeout_s = 0.15;

/// The interface to a camera: a simulated one, a recording, or a device.
class Camera {
 public:
  virtual ~Camera() = default;
  /// The next frame; waits for it. Fault::device when none has come within `timeout_s`, or the
  /// camera is gone.
  [[nodiscard]] virtual Result<Frame> next_frame(double timeout_s) = 0;

 protected:
  Camera() = default;
  Camera(const Camera&) = default;
  Camera& operator=(const Camera&) = default;
};

}  // namespace tuina::scanner
