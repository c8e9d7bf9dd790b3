// SPDX-License-Identifier: Apache-2.0
#include "tuina/body/correction.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "tuina/core/units.hpp"

namespace tuina::body {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double max_widening = 3.0;
// Squared distance of a fitted back from the mean one, in standard deviations of the modes, that
// half of 56 people of docs/bodies.md reach in each position: up to there radii hold as learned.
constexpr double usual_mahalanobis2_sitting = 8.5;
constexpr double usual_mahalanobis2_prone = 10.5;
// Tuned on people of docs/bodies.md outside the training set.
constexpr double share_of_prior = 0.5;
// Mean label error of a fit that found the back in another place; the largest of a right one is a
// third of this.
constexpr double elsewhere_mm = 100.0;

/// Candidates of the ridge penalty, chosen by leave-one-person-out: for the weights, and for the
/// constant in equivalent people without error.
struct Penalties {
  std::vector<double> of_weights;
  std::vector<double> of_constant;
};

/// With a prior the penalty is fixed, tuned on people of docs/bodies.md outside the training set:
/// chosen by leave-one-out it was wrong by up to ten times even with forty people. Only the penalty
/// of the constant is chosen.
Penalties penalties_of(Index persons, bool beside_prior) {
  if (persons < 4) return {{1e6}, {100.0}};
  if (beside_prior) return {{10.0}, {3.0, 10.0}};
  if (persons < 10) return {{10.0}, {0.0, 1.0, 3.0, 10.0, 100.0}};
  return {{3.0, 10.0, 30.0, 100.0, 300.0, 1000.0, 3000.0, 1e5}, {0.0}};
}

/// Factor on the radii: larger where the scan determines a label less than a whole back does, and
/// for a back with a larger residual than the training set.
VectorXd widening(const ShapeModel& model, const VectorXd& variance_m2, double residual_m) {
  const double misfit = residual_m / std::max(1e-6, model.usual_residual_m);
  return (variance_m2.array() / model.nominal_var_m2.array()).sqrt().max(1.0) *
         std::clamp(misfit, 1.0, max_widening);
}

/// Ridge regression with the penalties of the least leave-one-person-out error; the constant is the
/// last column.
MatrixXd ridge(const MatrixXd& features, const MatrixXd& targets, Index views,
               const Penalties& penalties, MatrixXd& left_out) {
  const Index rows = features.cols();
  MatrixXd x(features.rows() + 1, rows);
  x << features, VectorXd::Ones(rows).transpose();
  double best = std::numeric_limits<double>::max();
  MatrixXd best_weights;
  for (const double lambda : penalties.of_weights) {
    for (const double constant_penalty : penalties.of_constant) {
      MatrixXd normal = x * x.transpose();
      normal.diagonal().head(features.rows()).array() += lambda;
      normal.diagonal()[features.rows()] += constant_penalty * static_cast<double>(views);
      const Eigen::LDLT<MatrixXd> solver(normal);
      const MatrixXd weights = solver.solve(x * targets.transpose()).transpose();
      const MatrixXd influence = solver.solve(x);
      MatrixXd residual = targets - weights * x;
      // A person and their reflection are left out together, because they share errors.
      for (Index i = 0; i < rows; i += views) {
        const MatrixXd hat = x.middleCols(i, views).transpose() * influence.middleCols(i, views);
        const MatrixXd rest = MatrixXd::Identity(views, views) - hat;
        residual.middleCols(i, views) = residual.middleCols(i, views) * rest.inverse();
      }
      const double loss = residual.squaredNorm();
      if (loss < best) {
        best = loss;
        best_weights = weights;
        left_out = residual;
      }
    }
  }
  return best_weights;
}

/// Factor on the radii of a back of which only this share is in view. Regression and calibration
/// have seen whole backs only; found on people of `population`, sitting and prone, cut below the
/// loins or with a gap there.
double unseen_widening(double share_seen) {
  constexpr double whole_share = 0.95, per_share = 4.5;
  return 1.0 + per_share * std::max(0.0, whole_share - share_seen);
}

/// Factor on the radii of a strange back, which neither the modes nor the regression have seen.
double strangeness(const ShapeModel& model, const ShapeFit& fit) {
  const double usual = model.position == BodyPosture::sitting ? usual_mahalanobis2_sitting
                                                              : usual_mahalanobis2_prone;
  return std::max(1.0, fit.weights.squaredNorm() / usual);
}

double quantile95(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(
      std::min<double>(static_cast<double>(values.size()) - 1.0,
                       std::ceil(0.95 * static_cast<double>(values.size()))))];
}

