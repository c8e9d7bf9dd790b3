// SPDX-License-Identifier: Apache-2.0
// Pictures of the rehearsal beside each other, half as large: a chessboard and a board with markers
// that is partly out of view, both without and with laser.
#include <cstdio>

#include "tuina/core/io/file.hpp"
#include "tuina/core/io/png.hpp"
#include "tuina/sim/scanner/synthetic_shots.hpp"

using namespace tuina;

namespace {

constexpr int gap_px = 6;

void put_half(const Image& from, Image& to, int left) {
  for (int y = 0; y < from.height / 2; ++y) {
    for (int x = 0; x < from.width / 2; ++x) {
      const int sum = from.row(2 * y)[2 * x] + from.row(2 * y)[2 * x + 1] +
                      from.row(2 * y + 1)[2 * x] + from.row(2 * y + 1)[2 * x + 1];
      to.row(y)[left + x] = static_cast<std::uint8_t>(sum / 4);
    }
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) return 1;
  const auto truth = sim::built_scanner(1);
  const int width = truth.camera.width_px / 2;
  Image sheet(4 * width + 3 * gap_px, truth.camera.height_px / 2);
  for (int y = 0; y < sheet.height; ++y) {
    for (int x = 0; x < sheet.width; ++x) sheet.row(y)[x] = 255;
  }
  struct Shown {
    scanner::Board board;
    std::size_t pose;
  };
  int left = 0;
  for (const Shown& shown : {Shown{{}, 3}, Shown{sim::charuco_board(), 5}}) {
    const auto pictures = sim::synthetic_pictures(truth, 1, {.board = shown.board});
    for (const std::size_t i : {2 * shown.pose, 2 * shown.pose + 1}) {
      Random random = make_random(1, "figure");
      const auto light = pictures[i].laser ? sim::laser_exposure() : sim::board_exposure();
      put_half(sim::photograph(truth, shown.board, pictures[i].camera_from_board, light, random),
               sheet, left);
      left += width + gap_px;
    }
  }
  const auto written = write_file(argv[1], to_png(sheet));
  if (!written) std::fprintf(stderr, "%s\n", written.error().message.c_str());
  return written ? 0 : 1;
}
