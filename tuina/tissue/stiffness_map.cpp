// SPDX-License-Identifier: Apache-2.0
#include "tuina/tissue/stiffness_map.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

namespace tuina::tissue {
namespace {

double alike(const Vector3& a, const Vector3& b, const StiffnessMapOptions& options) {
  const double far = (a - b).norm() / options.reach_m;
  return options.spread * options.spread * std::exp(-0.5 * far * far);
}

}  // namespace

StiffnessMap::StiffnessMap(std::span<const FeltPlace> places, const StiffnessMapOptions& options)
    : options_(options) {
  const auto n = static_cast<Eigen::Index>(places.size());
  if (n == 0) return;
  for (const FeltPlace& place : places) {
    places_.push_back(place.at_in_couch);
    mean_ += place.log_stiffness / static_cast<double>(n);
  }
  Eigen::MatrixXd K(n, n);
  Eigen::VectorXd off(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const FeltPlace& place = places[static_cast<std::size_t>(i)];
    off(i) = place.log_stiffness - mean_;
    for (Eigen::Index j = 0; j < n; ++j)
      K(i, j) = alike(place.at_in_couch, places_[static_cast<std::size_t>(j)], options_);
    // The floor keeps two presses on one place from making the matrix singular.
    K(i, i) += place.sd * place.sd + 1e-8;
  }
  const Eigen::LLT<Eigen::MatrixXd> covariance(K);
  factor_ = covariance.matrixL();
  weights_ = covariance.solve(off);
}

std::optional<StiffnessMap::Value> StiffnessMap::at(const Vector3& point_in_couch) const {
  if (places_.empty()) return std::nullopt;
  Eigen::VectorXd k(static_cast<Eigen::Index>(places_.size()));
  for (Eigen::Index i = 0; i < k.size(); ++i)
    k(i) = alike(point_in_couch, places_[static_cast<std::size_t>(i)], options_);
  const double left = options_.spread * options_.spread -
                      factor_.triangularView<Eigen::Lower>().solve(k).squaredNorm();
  const double sd = std::sqrt(std::max(0.0, left));
  if (sd > options_.blank_share * options_.spread) return std::nullopt;
  return Value{mean_ + k.dot(weights_), sd};
}

std::optional<StiffnessChange> change_at(const StiffnessMap& before, const StiffnessMap& after,
                                         const Vector3& point_in_couch) {
  const auto was = before.at(point_in_couch), is = after.at(point_in_couch);
  if (!was || !is) return std::nullopt;
  StiffnessChange change{.log_change = is->log_stiffness - was->log_stiffness,
                         .detectable = 1.96 * std::hypot(was->sd, is->sd)};
  change.told = std::abs(change.log_change) > change.detectable;
  return change;
}

std::vector<Visit> last_visits(std::span<const Visit> visits) {
  std::vector<Visit> last;
  for (const Visit& visit : visits) {
    const auto same = std::find_if(last.begin(), last.end(),
                                   [&](const Visit& other) { return other.name == visit.name; });
    if (same == last.end())
      last.push_back(visit);
    else
      *same = visit;
  }
  return last;
}

std::vector<ComparedVisits> compare_visits(std::span<const Visit> visits) {
  std::vector<ComparedVisits> compared;
  std::vector<FeltPlace> before, after;
  for (const Visit& last : last_visits(visits)) {
    const auto same = [&](const Visit& visit) { return visit.name == last.name; };
    if (std::count_if(visits.begin(), visits.end(), same) < 2) continue;
    const Visit& first = *std::find_if(visits.begin(), visits.end(), same);
    before.push_back(first.felt);
    after.push_back(last.felt);
    compared.push_back({last.name, first.felt, last.felt, {}});
  }
  // Maps of the repeated places only: a place felt once would count as unchanged around it.
  const StiffnessMap was(before), is(after);
  for (ComparedVisits& place : compared)
    place.change = change_at(was, is, place.before.at_in_couch).value_or(StiffnessChange{});
  return compared;
}

}  // namespace tuina::tissue
