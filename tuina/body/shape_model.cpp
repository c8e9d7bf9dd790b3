// SPDX-License-Identifier: Apache-2.0
#include "tuina/body/shape_model.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

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
constexpr std::array<Stage, 3> stages = {{{6, 3, 70_mm}, {8, 16, 40_mm}, {24, 1000, 25_mm}}};

// Tried around the outline: metres along the spine, and a turn in the plane of the back.
constexpr std::array<std::pair<double, double>, 7> starts = {{{0.0, 0.0},
                                                              {60_mm, 0.0},
                                                              {-60_mm, 0.0},
                                                              {120_mm, 0.0},
                                                              {-120_mm, 0.0},
                                                              {0.0, 12_deg},
                                                              {0.0, -12_deg}}};
constexpr Index coarse_stride = 6;
constexpr double unseen_m =
    15_mm;                         // a point that the scan does not answer counts as one so far off
constexpr double same_side = 0.5;  // cosine between the normals of a model point and its match

Places placed(const ShapeModel& model, const Eigen::VectorXd& weights, Index first, Index count) {
  Places places = model.mean.middleCols(first, count);
  const Eigen::VectorXd moved =
      model.modes.block(3 * first, 0, 3 * count, weights.size()) * weights;
  places += Eigen::Map<const Places>(moved.data(), 3, count);
  return places;
}

/// Where a fit stands, and what is needed to go on.
struct Descent {
  Transform couch_from_model;
  Eigen::VectorXd weights;
  Eigen::MatrixXd normal_matrix;
  std::vector<Vector3> match_normal;
  Eigen::VectorXd residual;
  Eigen::VectorXd trust;
  double cost = 0.0;  ///< of every looked-at point and of the modes, before the last step
};

/// One stage over every `stride`-th skin point.
void descend(const ShapeModel& model, const BackSurface& back, const Stage& stage, Index stride,
             double sigma_m, Descent& at) {
  const auto& scan = back.points();
  const double rim_m = 1.6 * back.spacing_m() + 3_mm;
  const Index n = model.skin_points();
  const Index modes = std::min<Index>(at.weights.size(), stage.modes);
  const Index unknowns = 6 + modes;
  const Index looked_at = (n + stride - 1) / stride;
  at.match_normal.resize(static_cast<std::size_t>(n));
  at.residual = Eigen::VectorXd::Zero(n);
  at.trust = Eigen::VectorXd::Zero(n);
  // Fewer points weigh more each, so that modes are held alike.
  const double information = static_cast<double>(stride) / (sigma_m * sigma_m);
  Eigen::MatrixXd rows(looked_at, unknowns);
  Eigen::VectorXd trusted(looked_at);
  Eigen::VectorXd off_by(looked_at);
  for (int round = 0; round < stage.rounds; ++round) {
    const Places skin = placed(model, at.weights, 0, n);
    const Matrix3 rotation = at.couch_from_model.linear();
    const Vector3 centre = at.couch_from_model * model.mean.leftCols(n).rowwise().mean().eval();
    at.cost = 0.5 * at.weights.squaredNorm();
    for (Index row = 0; row < looked_at; ++row) {
      const Index i = row * stride;
      const Vector3 x = at.couch_from_model * skin.col(i);
      const std::size_t j = back.closest(x);
      const Vector3& normal = scan.normals[j];
      const Vector3 off = scan.points[j] - x;
      const double along = normal.dot(off);
      const double across = std::sqrt(std::max(0.0, off.squaredNorm() - along * along));
      // Beyond the rim of the scan the nearest point lies sideways: nothing was seen there.
      const bool seen = std::abs(along) < stage.gate_m &&
                        across < std::max(rim_m, 0.4 * std::abs(along)) &&
                        normal.dot(rotation * model.normals.col(i)) > same_side;
      trusted[row] = seen ? 1.0 / (1.0 + std::pow(along / (0.4 * stage.gate_m), 2)) : 0.0;
      off_by[row] = along;
      const double missed = seen ? std::min(std::abs(along), unseen_m) : unseen_m;
      at.cost += 0.5 * information * missed * missed;
      at.match_normal[static_cast<std::size_t>(i)] = normal;
      at.residual[i] = along;
      at.trust[i] = trusted[row];
      rows.block<1, 3>(row, 0) = (x - centre).cross(normal).transpose();
      rows.block<1, 3>(row, 3) = normal.transpose();
      rows.block(row, 6, 1, modes).noalias() =
          (rotation.transpose() * normal).transpose() * model.modes.block(3 * i, 0, 3, modes);
    }
    const Eigen::MatrixXd weighted = trusted.asDiagonal() * rows;
    at.normal_matrix = information * (rows.transpose() * weighted);
    Eigen::VectorXd right_side = information * (weighted.transpose() * off_by);
    at.normal_matrix.diagonal().tail(modes).array() += 1.0;
    right_side.tail(modes) -= at.weights.head(modes);
    at.normal_matrix.diagonal().head(6).array() += 1e-3;
    const Eigen::VectorXd step = at.normal_matrix.ldlt().solve(right_side);
    const Vector3 turn = step.head<3>();
    Transform motion = Transform::Identity();
    motion.translate(centre + step.segment<3>(3));
    if (turn.norm() > 1e-12) motion.rotate(Eigen::AngleAxisd(turn.norm(), turn.normalized()));
    motion.translate(-centre);
    at.couch_from_model = motion * at.couch_from_model;
    at.weights.head(modes) += step.tail(modes);
    if (turn.norm() < 1e-6 && step.tail(unknowns - 3).norm() < 1e-5) break;
  }
}

