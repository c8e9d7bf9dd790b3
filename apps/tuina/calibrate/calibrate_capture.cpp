// SPDX-License-Identifier: Apache-2.0
#include "apps/tuina/calibrate/calibrate_capture.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <nlohmann/json.hpp>

#include "apps/tuina/scan_device.hpp"
#include "tuina/calibration/capture/capture.hpp"
#include "tuina/core/io/file.hpp"

namespace tuina::app {
namespace {

/// Tells who holds the board what to do, whenever that changes; on a terminal in one line.
class Teller {
 public:
  void operator()(const calibration::CaptureTold& told) {
    const std::string line = fmt::format("{} of {}  {}{}{}", told.kept, told.wanted, told.now,
                                         told.seen.empty() ? "" : ": ", told.seen);
    if (line == last_) return;
    last_ = line;
    const bool kept = told.kept > kept_;
    kept_ = told.kept;
    // The bell tells who looks at the board, not at the screen, that a picture was kept.
    fmt::print(stderr, "{}{}{}{}", terminal_ ? "\r\033[K" : "", kept && terminal_ ? "\a" : "", line,
               terminal_ ? "" : "\n");
    std::fflush(stderr);
  }

 private:
  bool terminal_ = ::isatty(STDERR_FILENO) == 1;
  std::string last_;
  int kept_ = 0;
};

}  // namespace

Result<Answer> calibrate_capture(const std::filesystem::path& folder,
                                 const std::string& device_file, int poses, bool quiet) {
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

  Teller teller;
  const auto tell = [&](const calibration::CaptureTold& told) {
    if (!quiet) teller(told);
  };
  const calibration::CaptureOptions options{.poses = poses};
  const auto done =
      calibration::capture_shots(*unit->camera, *unit->turntable, *board, folder, options, tell);
  if (!quiet) fmt::print(stderr, "\n");
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
