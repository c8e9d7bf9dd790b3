// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "tuina/core/result.hpp"

namespace tuina::hardware {

/// A picture size that a camera offers in one pixel format.
struct CameraMode {
  std::string format;  ///< four letters of V4L2, such as "YUYV"
  int width_px = 0;
  int height_px = 0;
  double max_frames_per_s = 0.0;  ///< 0: not told
};

/// What a camera says of itself.
struct CameraListing {
  std::string name;
  std::vector<CameraMode> modes;
};

/// Paths of the video devices of this machine, by number.
[[nodiscard]] std::vector<std::string> video_devices();
/// Fails with Fault::device when there is no camera.
[[nodiscard]] Result<CameraListing> list_camera(const std::string& address);

/// A device of Video4Linux as the kernel gives it; closed at the end.
class VideoDevice {
 public:
  /// Fails with Fault::device and what mends it, also when it takes no pictures.
  [[nodiscard]] static Result<VideoDevice> open(const std::string& address);
  VideoDevice(VideoDevice&& other) noexcept;
  VideoDevice& operator=(VideoDevice&& other) noexcept;
  ~VideoDevice();

  /// Result and errno of ioctl; once more when a signal came between.
  int ask(unsigned long request, void* what) const;
  /// Sizes, formats and rates that the camera offers.
  [[nodiscard]] std::vector<CameraMode> modes() const;
  /// Name of the file of the device.
  [[nodiscard]] const std::string& name() const { return name_; }
  [[nodiscard]] int number() const { return number_; }  ///< number of the open file, for poll

 private:
  explicit VideoDevice(int number) : number_(number) {}
  [[nodiscard]] double max_rate(std::uint32_t format, std::uint32_t width,
                                std::uint32_t height) const;
  int number_ = -1;
  std::string name_;
};

/// The four letters of a pixel format.
[[nodiscard]] std::string letters_of_format(std::uint32_t code);

}  // namespace tuina::hardware
