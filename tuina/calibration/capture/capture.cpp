// SPDX-License-Identifier: Apache-2.0
#include "tuina/calibration/capture/capture.hpp"

#include <algorithm>
#include <optional>

#include "tuina/calibration/board/find_board.hpp"
#include "tuina/calibration/board/line_on_print.hpp"
#include "tuina/calibration/capture/held_board.hpp"
#include "tuina/calibration/capture/kept_shots.hpp"
#include "tuina/core/units.hpp"
#include "tuina/scanner/recording.hpp"

namespace tuina::calibration {
namespace {

// A hand at rest trembles by less from picture to picture; a board that stands does not move.
constexpr double max_tremble_px = 0.5, max_moved_px = 0.3;
constexpr double still_s = 0.5, standing_s = 3.0;
// A board that was photographed standing counts as another one once it has moved by so much.
constexpr double min_other_px = 40.0;
// The firmware puts the laser of a unit that stands out after 0.25 s, and tells that as a fault.
constexpr double lit_s = 0.15;
constexpr int passed_pictures = 6;  // a camera shows light and darkness some pictures later
constexpr std::size_t min_line_points = 20;
constexpr int standing_yaws = 5;

class Capture {
 public:
  using Tell = std::function<void(const CaptureTold&)>;
  Capture(scanner::Camera& camera, scanner::Turntable& turntable, const Board& board,
          KeptShots kept, const CaptureOptions& options, const Tell& tell)
      : camera_(camera),
        turntable_(turntable),
        board_(board),
        kept_(std::move(kept)),
        options_(options),
        tell_(tell),
        wanted_(options.poses) {
    told_.wanted = options.poses + options.standing_boards + (options.sweeps ? 2 : 0);
  }

  Result<void> run() {
    if (auto begun = turn_to(0.0); !begun) return begun;
    while (!wanted_.complete()) {
      if (auto kept = hold_one(); !kept) return kept;
    }
    for (int i = 0; i < options_.standing_boards; ++i) {
      if (auto kept = stand_one(); !kept) return kept;
    }
    if (!options_.sweeps) return {};
    told_.now =
        "put boxes, books like tents or other slanted things before the scanner, and leave "
        "them alone for the two sweeps";
    if (auto swept = sweep("sweep_left", options_.sweep_rad, -options_.sweep_rad); !swept)
      return swept;
    return sweep("sweep_right", -options_.sweep_rad, options_.sweep_rad);
  }

 private:
  struct Looked {
    scanner::Frame frame;
    std::optional<SeenBoard> board;
  };

  Result<scanner::Frame> next_frame() {
    auto frame = camera_.next_frame(scanner::frame_timeout_s);
    if (!frame) return frame;
    // Who asks keeps the laser lit, and hears of a motor that is gone.
    if (const auto asked = turntable_.arrived(); !asked) return tl::unexpected(asked.error());
    if (!last_kept_s_) last_kept_s_ = frame->time_s;
    if (frame->time_s - *last_kept_s_ > options_.patience_s)
      return fail(Fault::device, "nothing could be photographed for {:.0f} s: {}{}{}",
                  options_.patience_s, told_.now, told_.seen.empty() ? "" : "; ", told_.seen);
    if (!camera_guess_) camera_guess_.emplace(frame->image.width, frame->image.height);
    return frame;
  }

  Result<Looked> look() {
    auto frame = next_frame();
    if (!frame) return tl::unexpected(frame.error());
    auto board = find_board(frame->image, board_, Effort::quick);
    if (board) camera_guess_->see(*board, board_);
    return Looked{.frame = std::move(*frame), .board = std::move(board)};
  }

  Result<void> pass_over() {
    for (int i = 0; i < passed_pictures; ++i)
      if (const auto frame = next_frame(); !frame) return tl::unexpected(frame.error());
    return {};
  }

  Result<void> turn_to(double yaw_rad) {
    if (auto turned = turntable_.step(yaw_rad, yaw_rad, scanner::yaw_count_rad); !turned)
      return turned;
    for (;;) {
      const auto there = turntable_.arrived();
      if (!there) return tl::unexpected(there.error());
      if (const auto frame = next_frame(); !frame) return tl::unexpected(frame.error());
      if (*there) return pass_over();
    }
  }

