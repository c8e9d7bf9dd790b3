// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tuina/body/fit_shape.hpp"
#include "tuina/body/learn/shape_statistics.hpp"
#include "tuina/core/progress.hpp"

namespace tuina::body {

struct LearnOptions {
  StatisticsOptions statistics;
  Reach reach = Reach::labels;
  /// What is known beforehand: an atlas of other people. A few bodies teach it another correction;
  /// enough to be better on bodies left out are learned from on their own.
  const ShapeModel* prior = nullptr;
  bool mirror = true;  ///< every person also counts as seen in a mirror
  int folds = 8;       ///< for the correction and the uncertainty
};

/// Learns one position; the examples are all in it. Deterministic. `out_of_fold_mm`, when given,
/// receives the error of each acupoint of each example (column) when its fold is left out.
[[nodiscard]] Result<ShapeModel> learn_shape(const std::vector<Example>& examples,
                                             const LearnOptions& options = {},
                                             const Progress& progress = {},
                                             Eigen::MatrixXd* out_of_fold_mm = nullptr);

}  // namespace tuina::body
