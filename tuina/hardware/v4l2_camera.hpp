// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "tuina/hardware/device_file.hpp"
#include "tuina/hardware/video_device.hpp"
#include "tuina/scanner/camera.hpp"

namespace tuina::hardware {

/// A camera of Video4Linux, which takes pictures from `open` on. Times of frames are the driver's,
/// on the steady clock; the constant difference to mid-exposure is part of a calibration's latency.
/// Every failure is Fault::device and names the device.
class V4l2Camera final : public scanner::Camera {
 public:
  /// Sets the mode, and what `device` names of exposure, gain and focus by hand; takes off the
  /// filter for lamps. `width_px`, `height_px`: of the pictures after they were turned. Fails when
  /// the camera has not just this mode, or a value is beyond its limits.
  [[nodiscard]] static Result<std::unique_ptr<V4l2Camera>> open(const CameraDevice& device,
                                                                int width_px, int height_px);
  ~V4l2Camera() override;
  V4l2Camera(const V4l2Camera&) = delete;
  V4l2Camera& operator=(const V4l2Camera&) = delete;

  /// A broken frame counts as lost; five in a row are a broken camera. After a while in which
  /// nobody asked, the frames of that while are passed over.
  [[nodiscard]] Result<scanner::Frame> next_frame(double timeout_s) override;

 private:
  V4l2Camera(CameraDevice device, VideoDevice kernel)
      : device_(std::move(device)), kernel_(std::move(kernel)) {}
  [[nodiscard]] Result<void> set_mode(int width_px, int height_px);
  [[nodiscard]] Result<void> set_controls();
  [[nodiscard]] Result<void> set(std::uint32_t control, std::optional<int> value,
                                 const char* name) const;
  [[nodiscard]] Result<void> begin();
  [[nodiscard]] Result<void> wait(double until_s, double timeout_s) const;
  [[nodiscard]] Result<scanner::Frame> take();
  [[nodiscard]] tl::unexpected<Error> wrong(const std::string& what) const;

  CameraDevice device_;
  VideoDevice kernel_;
  int width_px_ = 0, height_px_ = 0;  // as they come
  std::vector<std::span<std::uint8_t>> buffers_;
  std::optional<double> last_s_;
  double asked_s_ = 0.0;  // when a frame was last given
};

}  // namespace tuina::hardware
