// SPDX-License-Identifier: Apache-2.0
#include "tuina/body/learn/shape_statistics.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>

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
constexpr Index block_columns = 64;

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
Result<Transform> mean_pose(const Backs& backs, const Places& mean) {
  Matrix3 turn = Matrix3::Zero();
  Vector3 shift = Vector3::Zero();
  auto seen = backs.visit([&](const Registered& back) {
    const Transform person_from_model =
        back.couch_from_person.inverse() * align(mean, back.shape_in_couch);
    turn += person_from_model.linear();
    shift += person_from_model.translation() / static_cast<double>(backs.count);
  });
  if (!seen) return tl::unexpected(seen.error());
  Transform pose = Transform::Identity();
  pose.linear() = nearest_rotation(turn);
  pose.translation() = shift;
  return pose;
}

/// Brings every back onto the mean of the others, in rounds. `onto` is what they were last brought
/// onto.
Result<Places> mean_shape(const Backs& backs, const Places& standard, Places& onto) {
  Places mean = standard;
  for (int round = 0; round < 4; ++round) {
    onto = mean;
    Places sum = Places::Zero(3, mean.cols());
    auto seen = backs.visit([&](const Registered& back) {
      const Places aligned = align(back.shape_in_couch, onto) * back.shape_in_couch;
      sum += aligned / static_cast<double>(backs.count);
    });
    if (!seen) return tl::unexpected(seen.error());
    mean = sum;
  }
  return mean;
}

/// Calls `each` with the deviation of every back from the mean.
Result<void> visit_deviations(const Backs& backs, const Places& onto, const Places& mean,
                              const std::function<void(const VectorXd&)>& each) {
  return backs.visit([&](const Registered& back) {
    const Places offset = align(back.shape_in_couch, onto) * back.shape_in_couch - mean;
    each(Eigen::Map<const VectorXd>(offset.data(), offset.size()));
  });
}

/// The sign of an eigenvector is arbitrary; its largest entry fixes it.
VectorXd signed_by_largest(VectorXd mode) {
  Index largest = 0;
  mode.cwiseAbs().maxCoeff(&largest);
  if (mode[largest] < 0.0) mode = -mode;
  return mode;
}

/// Deviations of unit variance, a column each.
MatrixXd modes_of_products(const MatrixXd& factor, Index count) {
  const MatrixXd gram = factor.transpose() * factor;
  const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(gram);
  const Index kept = std::min<Index>(count, gram.cols());
  MatrixXd modes(factor.rows(), kept);
  for (Index k = 0; k < kept; ++k)
    modes.col(k) = signed_by_largest(factor * eigen.eigenvectors().col(gram.cols() - 1 - k));
  return modes;
}

/// The strongest modes of a covariance, of which the lower half is given, by iteration of a
/// subspace: the whole decomposition of some thousand rows takes minutes.
MatrixXd modes_of_sum(const MatrixXd& covariance, const MatrixXd& begin, Index count) {
  constexpr int max_rounds = 200;
  constexpr double enough = 1e-12;  // of the largest variance: what a mode is off in a round
  const Index width = std::min<Index>(2 * count + 40, begin.cols());
  const auto orthonormal = [&](const MatrixXd& columns) {
    return MatrixXd(Eigen::HouseholderQR<MatrixXd>(columns).householderQ() *
                    MatrixXd::Identity(columns.rows(), columns.cols()));
  };
  // What is assumed of backs is smooth and of full rank; so are their strongest modes.
  MatrixXd basis = orthonormal(begin.leftCols(width));
  const Index kept = std::min(count, width);
  MatrixXd modes(covariance.rows(), kept);
  for (int round = 0; round < max_rounds; ++round) {
    MatrixXd image = covariance.selfadjointView<Eigen::Lower>() * basis;
    const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(basis.transpose() * image);
    const VectorXd variances = eigen.eigenvalues().tail(kept);
    const MatrixXd unit = basis * eigen.eigenvectors().rightCols(kept);
    const MatrixXd off =
        image * eigen.eigenvectors().rightCols(kept) - unit * variances.asDiagonal();
    for (Index k = 0; k < kept; ++k) {
      const Index from = kept - 1 - k;
      modes.col(k) = signed_by_largest(std::sqrt(std::max(0.0, variances[from])) * unit.col(from));
    }
    if (off.colwise().norm().maxCoeff() < enough * variances[kept - 1]) break;
    basis = orthonormal(image * eigen.eigenvectors());
  }
  return modes;
}

/// Modes of what the backs show, each by `weight`, and of what is assumed beside it.
Result<MatrixXd> modes_of(const Backs& backs, const Places& onto, const Places& mean, double weight,
                          const MatrixXd& assumed, const StatisticsOptions& options) {
  const auto seen = static_cast<Index>(backs.count > 1 ? backs.count : 0);
  const double scale = std::sqrt(weight / static_cast<double>(std::max<Index>(seen, 1)));
  const bool few = seen + assumed.cols() <= options.max_products;
  MatrixXd factor(assumed.rows(), few ? seen + assumed.cols() : block_columns);
  MatrixXd covariance;
  if (!few) covariance = MatrixXd::Zero(assumed.rows(), assumed.rows());
  Index column = 0;
  const auto add_block = [&] {
    covariance.selfadjointView<Eigen::Lower>().rankUpdate(factor.leftCols(column));
    column = 0;
  };
  if (seen > 0) {
    auto visited = visit_deviations(backs, onto, mean, [&](const VectorXd& deviation) {
      factor.col(column++) = deviation * scale;
      if (!few && column == factor.cols()) add_block();
    });
    if (!visited) return tl::unexpected(visited.error());
  }
  if (few) {
    factor.rightCols(assumed.cols()) = assumed;
    return modes_of_products(factor, options.modes);
  }
  add_block();
  covariance.selfadjointView<Eigen::Lower>().rankUpdate(assumed);
  return modes_of_sum(covariance, assumed, options.modes);
}

}  // namespace

Result<ShapeModel> model_of(const Backs& backs, const Template& standard, int persons,
                            const StatisticsOptions& options) {
  const Index n = standard.skin.cols();
  Places all(3, n + standard.labels.cols());
  all << standard.skin, standard.labels;
  Places onto;
  auto mean = mean_shape(backs, all, onto);
  if (!mean) return tl::unexpected(mean.error());
  ShapeModel model;
  model.mean = std::move(*mean);
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
  const auto pose = mean_pose(backs, model.mean);
  if (!pose) return tl::unexpected(pose.error());
  model.person_from_model = *pose;
  model.normals = align(standard.skin, model.mean.leftCols(n)).linear() * standard.normals;
  const MatrixXd coarse = smooth_modes(
      model.mean,
      coarse_m / std::sqrt(persons + (options.prior != nullptr ? options.prior_people : 0.0)),
      coarse_length_m, 40);
  const MatrixXd fine = smooth_modes(model.mean, options.smooth_m, fine_length_m, 70);
  MatrixXd assumed(3 * model.mean.cols(), coarse.cols() + fine.cols() + known.cols());
  assumed << coarse, fine, known;
  auto modes = modes_of(backs, onto, model.mean, 1.0 - share, assumed, options);
  if (!modes) return tl::unexpected(modes.error());
  model.modes = std::move(*modes);
  model.bodies = persons;
  return model;
}

}  // namespace tuina::body
