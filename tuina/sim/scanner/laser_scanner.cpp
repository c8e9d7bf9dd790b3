// SPDX-License-Identifier: Apache-2.0
#include "tuina/sim/scanner/laser_scanner.hpp"

#include <algorithm>
#include <cmath>
#include <thread>

#include "tuina/core/random.hpp"
#include "tuina/core/units.hpp"
#include "tuina/sim/scanner/line_renderer.hpp"

namespace tuina::sim {
namespace {

constexpr double count_rad = from_deg(300.0 / 1024.0);
constexpr double speed_step_rad_per_s = from_deg(0.111 * 6.0);  // 0.111 rpm, the unit of the AX-12A
constexpr double max_rad = 150.0_deg;
// The gear of a 40-dollar servo turns unevenly.
constexpr double ripple_rad = 0.02_deg;
constexpr double ripple_period_rad = 7.0_deg;
constexpr double run_up_s = 0.3;  // readings begin before the first frame and end after the last
constexpr double step_s = 0.117;  // [thesis] chapter 4: 400 ms per degree in steps of 0.29 degrees
constexpr double rest_share = 0.35;  // share of a step at rest, before and after its frame
constexpr std::size_t frames_at_once = 16;

Vector3 out_of_back(BodyPosture position) {
  return position == BodyPosture::sitting ? Vector3::UnitY() : Vector3::UnitZ();
}

}  // namespace

struct LaserScanner::World {
  scanner::ScannerCalibration truth;
  LaserScannerOptions options;
  LineRenderer renderer;
  Vector3 breath_direction;
  BreathCourse breath;
  Random jitter;

  double from_rad = 0.0;
  double rad_per_s = 0.0;
  double step_rad = 0.0;  // stop and shoot; else 0
  double start_s = 0.0;   // start of this turn on the camera's clock
  double end_s = 0.0;     // end of this turn and its run-down
  std::size_t turns = 0;
  std::size_t frames = 0;
  std::size_t given = 0;
  std::vector<Image> ahead;  // rendered frames not yet returned
  std::vector<Image> dark_ahead;
  std::vector<std::vector<bool>> visible_ahead;
  VisibleRows visible;
  Random drops;
  std::vector<bool> lost;  ///< frames of this turn that never reach the reader
  bool lit = true;
  std::vector<scanner::YawReading> readings;

  [[nodiscard]] double yaw_at(double time_s) const {
    double even = from_rad + rad_per_s * (time_s - start_s);
    if (step_rad != 0.0) {
      // Each frame is taken in the middle of a rest; between rests the unit turns.
      const double steps = (time_s - start_s) / step_s;
      const double rest = std::round(steps);
      const double on_the_way = std::max(0.0, std::abs(steps - rest) - rest_share) /
                                (0.5 - rest_share) * (steps > rest ? 0.5 : -0.5);
      even = from_rad +
             step_rad * std::clamp(rest + on_the_way, 0.0, static_cast<double>(frames) - 1.0);
    }
    return even + ripple_rad * std::sin(2.0 * pi * even / ripple_period_rad);
  }
  [[nodiscard]] double time_of(std::size_t frame) const {
    const double per_frame_s = step_rad != 0.0 ? step_s : 1.0 / options.frames_per_s;
    return start_s + static_cast<double>(frame) * per_frame_s;
  }

  [[nodiscard]] Readout readout_at(double time_s) const {
    constexpr double lamp_rad_per_s = 2.0 * pi * 100.0;
    const double per_row_s = options.flaws.readout_s / truth.camera.height_px;
    const double half_s = 0.5 * options.flaws.readout_s;
    const double turned_rad = yaw_at(time_s + half_s) - yaw_at(time_s - half_s);
    return {.yaw_per_row_rad = turned_rad / truth.camera.height_px,
            .lamp_rad = lamp_rad_per_s * (time_s - half_s),
            .lamp_per_row_rad = lamp_rad_per_s * per_row_s};
  }

