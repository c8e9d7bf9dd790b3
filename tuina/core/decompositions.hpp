// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tuina/core/geometry.hpp"

/// Decompositions of small matrices that many rooms need. Eigen's templates for them take longer to
/// compile than a whole source, so they are compiled once.
namespace tuina {

/// The smallest rotation that takes the direction `from` to the direction `to`.
[[nodiscard]] Eigen::Quaterniond turn_between(const Vector3& from, const Vector3& to);

/// The rotation that is closest to a matrix (Frobenius norm).
[[nodiscard]] Matrix3 nearest_rotation(const Matrix3& matrix);

/// The motion that takes the points `from` (columns) to `to` with the least squares [umeyama1991].
[[nodiscard]] Transform rigid_motion(const Eigen::Matrix3Xd& from, const Eigen::Matrix3Xd& to);

/// The x of `symmetric` x = `right`, normal equations of a least-squares fit (LDLT).
[[nodiscard]] Vector2 solve_symmetric(const Eigen::Matrix2d& symmetric, const Vector2& right);
[[nodiscard]] Vector3 solve_symmetric(const Matrix3& symmetric, const Vector3& right);
[[nodiscard]] Eigen::VectorXd solve_symmetric(const Eigen::MatrixXd& symmetric,
                                              const Eigen::VectorXd& right);
/// The same for each column of `right`.
[[nodiscard]] Eigen::MatrixXd solve_symmetric(const Eigen::MatrixXd& symmetric,
                                              const Eigen::MatrixXd& right);

/// Eigenvalues of a symmetric matrix, ascending.
[[nodiscard]] Eigen::VectorXd eigenvalues(const Eigen::MatrixXd& symmetric);

/// Principal axes of a symmetric matrix: axes are the columns, their moments rise.
struct PrincipalAxes {
  Vector3 moments;
  Matrix3 axes;
};
/// Eigenvalues, ascending, and unit eigenvectors of a symmetric matrix.
[[nodiscard]] PrincipalAxes principal_axes(const Matrix3& symmetric);

}  // namespace tuina
