// SPDX-License-Identifier: Apache-2.0
#include "tuina/calibration/fit/pose_covariance.hpp"

#include <Eigen/Cholesky>
#include <Eigen/QR>
#include <map>
#include <span>
#include <utility>

namespace tuina::calibration {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

// Relative to the best known unknown; less information counts as none.
constexpr double told = 1e-9;

// Information and gradient of some rows on the shared unknowns.
struct Said {
  MatrixXd information;
  VectorXd gradient;
};

// Schur complement: eliminates the unknowns of these rows only.
Said said_by(std::span<const FitRow* const> rows, int shared) {
  std::map<int, int> own;
  for (const FitRow* row : rows) {
    for (const auto& [unknown, slope] : row->slopes) {
      if (unknown >= shared) own.emplace(unknown, 0);
    }
  }
  int size = shared;
  for (auto& [unknown, place] : own) place = size++;
  MatrixXd information = MatrixXd::Zero(size, size);
  VectorXd gradient = VectorXd::Zero(size);
  const auto place_of = [&](int unknown) { return unknown < shared ? unknown : own.at(unknown); };
  for (const FitRow* row : rows) {
    for (const auto& [a, slope_a] : row->slopes) {
      gradient(place_of(a)) += slope_a * row->residual;
      for (const auto& [b, slope_b] : row->slopes) {
        information(place_of(a), place_of(b)) += slope_a * slope_b;
      }
    }
  }
  const int others = size - shared;
  if (others == 0) return {information, gradient};
  const MatrixXd across = information.topRightCorner(shared, others);
  const Eigen::LDLT<MatrixXd> among_others(information.bottomRightCorner(others, others));
  return {
      information.topLeftCorner(shared, shared) - across * among_others.solve(across.transpose()),
      gradient.head(shared) - across * among_others.solve(gradient.tail(others))};
}

}  // namespace

std::optional<PoseCovariance> pose_covariance(const std::vector<FitRow>& rows, int shared) {
  std::map<int, std::vector<const FitRow*>> by_pose;
  for (const FitRow& row : rows) by_pose[row.pose].push_back(&row);
  std::vector<Said> poses;
  MatrixXd all = MatrixXd::Zero(shared, shared);
  for (const auto& [pose, of_pose] : by_pose) {
    Said said = said_by(of_pose, shared);
    all += said.information;
    if (pose >= 0) poses.push_back(std::move(said));
  }
  // Unknowns of very different size (focal lengths in thousands, tilts in thousandths) are scaled
  // to one, so that undetermined ones show.
  const VectorXd unit = all.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  const auto scaled = [&unit](const MatrixXd& information) {
    return MatrixXd(unit.asDiagonal() * information * unit.asDiagonal());
  };
  const Eigen::LLT<MatrixXd> whole(scaled(all));
  if (whole.info() != Eigen::Success) return std::nullopt;
  MatrixXd changes = MatrixXd::Zero(shared, shared);
  for (const Said& pose : poses) {
    // Directions that no other pose determines, such as the axis of a single standing board, stay
    // fixed.
    Eigen::CompleteOrthogonalDecomposition<MatrixXd> without(shared, shared);
    without.setThreshold(told);
    without.compute(scaled(all - pose.information));
    const VectorXd change = without.solve(unit.asDiagonal() * pose.gradient);
    changes += change * change.transpose();
  }
  const auto n = static_cast<double>(poses.size());
  PoseCovariance covariance{.of_rows = scaled(whole.solve(MatrixXd::Identity(shared, shared))),
                            .of_poses = scaled((n - 1.0) / n * changes)};
  if (!covariance.of_rows.allFinite() || !covariance.of_poses.allFinite()) return std::nullopt;
  return covariance;
}

}  // namespace tuina::calibration