  /// The newest of the motor; its time is by the clock of the pictures, which come later.
  Result<scanner::YawReading> reading() {
    const auto readings = turntable_.readings();
    if (!readings) return tl::unexpected(readings.error());
    if (readings->empty()) return fail(Fault::device, "the motor tells no angle");
    return readings->back();
  }

  void say(std::string seen, const Looked* looked = nullptr) {
    told_.seen = std::move(seen);
    told_.picture = looked != nullptr ? &looked->frame.image : nullptr;
    told_.board = looked != nullptr && looked->board ? &*looked->board : nullptr;
    tell_(told_);
  }

  /// Waits until a board that `wanted` accepts, an empty word, rests for `rest_s`.
  template <typename Wanted>
  Result<Looked> wait_for_board(double rest_s, const Wanted& wanted) {
    std::optional<Looked> before;
    double rests_since_s = 0.0;
    for (;;) {
      auto now = look();
      if (!now) return now;
      const bool had = before && before->board;
      const double moved = had && now->board ? moved_px(*before->board, *now->board) : 0.0;
      std::string words = "no board is seen: show the whole of it";
      if (now->board) words = wanted(*now);
      if (now->board && words.empty() && moved > max_tremble_px)
        words = fmt::format("hold it still: it moves by {:.1f} px from picture to picture", moved);
      const bool good = words.empty() && had;
      if (!good) rests_since_s = now->frame.time_s;
      if (good && now->frame.time_s - rests_since_s >= rest_s) return now;
      say(std::move(words), &*now);
      before = std::move(*now);
    }
  }

  /// The laser's light in that picture of several which shows most of it on the board.
  Result<Image> light_up(const Looked& bare, std::size_t& points) {
    const auto before = reading();
    if (!before) return tl::unexpected(before.error());
    if (auto lit = turntable_.switch_laser(true); !lit) return tl::unexpected(lit.error());
    bool dark = false;
    Image best;
    points = 0;
    for (int late = 0; late < passed_pictures; late += dark ? 1 : 0) {
      auto frame = next_frame();
      if (!frame) return tl::unexpected(frame.error());
      const auto now = reading();
      if (!now) return tl::unexpected(now.error());
      dark = dark || now->time_s - before->time_s >= lit_s;
      if (auto out = turntable_.switch_laser(!dark); !out) return tl::unexpected(out.error());
      Image light = light_of_laser(frame->image, bare.frame.image);
      const auto line =
          scanner::find_laser_line(light, {.method = scanner::LineMethod::likelihood});
      const auto on_board = line_on_print(light, bare.frame.image, bare.board->outline_px, line);
      if (on_board.size() <= points && !best.data.empty()) continue;
      points = on_board.size();
      best = std::move(light);
    }
    return best;
  }

  /// One board in the hand: waited for, taken without and with the laser, kept if it did not move.
  Result<void> hold_one() {
    told_.now = "hold the board " + wanted_.next();
    HeldBoard held;
    const auto bare = wait_for_board(still_s, [&](const Looked& seen) {
      held = look_at_board(*seen.board, seen.frame.image, board_, *camera_guess_);
      return wanted_.judge(held);
    });
    if (!bare) return tl::unexpected(bare.error());
    std::size_t points = 0;
    const auto lit = light_up(*bare, points);
    if (!lit) return tl::unexpected(lit.error());
    if (points < min_line_points) {
      say("the laser line does not cross the board: move it into the line");
      return {};
    }
    const auto after = look();
    if (!after) return tl::unexpected(after.error());
    const double moved = after->board ? moved_px(*bare->board, *after->board) : 0.0;
    if (!after->board || moved > max_moved_px) {
      say(fmt::format("it moved by {:.1f} px while the laser was lit: lean it on something",
                      moved));
      return {};
    }
    const auto at = reading();
    if (!at) return tl::unexpected(at.error());
    wanted_.keep(held);
    return keep({{.laser = false, .yaw_rad = at->yaw_rad}, {.laser = true, .yaw_rad = at->yaw_rad}},
                {bare->frame.image, *lit}, bare->frame.time_s);
  }

