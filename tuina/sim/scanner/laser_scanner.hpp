// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "tuina/core/acupoint.hpp"
#include "tuina/core/surface.hpp"
#include "tuina/scanner/calibration.hpp"
#include "tuina/scanner/camera.hpp"
#include "tuina/scanner/sweep.hpp"
#include "tuina/scanner/turntable.hpp"
#include "tuina/sim/person/person.hpp"
#include "tuina/sim/scanner/room_light.hpp"

namespace tuina::sim {

/// How the scanner stands before the couch: its yaw axis through a point, looking horizontally at a
/// person who sits; the same arrangement turned by +90 degrees about x looks down on one who lies
/// prone.
struct ScannerMount {
  double distance_m = 1.13;  ///< of the yaw axis from the couch's origin, out of the back
  double along_spine_m =
      0.41;             ///< height above the seat (sitting), from the hips towards the head (prone)
  bool upright = true;  ///< 640 rows along the spine; else 480
};

/// Sitting: 1.1 m behind the usual back; prone: 1.1 m above it.
[[nodiscard]] ScannerMount usual_mount(Position position);

struct LaserScannerOptions {
  double noise_dn = 4.0;        ///< of one pixel
  double room_light_dn = 10.0;  ///< black level and light of the room
  double amplitude_dn = 200.0;  ///< of a white wall, upright to the camera, at 1.1 m
  double width_px = 2.5;        ///< standard deviation across the line
  double frames_per_s = 30.0;
  double readings_per_s = 50.0;
  double yaw_jitter_s = 0.001;  ///< standard deviation of the time stamps of the motor
  double latency_s = 0.12;      ///< the thesis' scanner: motor clock behind camera clock
  double speckle_px = 0.0;      ///< by which coherent light displaces the line, from row to row
  double dropped_share = 0.0;   ///< of the frames, lost on their way
  bool dark_frames = false;     ///< each frame comes with one taken with the laser off
  /// With stickers on the skin, frames are in colour and the lights of the room are on; the laser
  /// line is told from what they show by dark frames.
  std::vector<SkinSticker> stickers = {};
  double room_white_dn = 90.0;  ///< of a white wall, in colour frames
  int threads = 2;
};

/// The scanner of the thesis as it truly is: 640x480 pixels of 6 um, f 6.25 mm, baseline 200 mm,
/// laser leaning by 73 degrees to it, yaw axis half way, mounted before the couch.
[[nodiscard]] scanner::ScannerCalibration true_calibration(Position position,
                                                           const ScannerMount& mount,
                                                           double latency_s = 0.12);
[[nodiscard]] inline scanner::ScannerCalibration true_calibration(Position position) {
  return true_calibration(position, usual_mount(position));
}

/// What a careful user knows of that scanner after calibrating it from 40 poses of a chessboard, a
/// motor swept both ways and a flat board on the couch: the true one with the errors which that
/// leaves, drawn by the seed.
[[nodiscard]] scanner::ScannerCalibration believed_calibration(
    const scanner::ScannerCalibration& truth, std::uint64_t seed);

/// Where laser and camera both see something, the middle of the laser's sheet at least.
struct VisibleRows {
  std::vector<std::vector<bool>> of_frame;  ///< by row, of each frame given
  std::size_t count = 0;                    ///< over all frames, those lost on their way as well
};

/// Renders what the scanner sees of a person on the couch: ray-traced line, occlusion from laser
/// and camera, noise, saturation; a yaw motor of 300/1024 degrees on a clock of its own. It is
/// camera and turntable in one; frames depend on the seed, never on the number of threads.
class LaserScanner final : public scanner::Camera, public scanner::Turntable {
 public:
  LaserScanner(const Mesh& skin_in_couch, Position position, Breathing breathing,
               std::uint64_t seed, const LaserScannerOptions& options = {});
  LaserScanner(const Mesh& skin_in_couch, Position position, Breathing breathing,
               std::uint64_t seed, const LaserScannerOptions& options,
               const scanner::ScannerCalibration& truth);
  /// Any scanner before any still scene.
  LaserScanner(const Mesh& scene_in_couch, const Mesh& couch,
               const scanner::ScannerCalibration& truth, std::uint64_t seed,
               const LaserScannerOptions& options);
  ~LaserScanner() override;

  [[nodiscard]] Result<scanner::Frame> next_frame(double timeout_s) override;
  [[nodiscard]] Result<void> sweep(double from_rad, double to_rad, double rad_per_s) override;
  /// In whole counts of the motor, 117 ms each ([thesis] chapter 4: 0.29 degrees, 400 ms per
  /// degree).
  [[nodiscard]] Result<void> step(double from_rad, double to_rad, double step_rad) override;
  [[nodiscard]] Result<bool> arrived() const override;
  [[nodiscard]] Result<void> switch_laser(bool on) override;
  [[nodiscard]] Result<std::vector<scanner::YawReading>> readings() const override;

  [[nodiscard]] const scanner::ScannerCalibration& true_calibration() const;
  /// Over all turns so far.
  [[nodiscard]] const VisibleRows& visible() const;

 private:
  struct World;
  std::unique_ptr<World> world_;
};

/// The seat (sitting) or bed (prone) as the scanner sees it, top at z = 0.
[[nodiscard]] Mesh couch_mesh(Position position);

/// How far a cloud is from the surface that it is a scan of.
struct ScanTruth {
  double rms_error_m = 0.0;
  double worst_error_m = 0.0;
  std::size_t points = 0;    ///< of the person; points of the couch (below 15 mm) are left out
  std::size_t outliers = 0;  ///< of these, farther than 5 mm from the surface
};
[[nodiscard]] ScanTruth compare_with_truth(const PointCloud& cloud_in_couch,
                                           const Mesh& skin_in_couch);

/// Of the places that laser and camera both see, the share of which a scan has a point. Those lost
/// with their frames are missing, and a point beside the edge of what is visible is none.
[[nodiscard]] double seen_share(const VisibleRows& visible, const scanner::Scan& scan);

/// RMS over the rows of the image of the range that a calibration tells wrongly at a depth, for
/// places of the light plane that the camera of the true scanner sees.
[[nodiscard]] double range_error_m(const scanner::ScannerCalibration& truth,
                                   const scanner::ScannerCalibration& believed, double depth_m);

}  // namespace tuina::sim
