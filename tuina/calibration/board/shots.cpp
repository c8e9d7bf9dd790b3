// SPDX-License-Identifier: Apache-2.0
#include "tuina/calibration/board/shots.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <set>
#include <string>
#include <string_view>

#include "tuina/core/io/file.hpp"
#include "tuina/core/io/text_lines.hpp"
#include "tuina/core/io/toml_reader.hpp"
#include "tuina/core/units.hpp"

namespace tuina::calibration {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t max_bytes = std::size_t{8} << 20;
constexpr int min_corners_per_side = 3;  // per side; with two the board has no direction
constexpr int max_corners = 100;
// Plausible square of a hand-held board, 2 mm to half a metre. Millimetres written as metres fall
// outside.
constexpr double min_square_m = 2e-3;
constexpr double max_square_m = 0.5;
// Shares of a square: a marker keeps away from the borders of its square.
constexpr double min_marker = 0.3;
constexpr double max_marker = 0.9;

/// OpenCV's names of dictionaries with 4, 5 and 6 cells, DICT_4X4_50 to DICT_6X6_1000.
TomlTable::Words dictionaries() {
  TomlTable::Words names;
  for (const int cells : {4, 5, 6}) {
    for (const int size : {50, 100, 250, 1000}) {
      names.push_back(fmt::format("DICT_{}X{}_{}", cells, cells, size));
    }
  }
  return names;
}

void read_markers(const TomlTable& table, Board& board) {
  board.marker_m = table
                       .number("marker_m", min_marker * board.square_m, max_marker * board.square_m,
                               "the side of one marker in metres")
                       .value_or(0.0);
  if (const auto dictionary = table.word("dictionary", dictionaries())) {
    board.marker_cells = dictionaries()[*dictionary][5] - '0';
  }
  if (scanner::marker_count(board) > scanner::max_markers) {
    table.reject("columns", fmt::format("{} x {} inner corners have {} markers, {} at most are "
                                        "known: print fewer and larger squares",
                                        board.columns, board.rows, scanner::marker_count(board),
                                        scanner::max_markers));
  }
}

Board read_board(const TomlTable& root) {
  Board board;
  root.only({}, {"board"});
  const auto table = root.table("board");
  if (!table) return board;
  const auto kind = table->word("kind", {"chessboard", "charuco"});
  const bool charuco = kind == 1U;
  const TomlTable::Words of_markers = {"marker_m", "dictionary"};
  TomlTable::Words needed = {"kind", "columns", "rows", "square_m"};
  if (charuco) needed.insert(needed.end(), of_markers.begin(), of_markers.end());
  table->only(kind ? TomlTable::Words() : of_markers, needed);
  board.columns =
      table->whole("columns", min_corners_per_side, max_corners).value_or(min_corners_per_side);
  board.rows =
      table->whole("rows", min_corners_per_side, max_corners).value_or(min_corners_per_side);
  board.square_m =
      table->number("square_m", min_square_m, max_square_m, "the side of one square in metres")
          .value_or(max_square_m);
  if (charuco) read_markers(*table, board);
  return board;
}

constexpr std::array<std::string_view, 5> columns = {"frame", "kind", "pose", "time_s", "yaw_deg"};

std::vector<std::string_view> split(std::string_view line) {
  std::vector<std::string_view> cells;
  for (std::size_t comma = 0; comma != std::string_view::npos; line.remove_prefix(comma + 1)) {
    comma = line.find(',');
    cells.push_back(line.substr(0, comma));
    if (comma == std::string_view::npos) break;
  }
  return cells;
}

// Parses frames.csv; errors name file and line.
class FramesFile {
 public:
  FramesFile(std::string text, const fs::path& folder)
      : text_(std::move(text)), name_((folder / "frames.csv").string()), folder_(folder) {}

  Result<std::vector<Shot>> read() {
    std::string_view text = text_;
    while (!text.empty() && only_white_space(text.substr(text.size() - 1))) text.remove_suffix(1);
    TextLines lines(text);
    const auto header = lines.next();
    if (!header) return fail(Fault::bad_input, "{}: is empty", name_);
    if (const auto good = find_columns(*header); !good) return tl::unexpected(good.error());
    std::vector<Shot> shots;
    while (const auto line = lines.next()) {
      auto shot = read_row(split(*line), fmt::format("{}:{}", name_, lines.number()));
      if (!shot) return tl::unexpected(shot.error());
      shots.push_back(*shot);
      if (!shot->both) continue;
      shots.back().laser = true;
      shots.insert(shots.end() - 1, std::move(*shot));
    }
    if (shots.empty()) return fail(Fault::bad_input, "{}:2: no row follows the header", name_);
    return shots;
  }

