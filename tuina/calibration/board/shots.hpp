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

/// One picture of a set: the board without or with the laser. A colour picture that serves as both
/// stands for two shots.
struct Shot {
  int frame = 0;
  bool laser = false;
  bool both = false;
  int pose = 0;
  double yaw_rad = 0.0;
  std::filesystem::path picture;
};

/// A folder of calibration shots: tables read, all pictures present.
struct Shots {
  std::filesystem::path folder;
  Board board;
  std::vector<Shot> shots;
};

/// Reads board.toml and frames.csv. Fails, with file and line, on malformed tables, missing
/// pictures and impossible boards.
[[nodiscard]] Result<Shots> read_shots(const std::filesystem::path& folder);

/// Parsers of the same files from memory; `name` stands for the file in errors, `folder` has the
/// pictures.
[[nodiscard]] Result<Board> parse_board(std::string_view text, const std::string& name);
/// Reads the rows of frames.csv; pictures lie in `folder`. Fails with the line of what is wrong.
[[nodiscard]] Result<std::vector<Shot>> parse_frames(std::string text,
                                                     const std::filesystem::path& folder);

}  // namespace tuina::calibration