bool lies_elsewhere(const LeftOut& left_out, Index column) {
  const auto off_mm = left_out.targets_mm.col(column).reshaped(3, left_out.targets_mm.rows() / 3);
  double sum_mm = 0.0, labels = 0.0;
  for (Index l = 0; l < off_mm.cols(); ++l) {
    if (!left_out.shows(l)) continue;
    sum_mm += off_mm.col(l).norm();
    labels += 1.0;
  }
  return sum_mm > elsewhere_mm * labels;
}

/// Columns of the people whose fits found the back, in each view; of all where nobody's did.
std::vector<Index> found_backs(const LeftOut& left_out) {
  std::vector<Index> all, found;
  for (Index person = 0; person < left_out.features.cols(); person += left_out.views) {
    bool elsewhere = false;
    for (Index view = 0; view < left_out.views; ++view) {
      all.push_back(person + view);
      elsewhere = elsewhere || lies_elsewhere(left_out, person + view);
    }
    if (!elsewhere) found.insert(found.end(), all.end() - left_out.views, all.end());
  }
  return found.empty() ? all : found;
}

/// Learns the correction from some columns. Returns the errors of all: those of the others as they
/// are.
MatrixXd learn_offsets(const LeftOut& left_out, const std::vector<Index>& found,
                       ShapeModel& model) {
  const MatrixXd features = left_out.features(Eigen::all, found);
  MatrixXd targets_mm = left_out.targets_mm(Eigen::all, found);
  const bool beside_prior = model.correction.size() > 0;
  const Index persons = static_cast<Index>(found.size()) / left_out.views;
  const Penalties penalties = penalties_of(persons, beside_prior);
  MatrixXd of_found_mm;
  if (beside_prior) {
    targets_mm = (targets_mm - model.correction.leftCols(features.rows()) * features).colwise() -
                 model.correction.col(features.rows());
    for (Index l = 0; l < targets_mm.rows() / 3; ++l) {
      if (!left_out.shows(l)) targets_mm.middleRows<3>(3 * l).setZero();
    }
    model.correction += ridge(features, targets_mm, left_out.views, penalties, of_found_mm);
  } else {
    model.correction = ridge(features, targets_mm, left_out.views, penalties, of_found_mm);
  }
  MatrixXd wrong_mm = left_out.targets_mm;
  wrong_mm(Eigen::all, found) = of_found_mm;
  return wrong_mm;
}

/// What a usual back leaves open, by which the radii are divided.
void learn_normalisers(const LeftOut& left_out, const std::vector<Index>& found,
                       ShapeModel& model) {
  model.nominal_var_m2 = left_out.variance_m2(Eigen::all, found).rowwise().mean();
  const VectorXd residual_m = left_out.residual_m(found);
  std::vector<double> misfits(residual_m.begin(), residual_m.end());
  std::nth_element(misfits.begin(), misfits.begin() + misfits.size() / 2, misfits.end());
  model.usual_residual_m = misfits[misfits.size() / 2];
}

}  // namespace

