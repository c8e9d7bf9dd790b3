// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tuina/body/fit_shape.hpp"

namespace tuina::body {

/// Fits of backs that their model had not seen, one column each, and what was then wrong with each
/// label.
struct LeftOut {
  Eigen::MatrixXd features;     ///< of the fitted skin: skin_features
  Eigen::MatrixXd targets_mm;   ///< three rows for each label, in the frame of the model
  Eigen::MatrixXd variance_m2;  ///< of each label, that the fit leaves
  Eigen::VectorXd residual_m;
  double most_unusual = 0.0;  ///< of all of them
  Eigen::Index views = 1;     ///< columns that are one person
};

/// Learns the correction, the radii and what is usual from backs left out, and returns what is
/// wrong with the labels of each when it is corrected by the others, in millimetres. A correction
/// that the model already has is kept as far as the backs do not contradict it.
Eigen::MatrixXd learn_correction(const LeftOut& left_out, ShapeModel& model);

/// What the correction of a prior says for another model on the same template, in the features and
/// the frame of that model. Half of it: phantoms resemble each other more than people do, so what
/// their shape says about their points says less about those of people.
[[nodiscard]] Eigen::MatrixXd correction_carried(const ShapeModel& prior, const ShapeModel& model);

/// Fit, correction and uncertainty of every label: the method `surface`.
struct LabelEstimate {
  Places at_in_couch;
  Eigen::VectorXd radius95_m;
  ShapeFit fit;
};
[[nodiscard]] LabelEstimate estimate_labels(const ShapeModel& model, const BackSurface& back);

}  // namespace tuina::body