/// The start that explains the scan best after a coarse descent. The outline can lie along the
/// spine or be turned by what the laser did not reach, so places around it are tried.
Transform best_start(const ShapeModel& model, const BackSurface& back,
                     const Transform& couch_from_model, Index modes, double sigma_m) {
  const Vector3 centre = model.mean.leftCols(model.skin_points()).rowwise().mean();
  Transform best = couch_from_model;
  double least = std::numeric_limits<double>::max();
  for (const auto& [along_m, turn_rad] : starts) {
    Transform shifted = couch_from_model;
    shifted.translate(centre + Vector3(0.0, 0.0, along_m));
    shifted.rotate(Eigen::AngleAxisd(turn_rad, Vector3::UnitY()));
    shifted.translate(-centre);
    Descent at{.couch_from_model = shifted, .weights = Eigen::VectorXd::Zero(modes)};
    descend(model, back, stages[0], coarse_stride, sigma_m, at);
    descend(model, back, {.rounds = 4, .modes = 10, .gate_m = 40_mm}, coarse_stride, sigma_m, at);
    if (at.cost < least) {
      least = at.cost;
      best = shifted;
    }
  }
  return best;
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

ShapeFit fit_shape(const ShapeModel& model, const BackSurface& back,
                   const Transform& couch_from_model, const FitOptions& options) {
  const Index n = model.skin_points();
  const Index all_modes = std::min<Index>(model.modes.cols(), options.modes);
  Descent at{
      .couch_from_model = best_start(model, back, couch_from_model, all_modes, options.sigma_m),
      .weights = Eigen::VectorXd::Zero(all_modes)};
  for (const Stage& stage : stages) descend(model, back, stage, 1, options.sigma_m, at);

  ShapeFit fit;
  fit.couch_from_model = at.couch_from_model;
  fit.weights = at.weights;
  const Places skin = placed(model, fit.weights, 0, n);
  fit.skin_in_couch.resize(3, n);
  double seen = 0.0;
  double squared = 0.0;
  for (Index i = 0; i < n; ++i) {
    const Vector3 x = fit.couch_from_model * skin.col(i);
    fit.skin_in_couch.col(i) = x;
    if (at.trust[i] <= 0.0) continue;
    fit.skin_in_couch.col(i) += at.residual[i] * at.match_normal[static_cast<std::size_t>(i)];
    seen += 1.0;
    squared += at.residual[i] * at.residual[i];
  }
  fit.seen = seen / static_cast<double>(n);
  fit.residual_m = std::sqrt(squared / std::max(1.0, seen));
  const Index labels = static_cast<Index>(model.labels.size());
  fit.labels_in_couch = fit.couch_from_model * placed(model, fit.weights, n, labels);

  const Eigen::LLT<Eigen::MatrixXd> factor(at.normal_matrix);
  fit.label_var_m2.resize(labels);
  for (Index l = 0; l < labels; ++l) {
    Eigen::MatrixXd sight(3, at.normal_matrix.cols());
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
