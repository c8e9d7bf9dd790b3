// SPDX-License-Identifier: Apache-2.0
#include "tuina/calibration/board/shots.hpp"

#include <doctest/doctest.h>

#include <filesystem>
#include <string>

#include "tests/folder.hpp"
#include "tests/reason.hpp"
#include "tuina/calibration/calibrate.hpp"
#include "tuina/core/io/file.hpp"
#include "tuina/core/io/png.hpp"

using namespace tuina;
using namespace tuina::calibration;
using tuina::test::Folder;

namespace {

const std::string good_board =
    "[board]\nkind = \"chessboard\"\ncolumns = 7\nrows = 10\nsquare_m = 0.025\n";
const std::string good_frames =
    "frame,kind,pose,time_s,yaw_deg\r\n0,board,0,0.0,0\r\n1,laser,0,2.0,0\r\n2,board,1,4.0,0.29";

std::string refusal(const std::string& board, const std::string& frames) {
  const Folder folder;
  std::filesystem::create_directory(folder.path() / "frames");
  for (const char* name : {"frames/000000.png", "frames/000001.png", "frames/000002.png"}) {
    (void)folder.with(name, to_png(Image(64, 48)));
  }
  (void)folder.with("board.toml", board);
  (void)folder.with("frames.csv", frames);
  const auto shots = read_shots(folder.path());
  if (shots) return "nothing was refused";
  return shots.error().message;
}

void says(const std::string& message, const std::string& cause) {
  CHECK_MESSAGE(message.find(cause) != std::string::npos, message);
}

}  // namespace

TEST_CASE("a folder of shots is read, with CRLF and without a last newline") {
  const Folder folder;
  std::filesystem::create_directory(folder.path() / "frames");
  for (const char* name : {"frames/000000.png", "frames/000001.png", "frames/000002.png"}) {
    (void)folder.with(name, to_png(Image(64, 48)));
  }
  (void)folder.with("board.toml", good_board);
  (void)folder.with("frames.csv", good_frames);
  const auto shots = read_shots(folder.path());
  REQUIRE_MESSAGE(shots.has_value(), test::reason(shots));
  CHECK(shots->board.corners() == 70);
  REQUIRE(shots->shots.size() == 3);
  CHECK(shots->shots[1].laser);
  CHECK(shots->shots[2].pose == 1);

  // Pictures without a board are no calibration.
  Views views;
  const auto result = calibrate_folder(folder.path(), views);
  REQUIRE_FALSE(result.has_value());
  says(result.error().message, "is found in 0 of 2 pictures");
}

TEST_CASE("what departs from the format is refused with file and line") {
  says(refusal(good_board, good_frames + "\n3,board,2,6.0,0"), "frames.csv:5: there is no");
  says(refusal(good_board, good_frames + "\n2,board,2,6.0,0"), "frame 2 is listed twice");
  says(refusal(good_board, good_frames + "\n2,light,2,6.0,0"), "none of board, laser, both");
  says(refusal(good_board, good_frames + "\n2,board,two,6.0,0"), "pose");
  says(refusal(good_board, good_frames + "\n2,board,2,nan,0"), "time_s");
  says(refusal(good_board, good_frames + "\n2,board,2,6.0,inf"), "yaw_deg");
  says(refusal(good_board, good_frames + "\n2,board,2"), "3 cells, the header has 5");
  says(refusal(good_board, "frame,kind,pose,time_s\n0,board,0,0"), "no column `yaw_deg`");
  says(refusal(good_board, ""), "is empty");
  const auto board = [](const std::string& from, const std::string& to) {
    std::string text = good_board;
    return refusal(text.replace(text.find(from), from.size(), to), good_frames);
  };
  says(board("0.025", "25"), "board.toml:5: board.square_m = 25 is not a number from 0.002 to 0.5");
  says(board("rows =", "rosw ="), "`board.rosw` is unknown; is `rows` meant?");
  says(board("0.025", "\"wide\""), "board.square_m");
  says(board("columns = 7", "columns = 2"), "board.toml:3: board.columns");
  says(board("rows = 10", "rows = 10.5"), "board.rows");
  says(board("chessboard", "dots"), "board.kind");
  says(board("[board]", "[plank]"), "board is missing");
  says(board("[board]", "[board"), "board.toml:1");
}

TEST_CASE("a board with markers says how large they are and which") {
  const std::string good =
      "[board]\nkind = \"charuco\"\ncolumns = 4\nrows = 6\nsquare_m = 0.035\nmarker_m = 0.026\n"
      "dictionary = \"DICT_5X5_100\"\n";
  const auto board = parse_board(good, "board.toml");
  REQUIRE_MESSAGE(board.has_value(), test::reason(board));
  CHECK(board->has_markers());
  CHECK(board->marker_m == 0.026);
  CHECK(board->marker_cells == 5);
  const auto refused = [&](const std::string& from, const std::string& to) {
    std::string text = good;
    const auto bad = parse_board(text.replace(text.find(from), from.size(), to), "board.toml");
    return bad ? "nothing was refused" : bad.error().message;
  };
  says(refused("marker_m = 0.026\n", ""), "board.toml:1: board.marker_m");
  says(refused("0.026", "0.035"), "board.toml:6: board.marker_m");
  says(refused("0.026", "nan"), "board.toml:6: board.marker_m");
  says(refused("DICT_5X5_100", "DICT_7X7_50"), "board.toml:7: board.dictionary");
  says(refused("DICT_5X5_100", "5X5_100"), "is `DICT_5X5_100` meant?");
  says(refused("columns = 4", "columns = 20"), "50 at most are known");
}

TEST_CASE("a folder that is not there") {
  CHECK(read_shots("/nowhere/shots").error().fault == Fault::file);
}