  // Starts a turn: clock, frames and motor readings.
  void begin(double duration_s) {
    given = 0;
    if (end_s > 0.0) {
      // The clock, and with it the breath, continues.
      start_s = end_s + run_up_s;
      ++turns;
    }
    end_s = start_s + duration_s + run_up_s;
    lost.assign(frames, false);
    if (options.dropped_share > 0.0) {
      for (std::size_t i = 0; i < frames; ++i)
        lost[i] = uniform(drops, 0.0, 1.0) < options.dropped_share;
    }
    ahead.clear();
    readings.clear();
    const double poll_s = 1.0 / options.readings_per_s;
    double last_s = -1e9;
    // Polling over a serial line is irregular. At some speeds regular polling would always sample
    // the same two phases of a count, and rounding would not average out.
    double time_s = start_s - run_up_s;
    while (time_s < end_s) {
      const double counts = std::round(yaw_at(time_s) / count_rad);
      const double stamp_s = time_s - options.latency_s + gaussian(jitter, options.yaw_jitter_s);
      last_s = std::max(stamp_s, last_s + 1e-6);
      readings.push_back({last_s, from_deg(counts * (300.0 / 1024.0))});
      time_s += poll_s * uniform(jitter, 0.7, 1.3);
    }
  }

  // Renders the next frames in parallel; each depends on its number only.
  void render_ahead() {
    const std::size_t count = std::min(frames_at_once, frames - given);
    ahead.assign(count, {});
    if (options.dark_frames) dark_ahead.assign(count, {});
    visible_ahead.assign(count, {});
    const auto work = [this, count](std::size_t first, std::size_t step) {
      for (std::size_t i = first; i < count; i += step) {
        const std::size_t number = given + i;
        const double time_s = time_of(number);
        const std::uint64_t frame = number + turns * 1000003;  // seed of the frame's noise
        const Vector3 shift = breath.at(time_s).at_m * breath_direction;
        const RoomPicture room = renderer.room(yaw_at(time_s), shift);
        const Readout rows = readout_at(time_s);
        ahead[i] =
            lit ? renderer.render(yaw_at(time_s), shift, frame, &visible_ahead[i], room, rows)
                : renderer.render_dark(frame, room, rows);
        if (options.dark_frames) dark_ahead[i] = renderer.render_dark(frame, room, rows);
      }
    };
    const auto threads = static_cast<std::size_t>(std::max(1, options.threads));
    std::vector<std::jthread> others;
    for (std::size_t i = 1; i < threads; ++i) others.emplace_back(work, i, threads);
    work(0, threads);
    others.clear();
  }

