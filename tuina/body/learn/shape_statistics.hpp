// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tuina/body/learn/registered_backs.hpp"

namespace tuina::body {

/// How many modes the joint Gaussian has, and what it knows before the first person.
struct StatisticsOptions {
  int modes = 60;
  /// Standard deviation of the smooth deformation added to the observed ones.
  double smooth_m = 10e-3;
  /// Shape model on the same template, as prior for the covariance; weighs `prior_people`.
  const ShapeModel* prior = nullptr;
  double prior_people = 5.0;
  double prior_people_for_mean = 1.0;
  /// Up to so many deviations, of backs and assumed ones, modes come of their products with each
  /// other; of more, of a sum over the backs that takes the same memory for any number of them.
  Eigen::Index max_products = 1000;
};

/// Mean and modes of the backs of `persons` people: a joint Gaussian of skin points and labels.
[[nodiscard]] Result<ShapeModel> model_of(const Backs& backs, const Template& standard, int persons,
                                          const StatisticsOptions& options);

}  // namespace tuina::body
