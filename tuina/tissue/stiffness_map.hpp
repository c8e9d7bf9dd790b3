// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "tuina/core/geometry.hpp"

namespace tuina::tissue {

/// One pressed place: log tangent stiffness at a force common to all places, and its standard
/// deviation.
struct FeltPlace {
  Vector3 at_in_couch = Vector3::Zero();
  double log_stiffness = 0.0;
  double sd = 0.0;
};

/// How far a felt place tells of its surroundings.
struct StiffnessMapOptions {
  double reach_m = 40e-3;     ///< correlation length: a muscle's width
  double spread = 0.4;        ///< prior standard deviation over a back: Table 6-2 at 10 N
  double blank_share = 0.85;  ///< no answer where nearly all of that spread is left
};

/// Gaussian process over the back. Distances are straight: within the correlation length a back
/// hardly bends.
class StiffnessMap {
 public:
  /// Logarithm of the stiffness at a place, and its standard deviation.
  struct Value {
    double log_stiffness = 0.0;
    double sd = 0.0;
  };
  /// Takes in all places at once.
  explicit StiffnessMap(std::span<const FeltPlace> places, const StiffnessMapOptions& options = {});

  /// Nothing if no near place was pressed.
  [[nodiscard]] std::optional<Value> at(const Vector3& point_in_couch) const;

 private:
  StiffnessMapOptions options_;
  std::vector<Vector3> places_;
  double mean_ = 0.0;
  Eigen::MatrixXd factor_;  // lower triangle: the covariance is factor_ * factor_^T
  Eigen::VectorXd weights_;
};

/// Change of a place between two maps; `detectable` is the smallest change that is significant at
/// 95 %. Not `told` means "no detectable change", which is an answer.
struct StiffnessChange {
  double log_change = 0.0;
  double detectable = 0.0;
  bool told = false;
};
/// Nothing where either map has no answer.
[[nodiscard]] std::optional<StiffnessChange> change_at(const StiffnessMap& before,
                                                       const StiffnessMap& after,
                                                       const Vector3& point_in_couch);

/// Result of one press of a named place, in order of time; places may repeat.
struct Visit {
  std::string name;
  FeltPlace felt;
};
/// The last visit of each place.
[[nodiscard]] std::vector<Visit> last_visits(std::span<const Visit> visits);

/// First and last visit of each place visited more than once.
struct ComparedVisits {
  std::string name;
  FeltPlace before, after;
  StiffnessChange change;
};
/// Of all places that were visited more than once.
[[nodiscard]] std::vector<ComparedVisits> compare_visits(std::span<const Visit> visits);

}  // namespace tuina::tissue