  // The next frame, rendered when it is the first of its batch.
  scanner::Frame take() {
    const std::size_t place = given % frames_at_once;
    if (place == 0) render_ahead();
    scanner::Frame frame{.time_s = time_of(given), .image = std::move(ahead[place]), .dark = {}};
    if (options.dark_frames) frame.dark = std::move(dark_ahead[place]);
    ++given;
    const std::vector<bool>& seen = visible_ahead[place];
    visible.count += static_cast<std::size_t>(std::count(seen.begin(), seen.end(), true));
    return frame;
  }
  // Frames that never reach the reader are seen by the scanner all the same.
  void skip_lost() {
    while (given < frames && lost[given]) (void)take();
  }
};

LaserScanner::LaserScanner(const Mesh& skin_in_couch, BodyPosture position, Breathing breathing,
                           std::uint64_t seed, const LaserScannerOptions& options)
    : LaserScanner(skin_in_couch, position, breathing, seed, options,
                   sim::true_calibration(position, usual_mount(position), options.latency_s)) {}

LaserScanner::LaserScanner(const Mesh& skin_in_couch, BodyPosture position, Breathing breathing,
                           std::uint64_t seed, const LaserScannerOptions& options,
                           const scanner::ScannerCalibration& truth)
    : LaserScanner(skin_in_couch, couch_mesh(position), truth, seed, options) {
  world_->breath_direction = out_of_back(position);
  world_->breath = BreathCourse(breathing, seed);
}

LaserScanner::LaserScanner(const Mesh& scene_in_couch, const Mesh& couch,
                           const scanner::ScannerCalibration& truth, std::uint64_t seed,
                           const LaserScannerOptions& options) {
  world_ = std::make_unique<World>(
      World{.truth = truth,
            .options = options,
            .renderer = LineRenderer(scene_in_couch, couch, truth, options, seed),
            .breath_direction = Vector3::Zero(),
            .breath = {},
            .jitter = make_random(seed, "yaw clock"),
            .ahead = {},
            .dark_ahead = {},
            .visible_ahead = {},
            .visible = {},
            .drops = make_random(seed, "dropped frames"),
            .readings = {}});
  world_->options.latency_s = truth.latency_s;
  if (!options.stickers.empty()) world_->options.dark_frames = true;
}

LaserScanner::~LaserScanner() = default;

const scanner::ScannerCalibration& LaserScanner::true_calibration() const {
  return world_->truth;
}

Result<void> LaserScanner::sweep(double from_rad, double to_rad, double rad_per_s) {
  if (!(std::abs(from_rad) <= max_rad && std::abs(to_rad) <= max_rad && rad_per_s > 0.0)) {
    return fail(
        Fault::device,
        "the motor turns from -150 to 150 degrees, not from {:.1f} to {:.1f} at {:.1f} per s",
        to_deg(from_rad), to_deg(to_rad), to_deg(rad_per_s));
  }
  World& world = *world_;
  const double steps = std::max(1.0, std::round(rad_per_s / speed_step_rad_per_s));
  world.rad_per_s = std::copysign(steps * speed_step_rad_per_s, to_rad - from_rad);
  world.step_rad = 0.0;
  world.from_rad = from_rad;
  const double duration_s = (to_rad - from_rad) / world.rad_per_s;
  world.frames = static_cast<std::size_t>(duration_s * world.options.frames_per_s + 1e-9) + 1;
  world.begin(duration_s);
  return {};
}

Result<void> LaserScanner::step(double from_rad, double to_rad, double step_rad) {
  if (!(std::abs(from_rad) <= max_rad && std::abs(to_rad) <= max_rad && step_rad > 0.0)) {
    return fail(Fault::device,
                "the motor steps from -150 to 150 degrees, not from {:.1f} to {:.1f} by {:.2f}",
                to_deg(from_rad), to_deg(to_rad), to_deg(step_rad));
  }
  World& world = *world_;
  const double counts = std::max(1.0, std::round(step_rad / count_rad));
  world.rad_per_s = 0.0;
  world.step_rad = std::copysign(counts * count_rad, to_rad - from_rad);
  world.from_rad = count_rad * std::round(from_rad / count_rad);
  const double wanted = (to_rad - from_rad) / world.step_rad;
  world.frames = static_cast<std::size_t>(wanted + 1e-9) + 1;
  world.begin(static_cast<double>(world.frames - 1) * step_s);
  return {};
}

Result<std::vector<scanner::YawReading>> LaserScanner::readings() const {
  return world_->readings;
}

Result<bool> LaserScanner::arrived() const {
  return world_->given == world_->frames;
}

Result<void> LaserScanner::switch_laser(bool on) {
  world_->lit = on;
  return {};
}

Result<scanner::Frame> LaserScanner::next_frame(double timeout_s) {
  World& world = *world_;
  world.skip_lost();
  if (world.given == world.frames) {
    return fail(Fault::device, "the camera gave no frame within {:.1f} s: the unit has arrived",
                timeout_s);
  }
  scanner::Frame frame = world.take();
  world.visible.of_frame.push_back(
      std::move(world.visible_ahead[(world.given - 1) % frames_at_once]));
  world.skip_lost();
  return frame;
}

const VisibleRows& LaserScanner::visible() const {
  return world_->visible;
}

}  // namespace tuina::sim
