// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "tuina/core/result.hpp"
#include "tuina/scanner/board.hpp"

namespace tuina::calibration {

using scanner::Board;

/// One picture of a set: the bare board, or the same with the laser on.
struct Shot {
  int frame = 0;
  bool laser = false;
  int pose = 0;
  double yaw_rad = 0.0;
  std::filesystem::path picture;
};

/// A folder of calibration shots, its tables read and every picture that they name found.
struct Shots {
  std::filesystem::path folder;
  Board board;
  std::vector<Shot> shots;
};

/// Reads board.toml and frames.csv. Refuses, with file and line, what departs from the format,
/// names a picture that is not there, or cannot be a board.
[[nodiscard]] Result<Shots> read_shots(const std::filesystem::path& folder);

/// The same on text already in memory; `name` is what errors call it, `folder` has the pictures.
[[nodiscard]] Result<Board> parse_board(std::string_view text, const std::string& name);
[[nodiscard]] Result<std::vector<Shot>> parse_frames(std::string text,
                                                     const std::filesystem::path& folder);

}  // namespace tuina::calibration