 private:
  Result<void> find_columns(std::string_view header) {
    const auto names = split(header);
    width_ = names.size();
    for (std::size_t i = 0; i < columns.size(); ++i) {
      const auto found = std::find(names.begin(), names.end(), columns[i]);
      if (found == names.end()) {
        return fail(Fault::bad_input, "{}:1: no column `{}` in the header {}; needed: {}", name_,
                    columns[i], in_quotes(header), fmt::join(columns, ","));
      }
      places_[i] = static_cast<std::size_t>(found - names.begin());
    }
    return {};
  }

  Result<Shot> read_row(const std::vector<std::string_view>& cells, const std::string& where) {
    if (cells.size() != width_) {
      return fail(Fault::bad_input, "{}: {} cells, the header has {}", where, cells.size(), width_);
    }
    const auto cell = [&](std::size_t column) { return cells[places_[column]]; };
    const auto frame = to_number<int>(cell(0));
    const auto pose = to_number<int>(cell(2));
    const auto time_s = to_number<double>(cell(3));
    const auto yaw_deg = to_number<double>(cell(4));
    if (!frame || *frame < 0) {
      return fail(Fault::bad_input, "{}: frame {} is not a whole number", where,
                  in_quotes(cell(0)));
    }
    if (cell(1) != "board" && cell(1) != "laser" && cell(1) != "both") {
      return fail(Fault::bad_input, "{}: kind {} is none of board, laser, both", where,
                  in_quotes(cell(1)));
    }
    if (!pose || *pose < 0) {
      return fail(Fault::bad_input, "{}: pose {} is not a whole number", where, in_quotes(cell(2)));
    }
    if (!time_s || !std::isfinite(*time_s)) {
      return fail(Fault::bad_input, "{}: time_s {} is not a finite number", where,
                  in_quotes(cell(3)));
    }
    if (!yaw_deg || !(std::abs(*yaw_deg) <= 360.0)) {
      return fail(Fault::bad_input, "{}: yaw_deg {} is not a number from -360 to 360", where,
                  in_quotes(cell(4)));
    }
    if (!listed_.insert(*frame).second) {
      return fail(Fault::bad_input, "{}: frame {} is listed twice", where, *frame);
    }
    const fs::path picture = folder_ / "frames" / fmt::format("{:06}.png", *frame);
    std::error_code error;
    if (!fs::is_regular_file(picture, error)) {
      return fail(Fault::bad_input, "{}: there is no {}", where, picture.string());
    }
    return Shot{.frame = *frame,
                .laser = cell(1) == "laser",
                .both = cell(1) == "both",
                .pose = *pose,
                .yaw_rad = from_deg(*yaw_deg),
                .picture = picture};
  }

  std::string text_;
  std::string name_;
  fs::path folder_;
  std::array<std::size_t, columns.size()> places_{};
  std::size_t width_ = 0;
  std::set<int> listed_;
};

}  // namespace

Result<Board> parse_board(std::string_view text, const std::string& name) {
  Board board;
  const auto read = read_toml(text, name, Fault::bad_input,
                              [&](const TomlTable& root) { board = read_board(root); });
  if (!read) return tl::unexpected(read.error());
  return board;
}

Result<std::vector<Shot>> parse_frames(std::string text, const fs::path& folder) {
  return FramesFile(std::move(text), folder).read();
}

Result<Shots> read_shots(const fs::path& folder) {
  std::error_code error;
  if (!fs::is_directory(folder, error)) {
    return fail(Fault::file, "{}: there is no such folder", folder.string());
  }
  const fs::path board_path = folder / "board.toml";
  const auto board_text = read_file(board_path, max_bytes);
  if (!board_text) return tl::unexpected(board_text.error());
  const auto board = parse_board(*board_text, board_path.string());
  if (!board) return tl::unexpected(board.error());
  auto text = read_file(folder / "frames.csv", max_bytes);
  if (!text) return tl::unexpected(text.error());
  auto shots = parse_frames(std::move(*text), folder);
  if (!shots) return tl::unexpected(shots.error());
  return Shots{.folder = folder, .board = *board, .shots = std::move(*shots)};
}

}  // namespace tuina::calibration