  /// One standing board, before which the unit turns.
  Result<void> stand_one() {
    told_.now = "stand the board upright about 1 m away, elsewhere each time, and leave it alone";
    const auto stands = wait_for_board(standing_s, [&](const Looked& seen) -> std::string {
      const bool other = !stood_ || moved_px(*stood_, *seen.board) > min_other_px;
      return other ? "" : "that place is there: stand it elsewhere, or otherwise";
    });
    if (!stands) return tl::unexpected(stands.error());
    std::vector<Shot> shots;
    std::vector<Image> pictures;
    for (int i = 0; i < standing_yaws; ++i) {
      const double share = 2.0 * i / (standing_yaws - 1) - 1.0;
      if (auto turned = turn_to(share * options_.standing_yaw_rad); !turned) return turned;
      auto seen = look();
      if (!seen) return tl::unexpected(seen.error());
      const auto at = reading();
      if (!at) return tl::unexpected(at.error());
      if (!seen->board) continue;  // out of view for this angle
      shots.push_back({.laser = false, .yaw_rad = at->yaw_rad});
      pictures.push_back(std::move(seen->frame.image));
    }
    if (auto turned = turn_to(0.0); !turned) return turned;
    const auto after = look();
    if (!after) return tl::unexpected(after.error());
    const double moved = after->board ? moved_px(*stands->board, *after->board) : 0.0;
    // The motor comes back to a count of where it was, and so the picture to some pixels.
    const double count_px = scanner::yaw_count_rad * camera_guess_->focal_px();
    if (!after->board || moved > max_moved_px + 3.0 * count_px || shots.size() < 3) {
      say("the board was moved, or is out of view while the unit turns: stand it nearer to the "
          "middle");
      return stand_one();
    }
    stood_ = after->board;
    return keep(shots, pictures, after->frame.time_s);
  }

  /// A still scene, recorded while the unit turns.
  Result<void> sweep(const char* name, double from_rad, double to_rad) {
    say({});
    auto recorder = scanner::Recorder::open(camera_, turntable_, kept_.beside(name));
    if (!recorder) return tl::unexpected(recorder.error());
    if (auto turns = recorder->sweep(from_rad, to_rad, options_.sweep_rad_per_s); !turns)
      return turns;
    if (auto lit = recorder->switch_laser(true); !lit) return lit;
    for (;;) {
      const auto there = recorder->arrived();
      if (!there) return tl::unexpected(there.error());
      if (*there) break;
      const auto frame = recorder->next_frame(scanner::frame_timeout_s);
      if (!frame) return tl::unexpected(frame.error());
    }
    if (auto dark = recorder->switch_laser(false); !dark) return dark;
    // What is not known yet; for the latency nothing of it counts.
    scanner::ScannerCalibration nominal;
    const Vector2& middle_px = camera_guess_->middle_px();
    nominal.camera = {.width_px = static_cast<int>(2.0 * middle_px.x()),
                      .height_px = static_cast<int>(2.0 * middle_px.y()),
                      .fx_px = camera_guess_->focal_px(),
                      .fy_px = camera_guess_->focal_px(),
                      .cx_px = middle_px.x() - 0.5,
                      .cy_px = middle_px.y() - 0.5};
    if (auto finished = recorder->finish(nominal); !finished) return finished;
    ++told_.kept;
    say({});
    return {};
  }

  Result<void> keep(const std::vector<Shot>& shots, const std::vector<Image>& pictures,
                    double time_s) {
    auto kept = kept_.keep(shots, pictures, time_s);
    ++told_.kept;
    last_kept_s_ = time_s;
    say({});
    return kept;
  }

  scanner::Camera& camera_;
  scanner::Turntable& turntable_;
  Board board_;
  KeptShots kept_;
  CaptureOptions options_;
  const Tell& tell_;
  WantedPoses wanted_;
  CaptureTold told_;
  std::optional<double> last_kept_s_;
  std::optional<SeenBoard> stood_;
  std::optional<FocalGuess> camera_guess_;
};

}  // namespace

Result<void> capture_shots(scanner::Camera& camera, scanner::Turntable& turntable,
                           const Board& board, const std::filesystem::path& folder,
                           const CaptureOptions& options,
                           const std::function<void(const CaptureTold&)>& tell) {
  auto kept = KeptShots::begin(folder);
  if (!kept) return tl::unexpected(kept.error());
  auto done = Capture(camera, turntable, board, std::move(*kept), options, tell).run();
  if (!done) (void)turntable.switch_laser(false);  // whatever failed, the laser is dark
  return done;
}

}  // namespace tuina::calibration
