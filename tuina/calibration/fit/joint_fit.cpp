// SPDX-License-Identifier: Apache-2.0
#include "tuina/calibration/fit/joint_fit.hpp"

#include <ceres/ceres.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>

#include "tuina/calibration/fit/joint_residuals.hpp"
#include "tuina/calibration/fit/pose_covariance.hpp"
#include "tuina/calibration/fit/residual_statistics.hpp"
#include "tuina/core/units.hpp"
#include "tuina/scanner/triangulation.hpp"

namespace tuina::calibration {
namespace {

// The AX-12A rounds to counts of 0.293 degrees (0.085 RMS) and has a little play.
constexpr double yaw_deviation_rad = 0.1_deg;
// Floor for speckle and uneven paper, which the image noise does not include.
constexpr double min_line_px = 0.1;
constexpr double robust_from = 2.5;  // standard deviations
constexpr double left_out_from = 4.0;

// The least-squares problem. Solved with a robust loss to estimate error sizes and outliers, then
// without.
class Problem {
 public:
  Problem(const Views& views, const Geometry& start) : views_(views), start_(start) {
    const auto& camera = start.camera;
    camera_ = {camera.fx_px,         camera.fy_px,         camera.cx_px,
               camera.cy_px,         camera.distortion[0], camera.distortion[1],
               camera.distortion[2], camera.distortion[3]};
    const Vector3 light = start.light.normal / start.light.distance_m;
    light_ = {light.x(), light.y(), light.z()};
    aside_1_ = start.axis.direction_in_camera.unitOrthogonal();
    aside_2_ = start.axis.direction_in_camera.cross(aside_1_);
    std::map<int, std::size_t> first;
    for (std::size_t i = 0; i < views.views.size(); ++i) {
      const std::size_t reference = first.emplace(views.views[i].pose, i).first->second;
      reference_.push_back(reference);
      standing_.push_back(reference != i);
      if (reference != i) standing_[reference] = true;
      yaw_.push_back(views.views[i].yaw_rad);
      const Eigen::AngleAxisd turn(start.camera_from_board[i].linear());
      const Vector3 rotation = turn.angle() * turn.axis();
      const Vector3 place = start.camera_from_board[i].translation();
      pose_.push_back({rotation.x(), rotation.y(), rotation.z(), place.x(), place.y(), place.z()});
      corner_good_.emplace_back(views.views[i].corners_px.size(), true);
      const Geometry now = geometry();
      line_.push_back(line_on_board(views.views[i], views.board, now.camera, pose_of(i)));
      if (line_.back().size() < min_line_points) line_.back().clear();
      view_factor_.push_back(line_factor_);
    }
  }

  [[nodiscard]] bool solve(bool robust) {
    ceres::Problem problem;
    build(problem, robust);
    ceres::Solver::Options options;
    options.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
    // The BLAS of the other sparse solvers sums in an order that depends on memory addresses.
    options.sparse_linear_algebra_library_type = ceres::EIGEN_SPARSE;
    options.max_num_iterations = 50;
    options.function_tolerance = robust ? 1e-5 : 1e-9;
    options.num_threads = 1;
    options.logging_type = ceres::SILENT;
    ceres::Solver::Summary summary;
    ceres::Solve(options, &problem, &summary);
    return summary.IsSolutionUsable();
  }

