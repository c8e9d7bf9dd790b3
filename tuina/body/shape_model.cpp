// SPDX-License-Identifier: Apache-2.0
#include "tuina/body/shape_model.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "tuina/core/units.hpp"

namespace tuina::body {
namespace {

using Eigen::Index;

/// From far to near: how many modes may move, how far a point may be from its match.
struct Stage {
  int rounds;
  int modes;
  double gate_m;
};
constexpr std::array<Stage, 3> stages = {
    {{6, 3, 70_mm}, {8, 16, 40_mm}, {24, 1000, 25_mm}}};

constexpr double same_side = 0.5;  // cosine between the normals of a model point and its match

Places placed(const ShapeModel& model, const Eigen::VectorXd& weights, Index first, Index count) {
  Places places = model.mean.middleCols(first, count);
  const Eigen::VectorXd moved =
      model.modes.block(3 * first, 0, 3 * count, weights.size()) * weights;
  places += Eigen::Map<const Places>(moved.data(), 3, count);
  return places;
}

}  // namespace

Transform align(const Places& from, const Places& to) {
  Transform motion;
  motion.matrix() = Eigen::umeyama(from, to, false);
  return motion;
}

Eigen::VectorXd skin_features(const ShapeModel& model, const Places& skin_in_model) {
  const Index n = model.skin_points();
  const Places offset = skin_in_model - model.mean.leftCols(n);
  const Eigen::Map<const Eigen::VectorXd> stacked(offset.data(), 3 * n);
  Eigen::VectorXd features = model.modes.topRows(3 * n).transpose() * stacked;
  for (Index k = 0; k < features.size(); ++k) {
    features[k] /= std::max(1e-12, model.modes.col(k).head(3 * n).squaredNorm());
  }
  return features;
}

ShapeFit fit_shape(const ShapeModel& model, const BackSurface& back, const Transform& couch_from_model,
                   const FitOptions& options) {
  const Index n = model.skin_points();
  const Index all_modes = std::min<Index>(model.modes.cols(), options.modes);
  const auto& scan = back.points();
  const double rim_m = 1.6 * back.spacing_m() + 3_mm;
  ShapeFit fit;
  fit.couch_from_model = couch_from_model;
  fit.weights = Eigen::VectorXd::Zero(all_modes);

  Eigen::MatrixXd normal_matrix;
  Places skin;
  std::vector<Vector3> match_normal(static_cast<std::size_t>(n));
  Eigen::VectorXd residual(n);
  Eigen::VectorXd trust(n);
  for (const Stage& stage : stages) {
    const Index modes = std::min<Index>(all_modes, stage.modes);
    const Index unknowns = 6 + modes;
    for (int round = 0; round < stage.rounds; ++round) {
      skin = placed(model, fit.weights, 0, n);
      const Matrix3 rotation = fit.couch_from_model.linear();
      const Vector3 centre = fit.couch_from_model * model.mean.leftCols(n).rowwise().mean().eval();
      Eigen::MatrixXd rows(n, unknowns);
      for (Index i = 0; i < n; ++i) {
        const Vector3 x = fit.couch_from_model * skin.col(i);
        const std::size_t j = back.closest(x);
        const Vector3& normal = scan.normals[j];
        const Vector3 off = scan.points[j] - x;
        const double along = normal.dot(off);
        const double across = std::sqrt(std::max(0.0, off.squaredNorm() - along * along));
        match_normal[static_cast<std::size_t>(i)] = normal;
        residual[i] = along;
        // Beyond the rim of the scan the nearest point lies sideways: nothing was seen there.
        const bool seen = std::abs(along) < stage.gate_m && across < std::max(rim_m, 0.4 * std::abs(along)) &&
                          normal.dot(rotation * model.normals.col(i)) > same_side;
        const double robust = 1.0 / (1.0 + std::pow(along / (0.4 * stage.gate_m), 2));
        trust[i] = seen ? robust : 0.0;
        const Vector3 normal_in_model = rotation.transpose() * normal;
        rows.block<1, 3>(i, 0) = (x - centre).cross(normal).transpose();
        rows.block<1, 3>(i, 3) = normal.transpose();
        rows.block(i, 6, 1, modes).noalias() =
            normal_in_model.transpose() * model.modes.block(3 * i, 0, 3, modes);
      }
      const double information = 1.0 / (options.sigma_m * options.sigma_m);
      const Eigen::MatrixXd weighted = trust.asDiagonal() * rows;
      normal_matrix = information * (rows.transpose() * weighted);
      Eigen::VectorXd right_side = information * (weighted.transpose() * residual);
      normal_matrix.diagonal().tail(modes).array() += 1.0;
      right_side.tail(modes) -= fit.weights.head(modes);
      normal_matrix.diagonal().head(6).array() += 1e-3;
      const Eigen::VectorXd step = normal_matrix.ldlt().solve(right_side);
      const Vector3 turn = step.head<3>();
      Transform motion = Transform::Identity();
      motion.translate(centre + step.segment<3>(3));
      if (turn.norm() > 1e-12) motion.rotate(Eigen::AngleAxisd(turn.norm(), turn.normalized()));
      motion.translate(-centre);
      fit.couch_from_model = motion * fit.couch_from_model;
      fit.weights.head(modes) += step.tail(modes);
      if (turn.norm() < 1e-6 && step.tail(unknowns - 3).norm() < 1e-5) break;
    }
  }

  skin = placed(model, fit.weights, 0, n);
  fit.skin_in_couch.resize(3, n);
  double seen = 0.0;
  double squared = 0.0;
  for (Index i = 0; i < n; ++i) {
    const Vector3 x = fit.couch_from_model * skin.col(i);
    fit.skin_in_couch.col(i) = x;
    if (trust[i] <= 0.0) continue;
    fit.skin_in_couch.col(i) += residual[i] * match_normal[static_cast<std::size_t>(i)];
    seen += 1.0;
    squared += residual[i] * residual[i];
  }
  fit.seen = seen / static_cast<double>(n);
  fit.residual_m = std::sqrt(squared / std::max(1.0, seen));
  const Index labels = static_cast<Index>(model.labels.size());
  fit.labels_in_couch = fit.couch_from_model * placed(model, fit.weights, n, labels);

  const Eigen::LLT<Eigen::MatrixXd> factor(normal_matrix);
  fit.label_var_m2.resize(labels);
  for (Index l = 0; l < labels; ++l) {
    Eigen::MatrixXd sight(3, normal_matrix.cols());
    const Vector3 centre = fit.couch_from_model * model.mean.leftCols(n).rowwise().mean().eval();
    const Vector3 arm = fit.labels_in_couch.col(l) - centre;
    sight.leftCols<3>() << 0, arm.z(), -arm.y(), -arm.z(), 0, arm.x(), arm.y(), -arm.x(), 0;
    sight.middleCols<3>(3) = Matrix3::Identity();
    sight.rightCols(all_modes) =
        fit.couch_from_model.linear() * model.modes.block(3 * (n + l), 0, 3, all_modes);
    fit.label_var_m2[l] = (sight * factor.solve(sight.transpose())).trace() / 3.0;
  }
  return fit;
}

}  // namespace tuina::body