MatrixXd learn_correction(const LeftOut& left_out, ShapeModel& model) {
  const Index persons = left_out.features.cols() / left_out.views;
  const std::vector<Index> found = found_backs(left_out);
  MatrixXd wrong_mm = learn_offsets(left_out, found, model);
  if (model.nominal_var_m2.size() == 0) learn_normalisers(left_out, found, model);
  model.max_outlier_score =
      std::max(model.max_outlier_score, left_out.outlier_score(found).maxCoeff());
  // The 95 % radius is calibrated on widened radii, as it is used.
  std::vector<std::vector<double>> errors_m(static_cast<std::size_t>(model.radius95_m.size()));
  for (Index i = 0; i < wrong_mm.cols(); ++i) {
    const VectorXd wider = widening(model, left_out.variance_m2.col(i), left_out.residual_m[i]);
    for (Index l = 0; l < wider.size(); ++l) {
      errors_m[static_cast<std::size_t>(l)].push_back(1e-3 * wrong_mm.block<3, 1>(3 * l, i).norm() /
                                                      wider[l]);
    }
  }
  for (Index l = 0; l < model.radius95_m.size(); ++l) {
    if (!left_out.shows(l)) continue;
    // The largest error of a few people underestimates that of the next.
    model.radius95_m[l] = (1.0 + 2.0 / static_cast<double>(persons)) *
                          quantile95(std::move(errors_m[static_cast<std::size_t>(l)]));
  }
  return wrong_mm;
}

MatrixXd correction_carried(const ShapeModel& prior, const ShapeModel& model) {
  const Index n = model.skin_points();
  const Index kept = model.modes.cols();
  const Transform prior_from_model = align(model.mean, prior.mean);
  const auto features_of = [&](const VectorXd& weights) {
    return skin_features(prior, prior_from_model * placed(model, weights, 0, n));
  };
  // The prior's features are linear in those of the model.
  const VectorXd of_mean = features_of(VectorXd::Zero(kept));
  MatrixXd of_modes(of_mean.size(), kept);
  for (Index k = 0; k < kept; ++k) of_modes.col(k) = features_of(VectorXd::Unit(kept, k)) - of_mean;
  const MatrixXd says = share_of_prior * prior.correction.leftCols(of_mean.size());
  MatrixXd carried(says.rows(), kept + 1);
  carried.leftCols(kept) = says * of_modes;
  carried.col(kept) = says * of_mean + prior.correction.rightCols<1>();
  for (Index row = 0; row < carried.rows(); row += 3) {
    carried.middleRows<3>(row) =
        (prior_from_model.linear().transpose() * carried.middleRows<3>(row)).eval();
  }
  return carried;
}

void carry_radii(const ShapeModel& prior, const LeftOut& left_out, ShapeModel& model) {
  const VectorXd wider = widening(prior, model.nominal_var_m2, model.usual_residual_m);
  for (Index l = 0; l < model.radius95_m.size(); ++l)
    if (!left_out.shows(l)) model.radius95_m[l] = prior.radius95_m[l] * wider[l];
}

LabelEstimate estimate_labels(const ShapeModel& model, const BackSurface& back) {
  LabelEstimate estimate;
  estimate.fit = fit_shape(model, back);
  const ShapeFit& fit = estimate.fit;
  estimate.at_in_couch = fit.labels_in_couch;
  if (model.correction.size() > 0) {
    const Transform model_from_couch =
        align(fit.skin_in_couch, model.mean.leftCols(model.skin_points()));
    const VectorXd features = skin_features(model, model_from_couch * fit.skin_in_couch);
    const VectorXd off = 1e-3 * (model.correction.leftCols(features.size()) * features +
                                 model.correction.rightCols<1>());
    estimate.at_in_couch += model_from_couch.linear().transpose() *
                            Eigen::Map<const Places>(off.data(), 3, off.size() / 3);
  }
  estimate.strangeness = strangeness(model, fit);
  estimate.radius95_m =
      estimate.strangeness * unseen_widening(fit.coverage) *
      model.radius95_m.cwiseProduct(widening(model, fit.label_var_m2, fit.residual_m));
  estimate.radius95_m = estimate.radius95_m.cwiseMax(fit.label_doubt_m);
  return estimate;
}

}  // namespace tuina::body