  // Estimates error sizes and marks outliers.
  void estimate_errors() {
    std::vector<double> corner_sizes;
    std::vector<double> line_sizes;
    std::vector<std::vector<double>> line_errors;  // in units of the assumed noise, by view
    for (std::size_t i = 0; i < views_.views.size(); ++i) {
      for (const Vector2& error : corner_errors(i)) {
        corner_sizes.push_back(std::abs(error.x()));
        corner_sizes.push_back(std::abs(error.y()));
      }
      auto& errors = line_errors.emplace_back();
      for (std::size_t k = 0; k < line_[i].size(); ++k) {
        errors.push_back(line_error(i, k) / believed_deviation(line_[i][k]));
        line_sizes.push_back(std::abs(errors.back()));
      }
    }
    const double freedom = 1.0 + 3.0 * static_cast<double>(views_.views.size()) /
                                     static_cast<double>(corner_sizes.size());
    corner_px_ = std::max(1e-3, freedom * robust_deviation(corner_sizes));
    // Errors on print have long tails; the inliers enter squared.
    line_factor_ =
        std::max(0.2, deviation_without(line_sizes, left_out_from * robust_deviation(line_sizes)));
    alike_rows_ = rows_alike(line_errors, left_out_from * line_factor_);
    for (std::size_t i = 0; i < line_errors.size(); ++i) {
      for (double& error : line_errors[i]) error = std::abs(error);
      view_factor_[i] = std::max(line_factor_, robust_deviation(line_errors[i]));
    }
    for (std::size_t i = 0; i < views_.views.size(); ++i) {
      const auto errors = corner_errors(i);
      for (std::size_t k = 0; k < errors.size(); ++k) {
        corner_good_[i][k] = errors[k].norm() < left_out_from * 1.5 * corner_px_;
      }
      Line kept;
      for (std::size_t k = 0; k < line_[i].size(); ++k) {
        const double allowed = left_out_from * view_factor_[i] * believed_deviation(line_[i][k]);
        if (std::abs(line_error(i, k)) < allowed) kept.push_back(line_[i][k]);
      }
      line_[i] = std::move(kept);
    }
  }

  // Covariance of camera, light and axis, with poses and angles unknown.
  [[nodiscard]] std::optional<PoseCovariance> covariance() {
    ceres::Problem problem;
    build(problem, false);
    ceres::Problem::EvaluateOptions options;
    // Fixed order of blocks: that of Ceres goes by address and differs between runs, and with it
    // the last digits of every sum.
    options.parameter_blocks = {camera_.data(), light_.data(), axis_.data()};
    const auto add = [&](double* block) {
      if (problem.HasParameterBlock(block)) options.parameter_blocks.push_back(block);
    };
    for (auto& pose : pose_) add(pose.data());
    for (double& yaw : yaw_) add(&yaw);
    std::vector<double> residuals;
    ceres::CRSMatrix jacobian;
    problem.Evaluate(options, nullptr, &residuals, nullptr, &jacobian);
    std::vector<FitRow> rows(residuals.size());
    for (std::size_t i = 0; i < rows.size(); ++i) {
      rows[i] = {.pose = pose_of_row_[i], .residual = residuals[i], .slopes = {}};
      for (int k = jacobian.rows[i]; k < jacobian.rows[i + 1]; ++k) {
        const auto at = static_cast<std::size_t>(k);
        rows[i].slopes.emplace_back(jacobian.cols[at], jacobian.values[at]);
      }
    }
    return pose_covariance(rows, parameters);
  }

  [[nodiscard]] Geometry geometry() const {
    Geometry result = start_;
    auto& camera = result.camera;
    camera.fx_px = camera_[0];
    camera.fy_px = camera_[1];
    camera.cx_px = camera_[2];
    camera.cy_px = camera_[3];
    camera.distortion = {camera_[4], camera_[5], camera_[6], camera_[7], 0.0};
    const Vector3 light(light_[0], light_[1], light_[2]);
    result.light = {.normal = light.normalized(), .distance_m = 1.0 / light.norm()};
    // The normal keeps the sign of the start: along the columns.
    if (start_.light.distance_m < 0.0) {
      result.light = {.normal = -result.light.normal, .distance_m = -result.light.distance_m};
    }
    result.axis.direction_in_camera =
        (start_.axis.direction_in_camera + axis_[0] * aside_1_ + axis_[1] * aside_2_).normalized();
    result.axis.point_in_camera =
        start_.axis.point_in_camera + axis_[2] * aside_1_ + axis_[3] * aside_2_;
    for (std::size_t i = 0; i < pose_.size(); ++i) result.camera_from_board[i] = pose_of(i);
    return result;
  }

