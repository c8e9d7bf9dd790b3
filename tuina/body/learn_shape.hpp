// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "tuina/body/labelled_body.hpp"
#include "tuina/body/outline.hpp"
#include "tuina/body/shape_model.hpp"
#include "tuina/core/progress.hpp"

namespace tuina::body {

/// A labelled back with its surface and outline: what learning looks at.
struct Example {
  BackSurface back;
  Outline outline;
  std::vector<Acupoint> acupoints;
  std::vector<Landmark> landmarks;
};
[[nodiscard]] Result<Example> make_example(const LabelledBody& body);
[[nodiscard]] Result<Example> make_example(const LabelledBody& body, BackSurface seen);
[[nodiscard]] Example mirrored(const Example& example);

struct LearnOptions {
  int modes = 60;
  bool mirror = true;     ///< every person also counts as seen in a mirror
  int folds = 8;          ///< for the correction and the uncertainty
  double smooth_m = 10e-3;  ///< standard deviation of a free smooth deformation on top of what was seen
  double sigma_m = 8e-3;
  double ridge = 0.0;  ///< 0: chosen by leaving one out
  /// What is known of backs beforehand: an atlas of other people, whose modes say how backs differ. A few
  /// labelled bodies then move its mean and add to its modes.
  const ShapeModel* prior = nullptr;
  double prior_mean_bodies = 0.3;   ///< the prior's mean counts as so many bodies
  double prior_modes_bodies = 10.0;
};

/// Learns one position; the examples are all in it. Deterministic. `out_of_fold_mm`, when given, receives
/// the error of each acupoint of each example (column) when its fold is left out.
[[nodiscard]] Result<ShapeModel> learn_shape(const std::vector<Example>& examples,
                                             const LearnOptions& options = {},
                                             const Progress& progress = {},
                                             Eigen::MatrixXd* out_of_fold_mm = nullptr);

/// The example whose labels are nearest to the mean of all: the standard model of the thesis.
[[nodiscard]] std::size_t medium_example(const std::vector<Example>& examples, const ShapeModel& model);

/// Fit, correction and place on the skin of every label: the method `surface`.
struct LabelEstimate {
  Places at_in_couch;
  Eigen::VectorXd radius95_m;
  ShapeFit fit;
};
[[nodiscard]] LabelEstimate estimate_labels(const ShapeModel& model, const BackSurface& back,
                                            const Outline& outline, double sigma_m = 8e-3);

}  // namespace tuina::body
