// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "tuina/body/fit_shape.hpp"

namespace tuina::body {

/// Fits of backs left out of the model, one column each, with their label errors.
struct LeftOut {
  Eigen::MatrixXd features;     ///< skin_features of the fitted skin
  Eigen::MatrixXd targets_mm;   ///< label errors, three rows per label, in the model's frame
  Eigen::MatrixXd variance_m2;  ///< variance of each label that the fit leaves
  Eigen::VectorXd residual_m;
  Eigen::VectorXd outlier_score;
  Eigen::Index views = 1;  ///< columns per person
  /// Whether these people have the label; of one that nobody has shown the errors are unknown.
  /// Empty: they have all.
  std::vector<bool> shown = {};

  [[nodiscard]] bool shows(Eigen::Index label) const {
    return shown.empty() || shown[static_cast<std::size_t>(label)];
  }
};

/// Learns correction, 95 % radii and outlier limits from left-out backs. Returns their label errors
/// in millimetres when each is corrected by the others. An existing correction of the model is the
/// prior, and what the radii are divided by stays where the model has it already: prior radii hold
/// with the prior's only. Labels that nobody has shown keep correction and radius. A person whose
/// fit came to lie elsewhere, head to feet for instance, counts in radii and errors as it is, and
/// in nothing else: what is off by 300 mm is no correction of 3.
Eigen::MatrixXd learn_correction(const LeftOut& left_out, ShapeModel& model);

/// Transfers the correction of a prior to another model on the same template, in that model's
/// features and frame. Halved: phantoms resemble each other more than people do, so their shape
/// says more about their points.
[[nodiscard]] Eigen::MatrixXd correction_carried(const ShapeModel& prior, const ShapeModel& model);

/// Gives labels that nobody has shown the radii of the prior, as wide as it would say them of these
/// people, whom it fits worse than those that it was learned from.
void carry_radii(const ShapeModel& prior, const LeftOut& left_out, ShapeModel& model);

/// Fit, correction and uncertainty of every label, for the method `surface`.
struct LabelEstimate {
  Places at_in_couch;
  Eigen::VectorXd radius95_m;
  /// Sum of the squared weights of the modes, over that of a usual back; at least 1.
  double strangeness = 1.0;
  ShapeFit fit;
};
/// Finds all labels of a model on a back.
[[nodiscard]] LabelEstimate estimate_labels(const ShapeModel& model, const BackSurface& back);

}  // namespace tuina::body
