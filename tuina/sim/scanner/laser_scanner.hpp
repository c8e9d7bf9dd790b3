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
#include "tuina/sim/person/breath.hpp"
#include "tuina/sim/scanner/room_light.hpp"
#include "tuina/sim/scanner/skin_light.hpp"

namespace tuina::sim {

/// Placement of the scanner: yaw axis through a point, looking horizontally at a sitting person;
/// for a prone person the same turned by +90 degrees about x, looking down.
struct ScannerMount {
  double distance_m = 1.13;  ///< yaw axis to the couch's origin, out of the back
  /// Height above the seat (sitting), from the hips towards the head (prone).
  double along_spine_m = 0.41;
  bool upright = true;  ///< 640 rows along the spine; else 480
};

/// Sitting: 1.1 m behind the usual back; prone: 1.1 m above it.
[[nodiscard]] ScannerMount usual_mount(BodyPosture position);

/// Light, camera and motor of the scanner, and what is wrong with them.
struct LaserScannerOptions {
  double noise_dn = 4.0;        ///< noise of one pixel
  double room_light_dn = 10.0;  ///< black level and room light
  double amplitude_dn = 200.0;  ///< line on a white wall facing the camera at 1.1 m
  double width_px = 2.5;        ///< standard deviation across the line
  double frames_per_s = 30.0;
  double readings_per_s = 50.0;
  double yaw_jitter_s = 0.001;  ///< standard deviation of the motor's time stamps
  double latency_s = 0.12;      ///< the thesis' scanner: motor clock behind camera clock
  double speckle_px = 0.0;      ///< displacement by coherent light, from row to row
  double dropped_share = 0.0;   ///< share of lost frames
  bool dark_frames = false;     ///< each frame comes with one taken with the laser off
  /// With stickers on the skin, frames are in colour under room light, and dark frames separate the
  /// laser line.
  std::vector<SkinSticker> stickers = {};
  double room_white_dn = 90.0;  ///< white wall, in colour frames
  ScanFlaws flaws = {};
  int threads = 2;
};

/// True scanner of the thesis: 640x480 pixels of 6 um, f 6.25 mm, baseline 200 mm, laser leaning by
/// 73 degrees to it, yaw axis half way, placed before the couch.
[[nodiscard]] scanner::ScannerCalibration true_calibration(BodyPosture position,
                                                           const ScannerMount& mount,
                                                           double latency_s = 0.12);
/// The true scanner where it usually stands for a person in that position.
[[nodiscard]] inline scanner::ScannerCalibration true_calibration(BodyPosture position) {
  return true_calibration(position, usual_mount(position));
}

/// Calibration of that scanner by a careful user (40 poses of a chessboard, a motor sweep both
/// ways, a flat board on the couch): the true one with errors drawn by the seed.
[[nodiscard]] scanner::ScannerCalibration believed_calibration(
    const scanner::ScannerCalibration& truth, std::uint64_t seed);

/// Rows in which laser and camera both see the centre of the laser's sheet.
struct VisibleRows {
  std::vector<std::vector<bool>> of_frame;  ///< by row, for each frame
  std::size_t count = 0;                    ///< over all frames, lost ones included
};

/// Renders what the scanner sees of a person on the couch: ray-traced line, occlusion from laser
/// and camera, noise, saturation; a yaw motor of 300/1024 degrees on a clock of its own. It is
/// camera and turntable in one; frames depend on the seed, never on the number of threads.
class LaserScanner final : public scanner::Camera, public scanner::Turntable {
 public:
  /// @{
  /// The scanner of the thesis, or the one of that calibration, before a person who breathes.
  LaserScanner(const Mesh& skin_in_couch, BodyPosture position, Breathing breathing,
               std::uint64_t seed, const LaserScannerOptions& options = {});
  LaserScanner(const Mesh& skin_in_couch, BodyPosture position, Breathing breathing,
               std::uint64_t seed, const LaserScannerOptions& options,
               const scanner::ScannerCalibration& truth);
  /// @}
  /// Any scanner before any still scene.
  LaserScanner(const Mesh& scene_in_couch, const Mesh& couch,
               const scanner::ScannerCalibration& truth, std::uint64_t seed,
               const LaserScannerOptions& options);
  ~LaserScanner() override;

  [[nodiscard]] Result<scanner::Frame> next_frame(double timeout_s) override;
  [[nodiscard]] Result<void> sweep(double from_rad, double to_rad, double rad_per_s) override;
  /// Steps of whole motor counts, 117 ms each ([thesis] chapter 4: 0.29 degrees, 400 ms per
  /// degree).
  [[nodiscard]] Result<void> step(double from_rad, double to_rad, double step_rad) override;
  [[nodiscard]] Result<bool> arrived() const override;
  [[nodiscard]] Result<void> switch_laser(bool on) override;
  [[nodiscard]] Result<std::vector<scanner::YawReading>> readings() const override;

  /// What its pictures are rendered by.
  [[nodiscard]] const scanner::ScannerCalibration& true_calibration() const;
  /// Over all turns so far.
  [[nodiscard]] const VisibleRows& visible() const;

 private:
  struct World;
  std::unique_ptr<World> world_;
};

/// The seat (sitting) or bed (prone) as the scanner sees it, top at z = 0.
[[nodiscard]] Mesh couch_mesh(BodyPosture position);

/// Distance of a cloud from the scanned surface.
struct ScanTruth {
  double mean_error_m = 0.0;  ///< outward
  double rms_error_m = 0.0;
  double worst_error_m = 0.0;
  std::size_t points = 0;    ///< points of the person; the couch (below 15 mm) is left out
  std::size_t outliers = 0;  ///< of these, farther than 5 mm from the surface
};
/// Compares the points of a cloud with the true skin.
[[nodiscard]] ScanTruth compare_with_truth(const PointCloud& cloud_in_couch,
                                           const Mesh& skin_in_couch);

/// Share of the visible places with a point in the scan. Lost frames count as missing; points
/// beside the edge of what is visible are ignored.
[[nodiscard]] double seen_share(const VisibleRows& visible, const scanner::Scan& scan);

/// RMS range error of a calibration at a depth, over the image rows, for points of the light plane
/// that the true camera sees.
[[nodiscard]] double range_error_m(const scanner::ScannerCalibration& truth,
                                   const scanner::ScannerCalibration& believed, double depth_m);

}  // namespace tuina::sim
