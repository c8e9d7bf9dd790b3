// SPDX-License-Identifier: Apache-2.0
#include "tuina/calibration/calibrate.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include "tuina/calibration/board/find_board.hpp"
#include "tuina/calibration/board/repeats.hpp"
#include "tuina/core/units.hpp"

namespace tuina::calibration {
namespace {

namespace fs = std::filesystem;

// Boards outside this range were not held before this scanner: the square size is wrong.
constexpr double nearest_m = 0.15;
constexpr double max_distance_m = 4.0;
constexpr double usual_nearest_m = 0.25;
constexpr double usual_farthest_m = 3.0;
constexpr double min_depth_ratio = 1.3;
constexpr double min_tilt_rad = 10.0_deg;
constexpr double max_reprojection_px = 1.0;
// Maximum expected error at 1 m.
constexpr double max_error_m = 10.0_mm;
constexpr double max_axis_rad = 0.5_deg;
constexpr double max_axis_m = 10.0_mm;
// Webcam on USB and servo on a serial line; the thesis found 0.12 s ([thesis] 4.2).
constexpr double latency_unknown_s = 0.1;

Result<void> check_poses(const Views& views) {
  std::set<int> with_board;
  std::set<int> with_laser;
  std::set<int> with_line;
  for (const View& view : views.views) {
    with_board.insert(view.pose);
    if (view.laser_on) with_laser.insert(view.pose);
    if (view.line.size() >= min_line_points) with_line.insert(view.pose);
  }
  const auto enough = [](const std::set<int>& poses) {
    return poses.size() >= static_cast<std::size_t>(min_poses);
  };
  if (!enough(with_laser)) {
    return fail(Fault::bad_input,
                "{} poses show the board, {} of them have a laser picture as well; {} with both "
                "are needed, 20 to 40 are good",
                with_board.size(), with_laser.size(), min_poses);
  }
  if (!enough(with_line)) {
    return fail(Fault::bad_input,
                "a laser line is seen in {} of {} poses with a laser picture, {} needed; is the "
                "laser on, the exposure short and the line across the board?",
                with_line.size(), with_laser.size(), min_poses);
  }
  return {};
}

double depth_m(const Transform& camera_from_board, const Board& board) {
  const Vector3 middle(0.5 * (board.columns - 1) * board.square_m,
                       0.5 * (board.rows - 1) * board.square_m, 0.0);
  return (camera_from_board * middle).z();
}

// Zhang's method cannot separate focal length from distance when all boards are parallel, and a
// light plane needs several distances. Only boards with a line count.
Result<void> check_spread(const Views& views, const std::vector<Transform>& camera_from_board) {
  std::vector<double> depths;
  std::vector<Vector3> normals;
  Vector3 mean_normal = Vector3::Zero();
  for (std::size_t i = 0; i < views.views.size(); ++i) {
    if (views.views[i].line.size() < min_line_points) continue;
    depths.push_back(depth_m(camera_from_board[i], views.board));
    normals.emplace_back(camera_from_board[i].linear().col(2));
    mean_normal += normals.back();
  }
  mean_normal.normalize();
  std::sort(depths.begin(), depths.end());
  const double middle = depths[depths.size() / 2];
  if (depths.front() < nearest_m || depths.back() > max_distance_m || middle < usual_nearest_m ||
      middle > usual_farthest_m) {
    return fail(Fault::bad_input,
                "the boards would stand {:.2f} to {:.2f} m away, half of them within {:.2f} m: is "
                "square_m = {} in board.toml right?",
                depths.front(), depths.back(), middle, views.board.square_m);
  }
  std::vector<double> tilts;
  tilts.reserve(normals.size());
  for (const Vector3& normal : normals) {
    tilts.push_back(std::acos(std::clamp(normal.dot(mean_normal), -1.0, 1.0)));
  }
  std::sort(tilts.begin(), tilts.end());
  const double often_rad = tilts[tilts.size() * 3 / 4];
  if (often_rad < min_tilt_rad) {
    return fail(Fault::bad_input,
                "the boards are almost parallel: three of four are within {:.0f} deg of each "
                "other; tilt them by 20 to 40 deg, each another way",
                to_deg(often_rad));
  }
  const double near = depths[depths.size() / 10];
  const double far = depths[depths.size() - 1 - depths.size() / 10];
  if (far < min_depth_ratio * near) {
    return fail(Fault::bad_input,
                "all boards stand at about one distance, {:.2f} to {:.2f} m; hold them from the "
                "nearest to the farthest place that is to be scanned",
                near, far);
  }
  return {};
}

Result<void> check_result(const Calibrated& result) {
  if (result.reprojection_px > max_reprojection_px) {
    return fail(Fault::bad_input,
                "the corners are off by {:.2f} px RMS, {} is the most that can be: pictures "
                "blurred, board not flat, or not all from one camera?",
                result.reprojection_px, max_reprojection_px);
  }
  const auto& at_1_m = result.expected[1];
  if (at_1_m && at_1_m->systematic_m > max_error_m) {
    return fail(Fault::bad_input,
                "a range error of {:.0f} mm at 1 m is to be expected from these pictures: hold the "
                "board at more distances and tilts, nearer too",
                to_mm(at_1_m->systematic_m));
  }
  const Covariance& covariance = result.fit.covariance;
  const double tilt_rad = std::sqrt(
      std::max(covariance(axis_tilt_1, axis_tilt_1), covariance(axis_tilt_2, axis_tilt_2)));
  const double shift_m = std::sqrt(
      std::max(covariance(axis_shift_1, axis_shift_1), covariance(axis_shift_2, axis_shift_2)));
  if (tilt_rad > max_axis_rad || shift_m > max_axis_m) {
    return fail(Fault::bad_input,
                "the yaw axis is known to {:.2f} deg and {:.1f} mm only: turn the unit farther "
                "before a standing board, or before more of them",
                to_deg(tilt_rad), to_mm(shift_m));
  }
  return {};
}

void sum_up(const Views& views, Calibrated& result) {
  std::set<int> poses;
  std::set<int> seen;
  std::set<int> standing;
  for (const View& view : views.views) {
    if (!seen.insert(view.pose).second) standing.insert(view.pose);
  }
  double corners2 = 0.0;
  double line2 = 0.0;
  double axis2 = 0.0;
  int lines = 0;
  int standing_views = 0;
  for (std::size_t i = 0; i < views.views.size(); ++i) {
    const ViewResidual& residual = result.fit.residuals[i];
    corners2 += residual.reprojection_px * residual.reprojection_px;
    if (residual.line_points > 0) {
      poses.insert(views.views[i].pose);
      line2 += residual.line_m * residual.line_m * residual.line_points;
      lines += residual.line_points;
    }
    if (standing.contains(views.views[i].pose)) {
      const Geometry& geometry = result.fit.geometry;
      const double m_per_px =
          depth_m(geometry.camera_from_board[i], views.board) / geometry.camera.fx_px;
      axis2 += std::pow(residual.reprojection_px * m_per_px, 2);
      ++standing_views;
    }
  }
  result.poses = static_cast<int>(poses.size());
  result.reprojection_px = std::sqrt(corners2 / static_cast<double>(views.views.size()));
  result.laser_rms_m = std::sqrt(line2 / std::max(1, lines));
  result.axis_rms_m = std::sqrt(axis2 / std::max(1, standing_views));
  for (const double depth : reported_depths_m) {
    result.expected.push_back(
        expected_range_error(result.fit.geometry, result.fit.covariance, depth));
  }
}

// Prefixes an error with the sub-folder.
template <typename T>
tl::unexpected<Error> in_folder(const fs::path& folder, const Result<T>& failed) {
  return tl::unexpected(
      Error{failed.error().fault, fmt::format("{}: {}", folder.string(), failed.error().message)});
}

Progress part_of(const Progress& progress, double from, double to) {
  if (!progress) return {};
  return [progress, from, to](double done) { progress(from + (to - from) * done); };
}

// Expected errors, as a scan needs them.
scanner::CalibrationErrors errors_of(const JointFit& fit) {
  std::vector<double> depth_m;
  std::vector<double> range_m;
  for (const double depth : {0.35, 0.5, 0.65, 0.8, 1.0, 1.25, 1.5, 1.75, 2.0, 2.5}) {
    const auto error = expected_range_error(fit.geometry, fit.covariance, depth);
    if (!error) continue;
    depth_m.push_back(depth);
    range_m.push_back(error->systematic_m);
  }
  scanner::CalibrationErrors errors{.latency_s = latency_unknown_s};
  if (!depth_m.empty()) {
    errors.depth_m = std::move(depth_m);
    errors.range_m = std::move(range_m);
  }
  const auto each_of = [&fit](int i, int k) {
    return std::sqrt(0.5 * (fit.covariance(i, i) + fit.covariance(k, k)));
  };
  errors.axis_direction_rad = each_of(axis_tilt_1, axis_tilt_2);
  errors.axis_point_m = each_of(axis_shift_1, axis_shift_2);
  return errors;
}

// Boards cannot tell left from right nor the sign of the yaw; the nominal calibration beside a
// sweep does.
Result<void> check_turn(const fs::path& folder, const Sweep& sweep, const Calibrated& result) {
  const Vector3& nominal = sweep.nominal.axis_direction_in_camera;
  if (nominal.dot(result.calibration.axis_direction_in_camera) > 0.0) return {};
  return fail(
      Fault::bad_input,
      "{}: the boards show the unit turning the other way than the nominal calibration.toml "
      "here says: the pictures are mirrored, or yaw_deg in frames.csv has the wrong sign",
      folder.string());
}

Result<void> add_latency(const fs::path& folder, Calibrated& result, const Progress& progress) {
  std::error_code error;
  const bool left = fs::exists(folder / "sweep_left", error);
  const bool right = fs::exists(folder / "sweep_right", error);
  if (!left && !right) {
    result.remarks.emplace_back(
        "The latency was not measured: record one still scene with the yaw falling (sweep_left) "
        "and rising (sweep_right).");
    return {};
  }
  if (left != right) {
    return fail(Fault::bad_input, "{}: {} is there without {}; the latency needs both",
                folder.string(), left ? "sweep_left" : "sweep_right",
                left ? "sweep_right" : "sweep_left");
  }
  const auto falling =
      read_sweep(folder / "sweep_left", result.calibration.camera, part_of(progress, 0.0, 0.5));
  if (!falling) return tl::unexpected(falling.error());
  if (auto good = check_turn(folder / "sweep_left", *falling, result); !good) return good;
  const auto rising =
      read_sweep(folder / "sweep_right", result.calibration.camera, part_of(progress, 0.5, 1.0));
  if (!rising) return tl::unexpected(rising.error());
  const auto latency = find_latency(*falling, *rising);
  if (!latency) return in_folder(folder, latency);
  result.latency = *latency;
  result.calibration.latency_s = latency->latency_s;
  result.calibration.errors->latency_s = latency->deviation_s;
  return {};
}

Result<void> add_couch(const fs::path& folder, Calibrated& result, const Progress& progress) {
  std::error_code error;
  if (!fs::exists(folder / "couch", error)) {
    result.calibration.couch_from_camera = couch_not_measured(result.calibration);
    result.remarks.emplace_back(
        "Where the scanner stands over the couch was not measured: sweep over a bare flat board "
        "lying on it (couch).");
    return {};
  }
  const auto sweep = read_sweep(folder / "couch", result.calibration.camera, progress);
  if (!sweep) return tl::unexpected(sweep.error());
  if (auto good = check_turn(folder / "couch", *sweep, result); !good) return good;
  const auto pose = find_couch(*sweep, result.calibration);
  if (!pose) return in_folder(folder / "couch", pose);
  result.couch = *pose;
  // A range error shifts the whole board, so the height is no better than the range.
  const double away_m = pose->couch_from_camera.translation().z();
  result.couch->height_deviation_m =
      std::hypot(pose->height_deviation_m, result.calibration.errors->range_at_m(away_m));
  result.calibration.couch_from_camera = pose->couch_from_camera;
  return {};
}

/// Lines that the others contradict would count as error of the plane. Returns what is said of
/// them.
std::vector<std::string> leave_out_lines(Views& views, const std::vector<LineOff>& off) {
  std::vector<std::string> remarks;
  for (const LineOff& line : off) {
    View& view = views.views[line.view];
    view.line.clear();
    remarks.push_back(
        fmt::format("The laser line of pose {} was left out: it lies {:.0f} mm off the light plane "
                    "of the other "
                    "poses. Does it cross the board, and did the board stand still?",
                    view.pose, to_mm(line.off_m)));
  }
  return remarks;
}

/// The whole calibration, of poses of which each is another.
Result<Calibrated> calibrate_places(Views& views) {
  if (const auto good = check_poses(views); !good) return tl::unexpected(good.error());
  auto first = calibrate_camera(views);
  if (!first) return tl::unexpected(first.error());
  auto& poses = first->camera_from_board;
  if (const auto good = check_spread(views, poses); !good) return tl::unexpected(good.error());
  const auto light = find_light_plane(views, first->camera, poses);
  if (!light) return tl::unexpected(light.error());
  const auto remarks = leave_out_lines(views, lines_off(*light, views, first->camera, poses));
  const auto axis = find_yaw_axis(views, poses);
  if (!axis) return tl::unexpected(axis.error());

  const Geometry start{
      .camera = first->camera, .light = *light, .axis = *axis, .camera_from_board = poses};
  auto fit = fit_jointly(views, start);
  if (!fit) return tl::unexpected(fit.error());
  Calibrated result;
  result.remarks = remarks;
  result.fit = std::move(*fit);
  result.fit.covariance = covariance_to_state(result.fit);
  result.calibration = calibration_of(result.fit.geometry);
  result.calibration.errors = errors_of(result.fit);
  sum_up(views, result);
  if (const auto good = check_result(result); !good) return tl::unexpected(good.error());
  return result;
}

}  // namespace

Result<Calibrated> calibrate(Views& views) {
  const auto repeats = join_repeats(views);
  auto result = calibrate_places(views);
  if (!result && !repeats.empty())
    return fail(result.error().fault, "{} ({} more poses show the board where another does)",
                result.error().message, repeats.size());
  if (result) result->remarks.insert(result->remarks.begin(), repeats.begin(), repeats.end());
  return result;
}

Result<Calibrated> calibrate_folder(const fs::path& folder, Views& views,
                                    const Progress& progress) {
  const auto shots = read_shots(folder);
  if (!shots) return tl::unexpected(shots.error());
  auto seen = measure_views(*shots, part_of(progress, 0.0, 0.5));
  if (!seen) return tl::unexpected(seen.error());
  views = std::move(*seen);
  auto result = calibrate(views);
  if (!result) return in_folder(folder, result);
  if (const auto good = add_latency(folder, *result, part_of(progress, 0.5, 0.8)); !good) {
    return tl::unexpected(good.error());
  }
  if (const auto good = add_couch(folder, *result, part_of(progress, 0.8, 1.0)); !good) {
    return tl::unexpected(good.error());
  }
  if (!result->latency && !result->couch) {
    result->remarks.emplace_back(
        "Whether left is left and the yaw has the right sign was not checked: boards do not show "
        "it, a sweep with its nominal calibration.toml does.");
  }
  if (progress) progress(1.0);
  return result;
}

}  // namespace tuina::calibration
