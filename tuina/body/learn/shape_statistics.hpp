// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "tuina/body/learn/correspondence.hpp"

namespace tuina::body {

/// The template registered to one back, and the frame that moves with the person.
struct Registered {
  Places shape_in_couch;
  Transform couch_from_person;
};
[[nodiscard]] Registered registered(const Template& standard, const Example& example,
                                    const std::vector<std::string>& names);

/// How many modes the joint Gaussian has, and what it knows before the first person.
struct StatisticsOptions {
  int modes = 60;
  /// Standard deviation of the smooth deformation added to the observed ones.
  double smooth_m = 10e-3;
  /// Shape model on the same template, as prior for the covariance; weighs `prior_people`.
  const ShapeModel* prior = nullptr;
  double prior_people = 5.0;
  double prior_people_for_mean = 1.0;
};

/// Mean and modes of the backs of `persons` people: a joint Gaussian of skin points and labels.
[[nodiscard]] ShapeModel model_of(const std::vector<const Registered*>& backs,
                                  const Template& standard, int persons,
                                  const StatisticsOptions& options);

}  // namespace tuina::body
