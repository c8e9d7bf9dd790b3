// SPDX-License-Identifier: Apache-2.0
#include "tuina/body/fit_shape.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "tuina/core/decompositions.hpp"
#include "tuina/core/units.hpp"

namespace tuina::body {
namespace {

using Eigen::Index;

/// A stage of the fit: number of free modes, largest match distance, and stride over the skin
/// points.
struct Stage {
  int rounds;
  int modes;
  double gate_m;
  Index stride;
};
constexpr std::array<Stage, 2> glance = {{{6, 3, 70_mm, 6}, {4, 10, 40_mm, 6}}};
constexpr std::array<Stage, 2> full_fit = {{{6, 16, 40_mm, 3}, {10, 1000, 25_mm, 3}}};
constexpr Stage stare = {14, 1000, 25_mm, 1};
constexpr std::size_t finalists = 3;

// Start poses: shift along the spine (m) and rotation in the plane of the back.
constexpr std::array<std::pair<double, double>, 7> starts = {{{0.0, 0.0},
                                                              {60_mm, 0.0},
                                                              {-60_mm, 0.0},
                                                              {120_mm, 0.0},
                                                              {-120_mm, 0.0},
                                                              {0.0, 15_deg},
                                                              {0.0, -15_deg}}};
// Assumed residuals of points without a match: where the scan shows something else, and beyond its
// rim, where it says nothing. As much for both let a model too small, which lies within a cropped
// scan, win over the right one, which reaches beyond it.
constexpr double contradicted_m = 15_mm;
constexpr double unseen_m = 6_mm;
constexpr double same_side = 0.5;  // cosine between the normals of a model point and its match
// Weight of the residual against the mode weights when solutions are compared: neighbouring points
// have correlated errors, modes are independent. Bent modes explain a scan from the wrong place
// almost as well as usual ones from the right place.
constexpr double residual_weight = 1.0 / 6.0;
constexpr double doubt_margin = 8.0;  // cost difference within which a rival may be the truth
// Searches that come this near have converged to one solution.
constexpr double same_place_m = 10_mm;

/// State of an iterative fit.
struct Descent {
  Transform couch_from_model;
  Eigen::VectorXd weights;
  Eigen::MatrixXd normal_matrix;
  std::vector<Vector3> match_normal;
  Eigen::VectorXd residual;
  Eigen::VectorXd trust;
  /// Sum of squared residuals of the sampled points, before the last step.
  double residual_sum = 0.0;
  /// Cost; less is better.
  [[nodiscard]] double cost() const {
    return residual_weight * residual_sum + 0.5 * weights.squaredNorm();
  }
};

void descend(const ShapeModel& model, const BackSurface& back, const Stage& stage, double sigma_m,
             Descent& at) {
  const auto& scan = back.points();
  const double rim_m = 1.6 * back.spacing_m() + 3_mm;
  const Index n = model.skin_points();
  const Index modes = std::min<Index>(at.weights.size(), stage.modes);
  const Index unknowns = 6 + modes;
  const Index stride = stage.stride;
  const Index looked_at = (n + stride - 1) / stride;
  at.match_normal.resize(static_cast<std::size_t>(n));
  at.residual = Eigen::VectorXd::Zero(n);
  at.trust = Eigen::VectorXd::Zero(n);
  // Fewer points get more weight each, so that modes are regularised alike.
  const double information = static_cast<double>(stride) / (sigma_m * sigma_m);
  Eigen::MatrixXd rows(looked_at, unknowns);
  Eigen::VectorXd trusted(looked_at);
  Eigen::VectorXd off_by(looked_at);
  for (int round = 0; round < stage.rounds; ++round) {
    const Places skin = placed(model, at.weights, 0, n);
    const Matrix3 rotation = at.couch_from_model.linear();
    const Vector3 centre = at.couch_from_model * model.mean.leftCols(n).rowwise().mean().eval();
    at.residual_sum = 0.0;
    for (Index row = 0; row < looked_at; ++row) {
      const Index i = row * stride;
      const Vector3 x = at.couch_from_model * skin.col(i);
      const std::size_t j = back.closest(x);
      const Vector3& normal = scan.normals[j];
      const Vector3 off = scan.points[j] - x;
      const double along = normal.dot(off);
      const double across = std::sqrt(std::max(0.0, off.squaredNorm() - along * along));
      // Beyond the rim of the scan the nearest point lies sideways: the point is not covered.
      const bool beyond = across >= std::max(rim_m, 0.4 * std::abs(along));
      const bool seen = !beyond && std::abs(along) < stage.gate_m &&
                        normal.dot(rotation * model.normals.col(i)) > same_side;
      trusted[row] = seen ? 1.0 / (1.0 + std::pow(along / (0.4 * stage.gate_m), 2)) : 0.0;
      off_by[row] = along;
      const double missed = seen     ? std::min(std::abs(along), contradicted_m)
                            : beyond ? unseen_m
                                     : contradicted_m;
      at.residual_sum += 0.5 * information * missed * missed;
      at.match_normal[static_cast<std::size_t>(i)] = normal;
      at.residual[i] = along;
      at.trust[i] = trusted[row];
      rows.block<1, 3>(row, 0) = (x - centre).cross(normal).transpose();
      rows.block<1, 3>(row, 3) = normal.transpose();
      rows.block(row, 6, 1, modes).noalias() =
          (rotation.transpose() * normal).transpose() * model.modes.block(3 * i, 0, 3, modes);
    }
    const Eigen::VectorXd root = trusted.cwiseSqrt();
    const Eigen::MatrixXd weighted = root.asDiagonal() * rows;
    at.normal_matrix.setZero(unknowns, unknowns);
    at.normal_matrix.selfadjointView<Eigen::Lower>().rankUpdate(weighted.transpose(), information);
    at.normal_matrix = at.normal_matrix.selfadjointView<Eigen::Lower>();
    Eigen::VectorXd right_side = information * (weighted.transpose() * root.cwiseProduct(off_by));
    at.normal_matrix.diagonal().tail(modes).array() += 1.0;
    right_side.tail(modes) -= at.weights.head(modes);
    at.normal_matrix.diagonal().head(6).array() += 1e-3;
    const Eigen::VectorXd step = solve_symmetric(at.normal_matrix, right_side);
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

/// Short fits from every start, sorted by cost; converged duplicates are dropped.
std::vector<Descent> short_fits(const ShapeModel& model, const BackSurface& back, Index modes,
                                double sigma_m) {
  const Vector3 centre = model.mean.leftCols(model.skin_points()).rowwise().mean();
  std::vector<Descent> found;
  for (const Transform& person : couch_from_person(back)) {
    for (const auto& [along_m, turn_rad] : starts) {
      Transform begin = person * model.person_from_model;
      begin.translate(centre + Vector3(0.0, 0.0, along_m));
      begin.rotate(Eigen::AngleAxisd(turn_rad, Vector3::UnitY()));
      begin.translate(-centre);
      found.push_back({.couch_from_model = begin, .weights = Eigen::VectorXd::Zero(modes)});
      for (const Stage& stage : glance) descend(model, back, stage, sigma_m, found.back());
    }
  }
  std::stable_sort(found.begin(), found.end(),
                   [](const Descent& a, const Descent& b) { return a.cost() < b.cost(); });
  const Vector3 head = centre + Vector3(0.0, 0.0, 0.3);
  std::vector<Descent> kept;
  for (Descent& next : found) {
    const bool met = std::any_of(kept.begin(), kept.end(), [&](const Descent& other) {
      return (next.couch_from_model * centre - other.couch_from_model * centre).norm() <
                 same_place_m &&
             (next.couch_from_model * head - other.couch_from_model * head).norm() < same_place_m;
    });
    if (!met && kept.size() < finalists) kept.push_back(std::move(next));
  }
  return kept;
}

/// Result of a fit, with the skin projected onto the scan and the variance of each label.
ShapeFit answer_of(const ShapeModel& model, const Descent& at) {
  const Index n = model.skin_points();
  const Index all_modes = at.weights.size();
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
  fit.coverage = seen / static_cast<double>(n);
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

}  // namespace

std::vector<Transform> couch_from_person(const BackSurface& back) {
  Vector3 middle = Vector3::Zero();
  const auto& points = back.points().points;
  for (const Vector3& p : points) middle += p / static_cast<double>(points.size());
  Transform usual = Transform::Identity();
  usual.translate(Vector3(middle.x(), middle.y(), 0.0));
  usual.rotate(Eigen::AngleAxisd(heading(back.points(), back.position()), Vector3::UnitZ()));
  if (back.position() == BodyPosture::sitting) return {usual};
  Transform other = usual;
  other.rotate(Eigen::AngleAxisd(pi, Vector3::UnitZ()));
  return {usual, other};
}

ShapeFit fit_shape(const ShapeModel& model, const BackSurface& back, const FitOptions& options) {
  const Index modes = std::min<Index>(model.modes.cols(), options.modes);
  std::vector<Descent> few;
  if (options.begin) {
    few.push_back({.couch_from_model = *options.begin, .weights = Eigen::VectorXd::Zero(modes)});
  } else {
    few = short_fits(model, back, modes, options.sigma_m);
  }
  for (Descent& at : few) {
    for (const Stage& stage : full_fit) descend(model, back, stage, options.sigma_m, at);
  }
  std::stable_sort(few.begin(), few.end(),
                   [](const Descent& a, const Descent& b) { return a.cost() < b.cost(); });
  const double cost = few.front().cost();
  descend(model, back, stare, options.sigma_m, few.front());
  ShapeFit fit = answer_of(model, few.front());
  const Index labels = fit.labels_in_couch.cols();
  fit.label_doubt_m = Eigen::VectorXd::Zero(labels);
  for (std::size_t i = 1; i < few.size() && few[i].cost() < cost + doubt_margin; ++i) {
    const Places rival =
        few[i].couch_from_model * placed(model, few[i].weights, model.skin_points(), labels);
    const Eigen::VectorXd apart = (rival - fit.labels_in_couch).colwise().norm().transpose();
    fit.label_doubt_m = fit.label_doubt_m.cwiseMax(apart);
  }
  return fit;
}

}  // namespace tuina::body