  [[nodiscard]] JointFit result() {
    JointFit fit{.geometry = geometry(), .corner_px = corner_px_, .line_factor = line_factor_};
    for (std::size_t i = 0; i < views_.views.size(); ++i) {
      ViewResidual residual{.line_points = static_cast<int>(line_[i].size())};
      double sum2 = 0.0;
      const auto errors = corner_errors(i);
      for (const Vector2& error : errors) sum2 += error.squaredNorm();
      residual.reprojection_px = std::sqrt(sum2 / static_cast<double>(errors.size()));
      double line2 = 0.0;
      double share2 = 0.0;
      double distance2 = 0.0;
      for (std::size_t k = 0; k < line_[i].size(); ++k) {
        const double error_px = line_error(i, k);
        const double error_m =
            error_px * line_scale(i, k) * std::abs(fit.geometry.light.distance_m);
        line2 += error_px * error_px;
        share2 += std::pow(error_px / believed_deviation(line_[i][k]), 2);
        distance2 += error_m * error_m;
      }
      if (!line_[i].empty()) {
        const auto count = static_cast<double>(line_[i].size());
        residual.line_px = std::sqrt(line2 / count);
        residual.line_share = std::sqrt(share2 / count);
        residual.line_m = std::sqrt(distance2 / count);
      }
      fit.residuals.push_back(residual);
    }
    return fit;
  }

 private:
  using Line = std::vector<LineOnBoard>;

  static double believed_deviation(const LineOnBoard& point) {
    return std::hypot(point.deviation_px, min_line_px);
  }

  [[nodiscard]] Vector3 corner(std::size_t i, std::size_t k) const {
    return corner_on(views_.board, views_.views[i].corner(k));
  }

  // Pose of a view's board, from the standing pose and the turn of the unit.
  [[nodiscard]] Transform pose_of(std::size_t i) const {
    const auto& pose = pose_[reference_[i]];
    const Vector3 rotation(pose[0], pose[1], pose[2]);
    Transform camera_from_board = Transform::Identity();
    if (rotation.norm() > 0.0) {
      camera_from_board.linear() =
          Eigen::AngleAxisd(rotation.norm(), rotation.normalized()).toRotationMatrix();
    }
    camera_from_board.translation() = Vector3(pose[3], pose[4], pose[5]);
    if (reference_[i] == i) return camera_from_board;
    const Vector3 along =
        (start_.axis.direction_in_camera + axis_[0] * aside_1_ + axis_[1] * aside_2_).normalized();
    const Vector3 on_axis = start_.axis.point_in_camera + axis_[2] * aside_1_ + axis_[3] * aside_2_;
    Transform back = Transform::Identity();
    back.linear() = Eigen::AngleAxisd(yaw_[reference_[i]] - yaw_[i], along).toRotationMatrix();
    back.translation() = on_axis - back.linear() * on_axis;
    return back * camera_from_board;
  }

  [[nodiscard]] std::vector<Vector2> corner_errors(std::size_t i) const {
    const auto camera = geometry().camera;
    const Transform camera_from_board = pose_of(i);
    std::vector<Vector2> errors;
    for (std::size_t k = 0; k < views_.views[i].corners_px.size(); ++k) {
      errors.emplace_back(scanner::project(camera, camera_from_board * corner(i, k)) -
                          views_.views[i].corners_px[k]);
    }
    return errors;
  }

  [[nodiscard]] double light_at(const Transform& camera_from_board, double column_px,
                                double row_px) const {
    return light_value(camera_.data(), light_.data(), camera_from_board, column_px, row_px);
  }
  // Derivative of light_value per pixel across the line.
  [[nodiscard]] double line_scale(std::size_t i, std::size_t k) const {
    const LineOnBoard& point = line_[i][k];
    const Transform pose = pose_of(i);
    return 0.5 * (light_at(pose, point.column_px + 1.0, point.row_px) -
                  light_at(pose, point.column_px - 1.0, point.row_px));
  }
  [[nodiscard]] double line_error(std::size_t i, std::size_t k) const {
    const LineOnBoard& point = line_[i][k];
    return (light_at(pose_of(i), point.column_px, point.row_px) - 1.0) / line_scale(i, k);
  }

