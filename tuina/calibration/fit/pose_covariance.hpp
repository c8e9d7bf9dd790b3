// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

namespace tuina::calibration {

/// A row of a least-squares problem: residual and nonzero derivatives.
struct FitRow {
  int pose = -1;  ///< pose of the board; -1: none
  double residual = 0.0;
  std::vector<std::pair<int, double>> slopes;  ///< index of the unknown, derivative
};

/// Covariance of the first `shared` unknowns at the solution, the others eliminated per pose.
struct PoseCovariance {
  Eigen::MatrixXd of_rows;   ///< assumes independent rows of unit variance
  Eigen::MatrixXd of_poses;  ///< jackknife over poses
};

/// Errors within a pose may correlate (bent paper, inaccurate print), which makes the row-wise
/// covariance too small. The jackknife over poses (one Gauss-Newton step each) only assumes
/// independent poses. Nothing when an unknown is undetermined.
[[nodiscard]] std::optional<PoseCovariance> pose_covariance(const std::vector<FitRow>& rows,
                                                            int shared);

}  // namespace tuina::calibration
