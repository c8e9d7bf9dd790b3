// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>
#include <utility>

#include "tuina/scanner/scan_watch.hpp"
#include "tuina/scanner/sweep.hpp"
#include "tuina/scanner/triangulation.hpp"

namespace tuina::scanner {
namespace {

using Clock = std::chrono::steady_clock;

double ms_since(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

// Keeps the red channel, which shows the laser.
void keep_red(Image& image) {
  if (image.channels == 1) return;
  Image red(image.width, image.height);
  const auto channels = static_cast<std::size_t>(image.channels);
  for (std::size_t i = 0; i < red.data.size(); ++i) red.data[i] = image.data[i * channels];
  image = std::move(red);
}

Result<void> check_size(const Image& image, const CameraModel& camera, const char* what) {
  if (image.width == camera.width_px && image.height == camera.height_px) return {};
  return fail(Fault::bad_input,
              "a {} of {} x {} pixels does not belong to a calibration for {} x {}", what,
              image.width, image.height, camera.width_px, camera.height_px);
}

// True when a transfer broke off: the frame ends in constant rows, while a sensor's rows have
// noise.
bool half_missing(const Image& image) {
  const int rows = image.height / 8;
  if (rows == 0 || image.width < 2) return false;
  const std::uint8_t* from = image.row(image.height - rows);
  const auto count = static_cast<std::ptrdiff_t>(rows) * image.width;
  // Black clips the noise, so a dark picture may be wholly constant; only a part is a fault.
  const auto even = [](const std::uint8_t* pixels, std::ptrdiff_t n) {
    return std::all_of(pixels, pixels + n, [pixels](std::uint8_t p) { return p == *pixels; });
  };
  return even(from, count) && !even(image.row(0), count);
}

// Speed ratio of the way back. At equal speed the two views of each place would be symmetric about
// the turn, and the even half of any motion invisible.
constexpr double back_speed = 4.0 / 3.0;

// Stop and shoot: [thesis] chapter 4 turns by a degree in 400 ms; a quarter of that is slow enough
// for any unit.
constexpr double step_speed_rad_per_s = 1.0_deg / 0.4;
constexpr double min_step_speed_rad_per_s = 0.25 * step_speed_rad_per_s;

// State of a scan while frames come in.
struct Intake {
  std::vector<TimedLine> lines;
  std::vector<YawReading> readings;
  Image before;
  bool is_repeated = false;  // the newest frame, bit for bit the one before
  int repeated = 0;
  int torn = 0;
  double compute_ms = 0.0;
};

// Reports the newest profile, as accurately as is known during the turn.
void tell(const Turntable& turntable, const TimedLine& line, int number,
          const ScannerCalibration& calibration, const SweepOptions& options) {
  if (!options.on_profile) return;
  const auto readings = turntable.readings();
  if (!readings) return;
  const auto yaw = yaw_at(std::span(&line.time_s, 1), *readings, calibration.latency_s);
  if (!yaw) return;
  LiveProfile profile{.number = number, .yaw_rad = yaw->front(), .points_in_couch = {}};
  const Transform couch_from_camera = calibration.couch_from_camera_at(profile.yaw_rad);
  for (const LinePoint& seen : line.line.points) {
    if (seen.row % 4 != 0) continue;
    const auto point = triangulate(calibration, static_cast<double>(seen.column_px), seen.row);
    if (point) profile.points_in_couch.push_back(couch_from_camera * *point);
  }
  options.on_profile(profile);
}

// The laser is lit while this lives, however the scan ends.
class LitLaser {
 public:
  explicit LitLaser(Turntable& turntable)
      : turntable_(turntable), lit_(turntable.switch_laser(true)) {}
  ~LitLaser() { (void)turntable_.switch_laser(false); }  // a destructor has nobody to tell
  LitLaser(const LitLaser&) = delete;
  LitLaser& operator=(const LitLaser&) = delete;
  [[nodiscard]] const Result<void>& lit() const { return lit_; }

 private:
  Turntable& turntable_;
  Result<void> lit_;
};

// The line of one frame, and what is wrong with its picture.
Result<void> take_in(Frame frame, const ScannerCalibration& calibration,
                     const LineOptions& line_options, Intake& intake) {
  const auto start = Clock::now();
  if (auto good = check_size(frame.image, calibration.camera, "frame"); !good) return good;
  const bool has_dark = !frame.dark.data.empty();
  if (has_dark) {
    auto good = check_size(frame.dark, calibration.camera, "dark frame");
    if (!good) return good;
  }
  keep_red(frame.image);
  keep_red(frame.dark);
  intake.lines.push_back(
      {frame.time_s,
       find_laser_line(frame.image, line_options, has_dark ? ImageView(frame.dark) : ImageView())});
  // Sensor noise makes every picture different; identical ones mean that the camera hangs.
  const bool has_line = !intake.lines.back().line.points.empty();
  intake.is_repeated = has_line && frame.image.data == intake.before.data;
  intake.repeated += intake.is_repeated ? 1 : 0;
  intake.torn += has_line && half_missing(frame.image) ? 1 : 0;
  intake.before = std::move(frame.image);
  intake.compute_ms += ms_since(start);
  return {};
}

struct Turn {
  double from_rad;
  double to_rad;
  double rad_per_s;
};

// One turn of the unit, from its devices to lines.
Result<void> take_turn(Camera& camera, Turntable& turntable, const Turn& turn,
                       const ScannerCalibration& calibration, const SweepOptions& options,
                       double expected_frames, const Progress& progress, Intake& intake) {
  const bool steps = options.step_rad > 0.0;
  const bool live = options.expected_frames == 0;
  auto started = steps ? turntable.step(turn.from_rad, turn.to_rad, options.step_rad)
                       : turntable.sweep(turn.from_rad, turn.to_rad, turn.rad_per_s);
  if (!started) return started;
  // A unit turns to where it begins with the laser off, and the beam never stands.
  const LitLaser laser(turntable);
  if (!laser.lit()) return laser.lit();
  const auto [first_column, last_column] =
      columns_between(calibration, options.near_m, options.far_m);
  const LineOptions line_options{
      .method = options.method, .first_column = first_column, .last_column = last_column};
  // A motor at half of its speed still arrives in time; one that hangs ends the scan.
  const double speed_rad_per_s = steps ? min_step_speed_rad_per_s : turn.rad_per_s;
  const double turn_s = std::abs(turn.to_rad - turn.from_rad) / speed_rad_per_s;
  ScanWatch watch(steps ? step_speed_rad_per_s : turn.rad_per_s, calibration.latency_s);
  std::optional<double> first_frame_s;
  for (;;) {
    const auto arrived = turntable.arrived();
    if (!arrived) return tl::unexpected(arrived.error());
    if (*arrived) break;
    auto frame = camera.next_frame(frame_timeout_s);
    if (!frame) return tl::unexpected(frame.error());
    const double frame_s = frame->time_s;
    if (!first_frame_s) first_frame_s = frame_s;
    if (live && frame_s - *first_frame_s > 2.0 * turn_s + 5.0) {
      return fail(Fault::device,
                  "the motor has not arrived after {:.1f} s; it should turn for {:.1f} s",
                  frame_s - *first_frame_s, turn_s);
    }
    auto taken = take_in(std::move(*frame), calibration, line_options, intake);
    if (!taken) return taken;
    if (live) {
      const auto so_far = turntable.readings();
      if (!so_far) return tl::unexpected(so_far.error());
      auto good = watch.see(frame_s, !intake.is_repeated, *so_far);
      if (!good) return good;
    }
    tell(turntable, intake.lines.back(), static_cast<int>(intake.lines.size()), calibration,
         options);
    if (progress)
      progress(std::min(0.99, static_cast<double>(intake.lines.size()) / expected_frames));
  }
  const auto readings = turntable.readings();
  if (!readings) return tl::unexpected(readings.error());
  intake.readings.insert(intake.readings.end(), readings->begin(), readings->end());
  return {};
}

Result<void> check(const Intake& intake) {
  const auto count = static_cast<int>(intake.lines.size());
  if (count == 0) return fail(Fault::not_found, "the camera gave no frame");
  if (20 * intake.repeated > count) {
    return fail(Fault::bad_input,
                "{} of {} frames repeat the one before bit for bit: the camera hangs",
                intake.repeated, count);
  }
  if (20 * intake.torn > count) {
    return fail(Fault::bad_input,
                "{} of {} frames are cut: from some row on they are one even grey; is the cable or "
                "the USB bus overloaded?",
                intake.torn, count);
  }
  return {};
}

}  // namespace

Result<Scan> scan_sweep(Camera& camera, Turntable& turntable, const ScannerCalibration& calibration,
                        const SweepOptions& options, const Progress& progress) {
  const double ways = options.both_ways ? 1.0 + 1.0 / back_speed : 1.0;
  const double turn_rad = std::abs(options.to_rad - options.from_rad);
  const double frames = options.expected_frames > 0 ? options.expected_frames
                        : options.step_rad > 0.0    ? ways * turn_rad / options.step_rad
                                                 : ways * 30.0 * turn_rad / options.speed_rad_per_s;
  Intake intake;
  auto taken =
      take_turn(camera, turntable, {options.from_rad, options.to_rad, options.speed_rad_per_s},
                calibration, options, frames, progress, intake);
  if (taken && options.both_ways) {
    taken = take_turn(camera, turntable,
                      {options.to_rad, options.from_rad, back_speed * options.speed_rad_per_s},
                      calibration, options, frames, progress, intake);
  }
  if (!taken) return tl::unexpected(taken.error());
  if (const auto good = check(intake); !good) return tl::unexpected(good.error());

  const auto start = Clock::now();
  auto scan = make_cloud(intake.lines, intake.readings, calibration, options.max_lost_share);
  if (!scan) return tl::unexpected(scan.error());
  scan->compute_ms = intake.compute_ms + ms_since(start);
  if (progress) progress(1.0);
  return scan;
}

}  // namespace tuina::scanner
