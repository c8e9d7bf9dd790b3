// SPDX-License-Identifier: Apache-2.0
#include "tuina/body/learn/shape_statistics.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "tuina/body/fit_shape.hpp"
#include "tuina/core/decompositions.hpp"
#include "tuina/core/units.hpp"

namespace tuina::body {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double coarse_m = 30_mm;  // standard deviation between two backs when only one is known
constexpr double coarse_length_m = 180_mm;
constexpr double fine_length_m = 70_mm;

/// Columns of a low-rank Gaussian process: smooth deformations with correlation length `length` and
/// standard deviation `amplitude` per axis, from evenly spread anchors.
MatrixXd smooth_modes(const Places& mean, double amplitude, double length, Index anchors) {
  std::vector<Index> chosen = {0};
  VectorXd far = (mean.colwise() - mean.col(0)).colwise().norm();
  while (static_cast<Index>(chosen.size()) < std::min(anchors, mean.cols())) {
    Index next = 0;
    far.maxCoeff(&next);
    chosen.push_back(next);
    far = far.cwiseMin((mean.colwise() - mean.col(next)).colwise().norm().transpose());
  }
  const auto count = static_cast<Index>(chosen.size());
  MatrixXd between(mean.cols(), count);
  for (Index j = 0; j < count; ++j) {
    between.col(j) =
        (mean.colwise() - mean.col(chosen[static_cast<std::size_t>(j)])).colwise().squaredNorm();
  }
  between = (-0.5 / (length * length) * between.array()).exp().matrix() * amplitude * amplitude;
  MatrixXd own(count, count);
  for (Index i = 0; i < count; ++i) own.row(i) = between.row(chosen[static_cast<std::size_t>(i)]);
  const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(own);
  std::vector<Index> kept;
  for (Index k = 0; k < count; ++k) {
    if (eigen.eigenvalues()[k] > 1e-4 * eigen.eigenvalues().maxCoeff()) kept.push_back(k);
  }
  MatrixXd modes = MatrixXd::Zero(3 * mean.cols(), 3 * static_cast<Index>(kept.size()));
  for (std::size_t k = 0; k < kept.size(); ++k) {
    const VectorXd mode =
        between * eigen.eigenvectors().col(kept[k]) / std::sqrt(eigen.eigenvalues()[kept[k]]);
    for (Index axis = 0; axis < 3; ++axis) {
      const auto column = 3 * static_cast<Index>(k) + axis;
      for (Index i = 0; i < mean.cols(); ++i) modes(3 * i + axis, column) = mode[i];
    }
  }
  return modes;
}

/// Mean pose of people who sit or lie.
Transform mean_pose(const std::vector<const Registered*>& backs, const Places& mean) {
  Matrix3 turn = Matrix3::Zero();
  Vector3 shift = Vector3::Zero();
  for (const Registered* back : backs) {
    const Transform person_from_model =
        back->couch_from_person.inverse() * align(mean, back->shape_in_couch);
    turn += person_from_model.linear();
    shift += person_from_model.translation() / static_cast<double>(backs.size());
  }
  Transform pose = Transform::Identity();
  pose.linear() = nearest_rotation(turn);
  pose.translation() = shift;
  return pose;
}

}  // namespace

Registered registered(const Template& standard, const Example& example,
                      const std::vector<std::string>& names) {
  // Labelled people who lie have their head where the couch frame says (docs/bodies.md).
  return {correspond(standard, example, names), couch_from_person(example.back).front()};
}

ShapeModel model_of(const std::vector<const Registered*>& backs, const Template& standard,
                    int persons, const StatisticsOptions& options) {
  const Index n = standard.skin.cols();
  ShapeModel model;
  model.mean = Places(3, n + standard.labels.cols());
  model.mean << standard.skin, standard.labels;
  std::vector<Places> aligned(backs.size());
  for (int round = 0; round < 4; ++round) {
    Places sum = Places::Zero(3, model.mean.cols());
    for (std::size_t i = 0; i < backs.size(); ++i) {
      aligned[i] = align(backs[i]->shape_in_couch, model.mean) * backs[i]->shape_in_couch;
      sum += aligned[i] / static_cast<double>(backs.size());
    }
    model.mean = sum;
  }
  // A prior weighs more for the covariance of backs than for their mean.
  MatrixXd known(3 * model.mean.cols(), 0);
  double share = 0.0;
  if (options.prior != nullptr) {
    share = options.prior_people / (options.prior_people + persons);
    const Transform model_from_prior = align(options.prior->mean, model.mean);
    const double of_mean =
        options.prior_people_for_mean / (options.prior_people_for_mean + persons);
    model.mean += of_mean * (model_from_prior * options.prior->mean - model.mean);
    known.resize(Eigen::NoChange, options.prior->modes.cols());
    for (Index k = 0; k < known.cols(); ++k) {
      const Eigen::Map<const Places> mode(options.prior->modes.col(k).data(), 3, model.mean.cols());
      Eigen::Map<Places>(known.col(k).data(), 3, model.mean.cols()) =
          std::sqrt(share) * (model_from_prior.linear() * mode);
    }
  }
  model.person_from_model = mean_pose(backs, model.mean);
  model.normals = align(standard.skin, model.mean.leftCols(n)).linear() * standard.normals;

  const MatrixXd coarse = smooth_modes(
      model.mean,
      coarse_m / std::sqrt(persons + (options.prior != nullptr ? options.prior_people : 0.0)),
      coarse_length_m, 40);
  const MatrixXd fine = smooth_modes(model.mean, options.smooth_m, fine_length_m, 70);
  const auto seen = static_cast<Index>(backs.size() > 1 ? backs.size() : 0);
  MatrixXd factor(3 * model.mean.cols(), seen + coarse.cols() + fine.cols() + known.cols());
  for (Index i = 0; i < seen; ++i) {
    const Places offset = aligned[static_cast<std::size_t>(i)] - model.mean;
    factor.col(i) = Eigen::Map<const VectorXd>(offset.data(), offset.size()) *
                    std::sqrt((1.0 - share) / static_cast<double>(seen));
  }
  factor.middleCols(seen, coarse.cols()) = coarse;
  factor.middleCols(seen + coarse.cols(), fine.cols()) = fine;
  factor.rightCols(known.cols()) = known;
  const MatrixXd gram = factor.transpose() * factor;
  const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(gram);
  const Index kept = std::min<Index>(options.modes, gram.cols());
  model.modes.resize(factor.rows(), kept);
  for (Index k = 0; k < kept; ++k) {
    // The sign of an eigenvector is arbitrary; its largest entry fixes it.
    VectorXd mode = factor * eigen.eigenvectors().col(gram.cols() - 1 - k);
    Index largest = 0;
    mode.cwiseAbs().maxCoeff(&largest);
    model.modes.col(k) = mode[largest] < 0.0 ? VectorXd(-mode) : mode;
  }
  model.bodies = persons;
  return model;
}

}  // namespace tuina::body
