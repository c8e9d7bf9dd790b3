// SPDX-License-Identifier: Apache-2.0
#include "tuina/core/decompositions.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/SVD>

namespace tuina {

Eigen::Quaterniond turn_between(const Vector3& from, const Vector3& to) {
  return Eigen::Quaterniond::FromTwoVectors(from, to);
}

Matrix3 nearest_rotation(const Matrix3& matrix) {
  const Eigen::JacobiSVD<Matrix3> svd(matrix, Eigen::ComputeFullU | Eigen::ComputeFullV);
  return svd.matrixU() * svd.matrixV().transpose();
}

Transform rigid_motion(const Eigen::Matrix3Xd& from, const Eigen::Matrix3Xd& to) {
  Transform motion = Transform::Identity();
  motion.matrix() = Eigen::umeyama(from, to, false);
  return motion;
}

Vector2 solve_symmetric(const Eigen::Matrix2d& symmetric, const Vector2& right) {
  return symmetric.ldlt().solve(right);
}

Vector3 solve_symmetric(const Matrix3& symmetric, const Vector3& right) {
  return symmetric.ldlt().solve(right);
}

Eigen::VectorXd solve_symmetric(const Eigen::MatrixXd& symmetric, const Eigen::VectorXd& right) {
  return symmetric.ldlt().solve(right);
}

Eigen::MatrixXd solve_symmetric(const Eigen::MatrixXd& symmetric, const Eigen::MatrixXd& right) {
  return symmetric.ldlt().solve(right);
}

Eigen::VectorXd eigenvalues(const Eigen::MatrixXd& symmetric) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(symmetric, Eigen::EigenvaluesOnly);
  return solver.eigenvalues();
}

PrincipalAxes principal_axes(const Matrix3& symmetric) {
  const Eigen::SelfAdjointEigenSolver<Matrix3> solver(symmetric);
  return {.moments = solver.eigenvalues(), .axes = solver.eigenvectors()};
}

}  // namespace tuina
