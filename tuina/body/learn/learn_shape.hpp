// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tuina/body/fit_shape.hpp"
#include "tuina/body/learn/shape_statistics.hpp"
#include "tuina/core/progress.hpp"

namespace tuina::body {

/// How a shape model is learned.
struct LearnOptions {
  StatisticsOptions statistics;
  Reach reach = Reach::labels;
  /// Atlas of other people. A few bodies adapt its correction; with enough bodies a model of their
  /// own is tried, and kept if it predicts left-out bodies better.
  const ShapeModel* prior = nullptr;
  bool mirror = true;  ///< every person also counts reflected
  int folds = 8;       ///< cross-validation folds for correction and uncertainty
};

/// Learns one position from examples in it; deterministic. `out_of_fold_mm`, if given, receives the
/// cross-validated error of each acupoint (row) of each example (column).
[[nodiscard]] Result<ShapeModel> learn_shape(const Examples& examples,
                                             const LearnOptions& options = {},
                                             const Progress& progress = {},
                                             Eigen::MatrixXd* out_of_fold_mm = nullptr);

}  // namespace tuina::body
