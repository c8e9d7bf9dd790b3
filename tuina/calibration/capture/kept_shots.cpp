// SPDX-License-Identifier: Apache-2.0
#include "tuina/calibration/capture/kept_shots.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "tuina/core/io/file.hpp"
#include "tuina/core/io/png.hpp"
#include "tuina/core/units.hpp"

namespace tuina::calibration {

namespace fs = std::filesystem;

Result<KeptShots> KeptShots::begin(const fs::path& folder) {
  if (fs::exists(folder / "frames.csv"))
    return fail(Fault::file, "{} has pictures already; a new set needs a new folder",
                folder.string());
  std::error_code failed;
  fs::create_directories(folder / "frames", failed);
  if (!failed) return KeptShots(folder);
  return fail(Fault::file, "{}: cannot be made: {}", (folder / "frames").string(),
              failed.message());
}

Result<void> KeptShots::keep(const std::vector<Shot>& shots, const std::vector<Image>& pictures,
                             double time_s) {
  for (std::size_t i = 0; i < shots.size(); ++i, ++frame_) {
    const fs::path picture = folder_ / fmt::format("frames/{:06d}.png", frame_);
    if (auto written = write_file(picture, to_png(pictures[i])); !written) return written;
    table_ += fmt::format("{},{},{},{:.3f},{:.4f}\n", frame_, shots[i].laser ? "laser" : "board",
                          pose_, time_s, to_deg(shots[i].yaw_rad));
  }
  ++pose_;
  return write_file(folder_ / "frames.csv", table_);
}

Image light_of_laser(const Image& lit, const Image& bare) {
  constexpr int zero_dn = 8;
  Image light(lit.width, lit.height);
  if (lit.data.size() != bare.data.size() || lit.data.size() != light.data.size()) return lit;
  for (std::size_t i = 0; i < light.data.size(); ++i)
    light.data[i] = static_cast<std::uint8_t>(
        std::clamp(zero_dn + int{lit.data[i]} - int{bare.data[i]}, 0, 255));
  return light;
}

}  // namespace tuina::calibration