  void build(ceres::Problem& problem, bool robust) {
    const auto loss = [robust]() -> ceres::LossFunction* {
      return robust ? new ceres::HuberLoss(robust_from) : nullptr;
    };
    pose_of_row_.assign(usual_lens_size, -1);
    problem.AddResidualBlock(near_usual_lens(), nullptr, camera_.data());
    for (std::size_t i = 0; i < views_.views.size(); ++i) {
      add_corners(problem, i, loss);
      if (reference_[i] == i) add_line(problem, i, loss);
      if (standing_[i]) {
        problem.AddResidualBlock(near_value(views_.views[i].yaw_rad, yaw_deviation_rad), nullptr,
                                 &yaw_[i]);
        pose_of_row_.push_back(views_.views[i].pose);
      }
    }
  }

  template <typename Loss>
  void add_corners(ceres::Problem& problem, std::size_t i, const Loss& loss) {
    const auto& corners = views_.views[i].corners_px;
    const std::size_t reference = reference_[i];
    for (std::size_t k = 0; k < corners.size(); ++k) {
      if (!corner_good_[i][k]) continue;
      pose_of_row_.insert(pose_of_row_.end(), 2, views_.views[i].pose);
      const SeenCorner seen{.seen_px = corners[k], .at = corner(i, k), .deviation_px = corner_px_};
      if (reference == i) {
        problem.AddResidualBlock(corner_of_board(seen), loss(), camera_.data(), pose_[i].data());
        continue;
      }
      const FirstAxis axis{.direction = start_.axis.direction_in_camera,
                           .point = start_.axis.point_in_camera,
                           .aside_1 = aside_1_,
                           .aside_2 = aside_2_};
      problem.AddResidualBlock(corner_of_standing_board(seen, axis), loss(), camera_.data(),
                               pose_[reference].data(), axis_.data(), &yaw_[reference], &yaw_[i]);
    }
  }

  template <typename Loss>
  void add_line(ceres::Problem& problem, std::size_t i, const Loss& loss) {
    for (std::size_t k = 0; k < line_[i].size(); ++k) {
      const LineOnBoard& point = line_[i][k];
      auto* cost = point_of_line(
          {.column_px = point.column_px,
           .row_px = point.row_px,
           .per_px = line_scale(i, k),
           .deviation_px = std::sqrt(alike_rows_) * view_factor_[i] * believed_deviation(point)});
      problem.AddResidualBlock(cost, loss(), camera_.data(), pose_[i].data(), light_.data());
      pose_of_row_.push_back(views_.views[i].pose);
    }
  }

  const Views& views_;
  const Geometry& start_;
  Vector3 aside_1_, aside_2_;
  std::array<double, camera_size> camera_{};
  std::array<double, light_size> light_{};
  std::array<double, axis_size> axis_{};
  std::vector<std::array<double, 6>> pose_;
  std::vector<double> yaw_;
  std::vector<std::size_t> reference_;  ///< first view of the same pose
  std::vector<bool> standing_;          ///< true when the pose is seen at several yaws
  std::vector<std::vector<bool>> corner_good_;
  std::vector<Line> line_;
  double corner_px_ = 0.1;
  double line_factor_ = 2.0;
  double alike_rows_ = 1.0;
  std::vector<int> pose_of_row_;     ///< pose of each residual of the last problem
  std::vector<double> view_factor_;  ///< line_factor_, or more for a worse line
};

}  // namespace

Result<JointFit> fit_jointly(const Views& views, const Geometry& start) {
  Problem problem(views, start);
  const auto undetermined = [] {
    return fail(Fault::bad_input,
                "these pictures do not determine camera, light plane and axis: hold the board at "
                "more distances and tilts");
  };
  if (!problem.solve(true)) return undetermined();
  problem.estimate_errors();
  if (!problem.solve(false)) return undetermined();
  problem.estimate_errors();
  if (!problem.solve(false)) return undetermined();
  const auto covariance = problem.covariance();
  if (!covariance) return undetermined();
  JointFit fit = problem.result();
  fit.covariance = covariance->of_rows;
  fit.covariance_of_poses = covariance->of_poses;
  return fit;
}

}  // namespace tuina::calibration
