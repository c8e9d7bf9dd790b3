// SPDX-License-Identifier: Apache-2.0
#include "apps/tuina/calibrate/calibrate_capture.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>

#include <nlohmann/json.hpp>

#include "apps/cli/say.hpp"
#include "apps/tuina/scan_device.hpp"
#include "tuina/calibration/capture/capture.hpp"
#include "tuina/core/io/file.hpp"

namespace tuina::app {
namespace {

std::string line_of(const calibration::CaptureTold& told) {
  return fmt::format("{} of {}  {}{}{}", told.kept, told.wanted, told.now,
                     told.seen.empty() ? "" : ": ", told.seen);
}

/// The picture, the corners of the board in it as crosses.
Image drawn(const calibration::CaptureTold& told) {
  constexpr int arm_px = 4;
  const Image& from = *told.picture;
  Image picture(from.width, from.height, 3);
  for (int y = 0; y < from.height; ++y)
    for (int x = 0; x < from.width; ++x)
      std::fill_n(picture.row(y) + 3 * x, 3, from.row(y)[x * from.channels]);
  const auto paint = [&](int x, int y) {
    constexpr std::array<std::uint8_t, 3> green = {60, 220, 110};
    if (x < 0 || y < 0 || x >= picture.width || y >= picture.height) return;
    std::copy(green.begin(), green.end(), picture.row(y) + 3 * x);
  };
  if (told.board == nullptr) return picture;
  for (const Vector2& corner : told.board->corners_px) {
    const auto x = static_cast<int>(std::lround(corner.x()));
    const auto y = static_cast<int>(std::lround(corner.y()));
    for (int i = -arm_px; i <= arm_px; ++i) paint(x + i, y), paint(x, y + i);
  }
  return picture;
}

/// Tells who holds the board what to do, whenever that changes; on a terminal in one line.
class Teller {
 public:
  void operator()(const calibration::CaptureTold& told) {
    const std::string line = line_of(told);
    if (line == last_) return;
    last_ = line;
    const bool kept = told.kept > kept_;
    kept_ = told.kept;
    // The bell tells who looks at the board, not at the screen, that a picture was kept.
    say(fmt::format("{}{}{}{}", terminal_ ? "\r\033[K" : "", kept && terminal_ ? "\a" : "", line,
                    terminal_ ? "" : "\n"));
  }

 private:
  bool terminal_ = ::isatty(STDERR_FILENO) == 1;
  std::string last_;
  int kept_ = 0;
};

}  // namespace

Result<Answer> calibrate_capture(const std::filesystem::path& folder,
                                 const std::string& device_file, int poses, LivePicture& live,
                                 bool quiet) {
  const auto board_file = folder / "board.toml";
  const auto text = read_file(board_file);
  if (!text) return tl::unexpected(text.error());
  const auto board = calibration::parse_board(*text, board_file.string());
  if (!board) return tl::unexpected(board.error());
  const auto devices = scanner_devices(device_file, {}, {});
  if (!devices) return tl::unexpected(devices.error());
  const auto mode = picture_mode(*devices->camera);
  if (!mode) return tl::unexpected(mode.error());
  scanner::CameraModel pictures;
  pictures.width_px = mode->width_px, pictures.height_px = mode->height_px;
  if (devices->camera->turned_deg % 180 != 0) std::swap(pictures.width_px, pictures.height_px);
  auto unit = open_scanner(*devices, pictures);
  if (!unit) return tl::unexpected(unit.error());

  if (auto begun = live.begin(); !begun) return tl::unexpected(begun.error());
  Teller teller;
  const auto tell = [&](const calibration::CaptureTold& told) {
    if (!quiet) teller(told);
    if (live.asked() && told.picture != nullptr) live.show(drawn(told), line_of(told));
  };
  const calibration::CaptureOptions options{.poses = poses};
  const auto done =
      calibration::capture_shots(*unit->camera, *unit->turntable, *board, folder, options, tell);
  if (!quiet) say("\n");
  if (!done) return tl::unexpected(done.error());
  return Answer{
      .json = nlohmann::json{{"folder", folder.string()},
                             {"poses", options.poses},
                             {"standing_boards", options.standing_boards},
                             {"sweeps", 2}}
                  .dump(2),
      .text = fmt::format("{0} holds a set of calibration shots; now: tuina calibrate {0} "
                          "--out calibration.toml",
                          folder.string())};
}

}  // namespace tuina::app
