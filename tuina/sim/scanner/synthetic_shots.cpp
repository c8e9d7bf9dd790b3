// SPDX-License-Identifier: Apache-2.0
#include "tuina/sim/scanner/synthetic_shots.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "tuina/core/io/file.hpp"
#include "tuina/core/io/png.hpp"
#include "tuina/core/units.hpp"
#include "tuina/scanner/recording.hpp"
#include "tuina/scanner/triangulation.hpp"
#include "tuina/sim/person/solids.hpp"
#include "tuina/sim/scanner/laser_scanner.hpp"

namespace tuina::sim {
namespace {

namespace fs = std::filesystem;
using scanner::ScannerCalibration;

constexpr double count_rad = from_deg(300.0 / 1024.0);
constexpr double middle_m = 1.0;
constexpr double max_tilt_rad = 40.0_deg;
constexpr double max_roll_rad = 30.0_deg;
constexpr double standing_step_rad = 2.0_deg;
// Near boards determine the axis best: depth error grows with the square of the distance.
constexpr double nearest_standing_m = 0.75;
constexpr double max_standing_m = 1.25;
constexpr std::size_t min_standing_views = 5;
constexpr double sweep_rad = 12.0_deg;
constexpr double sweep_rad_per_s = 5.994_deg;
constexpr double couch_board_m = 12.0_mm;  // thickness; the upper face is z = 0

using Picture = SyntheticPicture;

Transform about(const Vector3& centre, const Matrix3& rotation, const scanner::Board& board) {
  Transform pose = Transform::Identity();
  pose.linear() = rotation;
  pose.translation() =
      centre - rotation * (0.5 * board.square_m * Vector3(board.columns - 1, board.rows - 1, 0.0));
  return pose;
}

// A randomly tilted board on the light plane, wholly in the picture.
Transform hold_board(const ScannerCalibration& truth, const SyntheticShotsOptions& options,
                     double depth_m, Random& random) {
  const auto& camera = truth.camera;
  for (double tries = 0.0;; tries += 1.0) {
    // A board that does not fit is gradually moved to the middle of the range.
    const double z = depth_m + (middle_m - depth_m) * std::min(1.0, 5e-4 * tries);
    const double row = uniform(random, 0.2, 0.8) * camera.height_px;
    const double y = (row - camera.cy_px) / camera.fy_px * z;
    const Vector3& normal = truth.laser_normal_in_camera;
    const double x = (truth.laser_distance_m - normal.y() * y - normal.z() * z) / normal.x();
    const double width_m = options.board.columns * options.board.square_m;
    const Vector3 centre(x + uniform(random, -0.4, 0.4) * width_m, y, z);
    const double towards = uniform(random, -pi, pi);
    const double tilt = max_tilt_rad * std::sqrt(uniform(random, 0.02, 1.0));
    const double roll = uniform(random, -max_roll_rad, max_roll_rad);
    const Matrix3 rotation =
        (Eigen::AngleAxisd(tilt, Vector3(std::cos(towards), std::sin(towards), 0.0)) *
         Eigen::AngleAxisd(roll, Vector3::UnitZ()))
            .toRotationMatrix();
    Transform pose = about(centre, rotation, options.board);
    if (in_view(camera, options.board, pose)) return pose;
  }
}

// Camera frame at yaw 0 to camera frame at a yaw.
Transform turned_back(const ScannerCalibration& truth, double yaw_rad) {
  return truth.couch_from_camera_at(yaw_rad).inverse() * truth.couch_from_camera;
}

double told(double yaw_rad) {
  return count_rad * std::round(yaw_rad / count_rad) + 0.0;  // never -0
}

// One standing board from every yaw at which it is wholly visible.
std::vector<Picture> stand_board(const ScannerCalibration& truth,
                                 const SyntheticShotsOptions& options, int pose, double depth_m,
                                 Random& random) {
  for (;;) {
    const Transform standing = hold_board(truth, options, depth_m, random);
    std::vector<Picture> pictures;
    const int steps = static_cast<int>(std::lround(sweep_rad / standing_step_rad));
    for (int step = -steps; step <= steps; ++step) {
      const double yaw_rad = step * standing_step_rad + uniform(random, -0.5, 0.5) * count_rad;
      const Transform seen = turned_back(truth, yaw_rad) * standing;
      if (!in_view(truth.camera, options.board, seen)) continue;
      pictures.push_back({.pose = pose, .yaw_rad = told(yaw_rad), .camera_from_board = seen});
    }
    if (pictures.size() >= min_standing_views) return pictures;
  }
}

Result<void> take(const ScannerCalibration& truth, std::uint64_t seed, const fs::path& folder,
                  const SyntheticShotsOptions& options, const std::vector<Picture>& pictures,
                  const Progress& progress) {
  std::atomic<std::size_t> next = 0;
  std::size_t done = 0;
  std::mutex telling;
  Result<void> outcome;
  const auto work = [&] {
    for (std::size_t i = next++; i < pictures.size(); i = next++) {
      Random random = make_random(seed, fmt::format("calibration picture {}", i));
      BoardLight light = pictures[i].laser ? laser_exposure() : board_exposure();
      light.laser_dn *= options.line_share;
      const Image image =
          photograph(truth, options.board, pictures[i].camera_from_board, light, random);
      const auto written = write_file(folder / fmt::format("{:06}.png", i), to_png(image));
      const std::scoped_lock lock(telling);
      if (!written) outcome = written;
      ++done;
      if (progress) progress(static_cast<double>(done) / static_cast<double>(pictures.size()));
    }
  };
  std::vector<std::jthread> others;
  for (int i = 1; i < options.threads; ++i) others.emplace_back(work);
  work();
  others.clear();
  return outcome;
}

std::string frames_csv(const std::vector<Picture>& pictures) {
  std::string text = "frame,kind,pose,time_s,yaw_deg\n";
  for (std::size_t i = 0; i < pictures.size(); ++i) {
    const Picture& picture = pictures[i];
    text += fmt::format("{},{},{},{},{:.4f}\n", i, picture.laser ? "laser" : "board", picture.pose,
                        2 * i, to_deg(picture.yaw_rad));
  }
  return text;
}

std::string board_toml(const scanner::Board& board) {
  std::string text = fmt::format(
      "[board]\nkind = \"{}\"\ncolumns = {}  # inner corners\nrows = {}\nsquare_m = {}\n",
      board.has_markers() ? "charuco" : "chessboard", board.columns, board.rows, board.square_m);
  if (board.has_markers()) {
    text += fmt::format("marker_m = {}\ndictionary = \"DICT_{}X{}_{}\"\n", board.marker_m,
                        board.marker_cells, board.marker_cells, scanner::max_markers);
  }
  return text;
}

void add_rectangle(Mesh& mesh, const Vector3& corner, const Vector3& along, const Vector3& across) {
  const auto first = static_cast<int>(mesh.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(),
                       {corner, corner + along, corner + along + across, corner + across});
  mesh.triangles.push_back({first, first + 1, first + 2});
  mesh.triangles.push_back({first, first + 2, first + 3});
}

Mesh lowered(Mesh mesh, double by_m) {
  for (Vector3& vertex : mesh.vertices) vertex.z() -= by_m;
  return mesh;
}

// Three open books standing like tents under the scanner: slanted surfaces determine the latency.
Mesh still_scene() {
  Mesh mesh;
  for (const double x : {-0.22, 0.0, 0.22}) {
    const Vector3 ridge(x, -0.56, 0.11);
    const Vector3 along(0.0, 0.44, 0.0);
    add_rectangle(mesh, ridge, Vector3(0.09, 0.0, -0.11), along);
    add_rectangle(mesh, ridge + along, Vector3(-0.09, 0.0, -0.11), -along);
  }
  return mesh;
}

Mesh flat_board() {
  Mesh mesh;
  add_rectangle(mesh, {-0.25, -0.54, 0.0}, {0.5, 0.0, 0.0}, {0.0, 0.4, 0.0});
  return mesh;
}

// A ball of 150 mm lying on the couch.
Mesh ball() {
  constexpr double radius_m = 75.0_mm;
  return ball_mesh({0.0, -0.34, radius_m}, radius_m);
}

// The box of the thesis, propped up so that a corner points at the scanner.
Mesh box() {
  const Vector3 size_m(150.0_mm, 150.0_mm, 200.0_mm);
  const Matrix3 turned = Eigen::AngleAxisd(90.0_deg, Vector3::UnitX()) * corner_towards_y();
  Mesh mesh = box_mesh({0.0, -0.34, 0.0}, turned, size_m);
  double min_m = 0.0;
  for (const Vector3& vertex : mesh.vertices) min_m = std::min(min_m, vertex.z());
  return lowered(std::move(mesh), min_m);
}

Result<void> record(const Mesh& scene, const Mesh& couch, const ScannerCalibration& truth,
                    std::uint64_t seed, double from_rad, const fs::path& folder) {
  LaserScanner unit(scene, couch, truth, seed, {});
  auto recorder = scanner::Recorder::open(unit, unit, folder);
  if (!recorder) return tl::unexpected(recorder.error());
  if (auto turned = recorder->sweep(from_rad, -from_rad, sweep_rad_per_s); !turned) {
    return turned;
  }
  while (recorder->arrived() == false) {
    const auto frame = recorder->next_frame(scanner::frame_timeout_s);
    if (!frame) return tl::unexpected(frame.error());
  }
  return recorder->finish(
      true_calibration(BodyPosture::prone, usual_mount(BodyPosture::prone), 0.1));
}

Result<void> record_sweeps(const ScannerCalibration& truth, std::uint64_t seed,
                           const fs::path& folder, const Progress& progress) {
  const Mesh bed = lowered(couch_mesh(BodyPosture::prone), couch_board_m);
  struct Part {
    const char* name;
    Mesh scene;
    double from_rad;
  };
  const Part parts[] = {{"sweep_left", still_scene(), sweep_rad},
                        {"sweep_right", still_scene(), -sweep_rad},
                        {"couch", flat_board(), -sweep_rad},
                        {"ball", ball(), -sweep_rad},
                        {"box", box(), -sweep_rad}};
  double done = 0.0;
  for (const Part& part : parts) {
    auto recorded = record(part.scene, bed, truth, ++seed, part.from_rad, folder / part.name);
    if (!recorded) return recorded;
    done += 1.0 / static_cast<double>(std::size(parts));
    if (progress) progress(done);
  }
  return {};
}

Result<void> write_set(const ScannerCalibration& truth, std::uint64_t seed, const fs::path& folder,
                       const SyntheticShotsOptions& options, const Progress& progress) {
  const auto pictures = synthetic_pictures(truth, seed, options);
  std::error_code error;
  fs::create_directories(folder / "frames", error);
  if (error) return fail(Fault::file, "{}: {}", folder.string(), error.message());
  const double share = options.sweeps ? 0.6 : 1.0;
  const auto some = [&](double from, double to) -> Progress {
    if (!progress) return {};
    return [&progress, from, to](double done) { progress(from + (to - from) * done); };
  };
  auto taken = take(truth, seed, folder / "frames", options, pictures, some(0.0, share));
  if (!taken) return taken;
  const std::string board = board_toml(options.board);
  if (auto written = write_file(folder / "board.toml", board); !written) return written;
  if (auto written = write_file(folder / "frames.csv", frames_csv(pictures)); !written) {
    return written;
  }
  return options.sweeps ? record_sweeps(truth, seed, folder, some(share, 1.0)) : Result<void>();
}

}  // namespace

ScannerCalibration built_scanner(std::uint64_t seed, bool upright) {
  Random random = make_random(seed, "built scanner");
  ScannerMount mount = usual_mount(BodyPosture::prone);
  mount.upright = upright;
  ScannerCalibration built = true_calibration(BodyPosture::prone, mount);
  auto& camera = built.camera;
  camera.fx_px += gaussian(random, 15.0);
  camera.fy_px = camera.fx_px + gaussian(random, 1.0);
  camera.cx_px += gaussian(random, 6.0);
  camera.cy_px += gaussian(random, 6.0);
  camera.distortion = {-0.06 + gaussian(random, 0.03), gaussian(random, 0.05),
                       gaussian(random, 5e-4), gaussian(random, 5e-4), 0.0};
  const auto tilted = [&random](const Vector3& direction, double by_rad) {
    const Vector3 aside(gaussian(random, by_rad), gaussian(random, by_rad),
                        gaussian(random, by_rad));
    return Vector3((direction + aside).normalized());
  };
  built.laser_normal_in_camera = tilted(built.laser_normal_in_camera, 0.4_deg);
  built.laser_distance_m += gaussian(random, 2.0_mm);
  built.axis_direction_in_camera = tilted(built.axis_direction_in_camera, 0.7_deg);
  built.axis_point_in_camera += Vector3(gaussian(random, 2.0_mm), 0.0, gaussian(random, 2.0_mm));
  built.latency_s = uniform(random, 0.04, 0.14);
  const Vector3 lean(gaussian(random, 0.8_deg), gaussian(random, 0.8_deg), 0.0);
  Transform off = Transform::Identity();
  off.linear() = Eigen::AngleAxisd(lean.norm(), lean.normalized()).toRotationMatrix();
  off.translation().z() = gaussian(random, 8.0_mm);
  built.couch_from_camera = off * built.couch_from_camera;
  return built;
}

std::vector<SyntheticPicture> synthetic_pictures(const ScannerCalibration& truth,
                                                 std::uint64_t seed,
                                                 const SyntheticShotsOptions& options) {
  Random random = make_random(seed, "calibration poses");
  std::vector<Picture> pictures;
  for (int pose = 0; pose < options.poses; ++pose) {
    // The same number of boards in each part of the range.
    const double part = (pose + uniform(random, 0.0, 1.0)) / options.poses;
    const double depth_m = options.nearest_m + part * (options.max_distance_m - options.nearest_m);
    const Transform seen = hold_board(truth, options, depth_m, random);
    pictures.push_back({.pose = pose, .camera_from_board = seen});
    pictures.push_back({.laser = true, .pose = pose, .camera_from_board = seen});
  }
  for (int i = 0; i < options.standing_poses; ++i) {
    const double part = static_cast<double>(i) / std::max(1, options.standing_poses - 1);
    const double depth_m = nearest_standing_m + part * (max_standing_m - nearest_standing_m);
    const auto views = stand_board(truth, options, options.poses + i, depth_m, random);
    pictures.insert(pictures.end(), views.begin(), views.end());
  }
  return pictures;
}

Result<void> render_calibration_shots(const ScannerCalibration& truth, std::uint64_t seed,
                                      const fs::path& folder, const SyntheticShotsOptions& options,
                                      const Progress& progress) {
  std::error_code error;
  if (fs::exists(folder, error) && !fs::is_empty(folder, error)) {
    return fail(Fault::file, "{}: it exists already and is not an empty folder", folder.string());
  }
  fs::path part = folder;
  if (!part.has_filename()) part = part.parent_path();
  part += ".part";
  fs::remove_all(part, error);
  auto written = write_set(truth, seed, part, options, progress);
  if (!written) {
    fs::remove_all(part, error);
    return written;
  }
  fs::remove(folder, error);  // removes an empty folder of that name
  fs::rename(part, folder, error);
  if (error) return fail(Fault::file, "{}: {}", folder.string(), error.message());
  return {};
}

}  // namespace tuina::sim
