// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

namespace tuina::calibration {

/// A row of a least-squares problem: its residual and the derivatives by the unknowns that it
/// knows.
struct FitRow {
  int pose = -1;  ///< of the board that it belongs to; -1: of none
  double residual = 0.0;
  std::vector<std::pair<int, double>> slopes;  ///< number of the unknown, and derivative
};

/// Covariance of the first `shared` unknowns at the solution, the others being the affair of one
/// pose each.
struct PoseCovariance {
  Eigen::MatrixXd of_rows;   ///< if every row errs by itself, with deviation 1
  Eigen::MatrixXd of_poses;  ///< from what leaving out one pose after the other changes
};

/// Rows of one pose may err alike, by paper that is not flat or print that is not as it was taken
/// for: then their residuals are small and their number promises too much. The jackknife over poses
/// (one Gauss-Newton step each) needs errors of different poses only to be independent. Nothing
/// when the rows leave something undetermined.
[[nodiscard]] std::optional<PoseCovariance> pose_covariance(const std::vector<FitRow>& rows,
                                                            int shared);

}  // namespace tuina::calibration
