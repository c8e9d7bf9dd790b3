// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "tuina/calibration/board/shots.hpp"
#include "tuina/core/image.hpp"

namespace tuina::calibration {

/// A set of calibration shots that grows: pictures in frames/, and frames.csv, whole at any time.
class KeptShots {
 public:
  /// Fault::file: the folder cannot be made, or has a set already.
  [[nodiscard]] static Result<KeptShots> begin(const std::filesystem::path& folder);

  /// All pictures of one pose, in the order of the shots, of which laser and yaw count.
  [[nodiscard]] Result<void> keep(const std::vector<Shot>& shots,
                                  const std::vector<Image>& pictures, double time_s);
  /// A folder beside the pictures.
  [[nodiscard]] std::filesystem::path beside(const char* name) const { return folder_ / name; }

 private:
  explicit KeptShots(std::filesystem::path folder) : folder_(std::move(folder)) {}
  std::filesystem::path folder_;
  std::string table_ = "frame,kind,pose,time_s,yaw_deg\n";
  int frame_ = 0, pose_ = 0;
};

/// The laser's light alone, as in a dark room: squares of a board in a lit one would hide the line.
/// Its zero is raised, so that noise has both signs. Pictures of one size.
[[nodiscard]] Image light_of_laser(const Image& lit, const Image& bare);

}  // namespace tuina::calibration
