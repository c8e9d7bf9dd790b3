// SPDX-License-Identifier: Apache-2.0
#include "tuina/calibration/shots.hpp"

#include <toml++/toml.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <set>
#include <string>
#include <string_view>

#include "tuina/core/file.hpp"
#include "tuina/core/text_lines.hpp"
#include "tuina/core/units.hpp"

namespace tuina::calibration {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t most_bytes = std::size_t{8} << 20;
constexpr int fewest_corners = 3;  // along a side; with two the board has no direction
constexpr int most_corners = 100;
// A square of a board that one prints and holds: 2 mm to half a metre. Millimetres written where
// metres are meant fall outside.
constexpr double smallest_square_m = 2e-3;
constexpr double largest_square_m = 0.5;
// Of a square: a marker keeps away from the borders of its square.
constexpr double smallest_marker = 0.3;
constexpr double largest_marker = 0.9;

class BoardFile {
 public:
  BoardFile(const toml::table& file, std::string name) : file_(file), name_(std::move(name)) {}

  Result<Board> read() const {
    const toml::table* table = file_["board"].as_table();
    if (table == nullptr)
      return fail(Fault::bad_input, "{}: the section [board] is missing", name_);
    const toml::node* kind_node = table->get("kind");
    const auto kind = kind_node != nullptr ? kind_node->value<std::string>() : std::nullopt;
    if (kind != "chessboard" && kind != "charuco") {
      return fail(Fault::bad_input, "{}:{}: board.kind must be \"chessboard\" or \"charuco\"",
                  name_, line_of(kind_node, *table));
    }
    Board board;
    for (auto [key, count] : {std::pair{"columns", &board.columns}, {"rows", &board.rows}}) {
      const toml::node* node = table->get(key);
      const auto value = node != nullptr && node->is_integer() ? node->value<long>() : std::nullopt;
      if (!value || *value < fewest_corners || *value > most_corners) {
        return fail(Fault::bad_input,
                    "{}:{}: board.{} must be the number of inner corners, {} to {}", name_,
                    line_of(node, *table), key, fewest_corners, most_corners);
      }
      *count = static_cast<int>(*value);
    }
    const toml::node* square = table->get("square_m");
    const auto side = number(square);
    if (!side || !(*side >= smallest_square_m && *side <= largest_square_m)) {
      return fail(Fault::bad_input,
                  "{}:{}: board.square_m must be the side of one square in metres, {} to {}", name_,
                  line_of(square, *table), smallest_square_m, largest_square_m);
    }
    board.square_m = *side;
    if (kind == "charuco") return with_markers(board, *table);
    return board;
  }

 private:
  Result<Board> with_markers(Board board, const toml::table& table) const {
    const toml::node* marker = table.get("marker_m");
    const auto side = number(marker);
    if (!side ||
        !(*side >= smallest_marker * board.square_m && *side <= largest_marker * board.square_m)) {
      return fail(Fault::bad_input,
                  "{}:{}: board.marker_m must be the side of one marker in metres, {} to {} of "
                  "square_m",
                  name_, line_of(marker, table), smallest_marker, largest_marker);
    }
    board.marker_m = *side;
    const toml::node* dictionary = table.get("dictionary");
    const auto written = dictionary != nullptr ? dictionary->value<std::string>() : std::nullopt;
    const std::string cells = written && written->starts_with("DICT_") ? written->substr(5) : "";
    board.marker_cells = 0;
    for (const int n : {4, 5, 6}) {
      for (const int size : {50, 100, 250, 1000}) {
        if (cells == fmt::format("{}X{}_{}", n, n, size)) board.marker_cells = n;
      }
    }
    if (board.marker_cells == 0) {
      return fail(Fault::bad_input,
                  "{}:{}: board.dictionary must be OpenCV's name of one, DICT_4X4_50 to "
                  "DICT_6X6_1000 (4, 5 or 6 cells; 50, 100, 250 or 1000 markers)",
                  name_, line_of(dictionary, table));
    }
    if (scanner::marker_count(board) > scanner::most_markers) {
      return fail(Fault::bad_input,
                  "{}:{}: {} x {} inner corners have {} markers, {} at most are known: print fewer "
                  "and larger squares",
                  name_, line_of(table.get("columns"), table), board.columns, board.rows,
                  scanner::marker_count(board), scanner::most_markers);
    }
    return board;
  }

  static std::optional<double> number(const toml::node* node) {
    return node != nullptr && node->is_number() ? node->value<double>() : std::nullopt;
  }
  static std::size_t line_of(const toml::node* node, const toml::table& table) {
    return node != nullptr ? node->source().begin.line : table.source().begin.line;
  }
  const toml::table& file_;
  std::string name_;
};

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

// Reads the rows of frames.csv; `where` of an error is file and line.
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
      shots.push_back(std::move(*shot));
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
    if (cell(1) != "board" && cell(1) != "laser") {
      return fail(Fault::bad_input, "{}: kind {} is neither board nor laser", where,
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
  toml::table file;
  try {
    file = toml::parse(text, name);
  } catch (const toml::parse_error& error) {
    return fail(Fault::bad_input, "{}:{}: {}", name, error.source().begin.line,
                error.description());
  }
  return BoardFile(file, name).read();
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
  const auto board_text = read_file(board_path, most_bytes);
  if (!board_text) return tl::unexpected(board_text.error());
  const auto board = parse_board(*board_text, board_path.string());
  if (!board) return tl::unexpected(board.error());
  auto text = read_file(folder / "frames.csv", most_bytes);
  if (!text) return tl::unexpected(text.error());
  auto shots = parse_frames(std::move(*text), folder);
  if (!shots) return tl::unexpected(shots.error());
  return Shots{.folder = folder, .board = *board, .shots = std::move(*shots)};
}

}  // namespace tuina::calibration
