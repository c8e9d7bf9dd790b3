// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "tuina/body/learn/correspondence.hpp"

namespace tuina::body {

/// The places of the template on one back, and the frame that moves with the person.
struct Registered {
  Places shape_in_couch;
  Transform couch_from_person;
};
[[nodiscard]] Registered registered(const Template& standard, const Example& example,
                                    const std::vector<std::string>& names);

struct StatisticsOptions {
  int modes = 60;
  double smooth_m =
      10e-3;  ///< standard deviation of a free smooth deformation on top of what was seen
  /// What is known of how backs differ, on the same template; counts as so many people.
  const ShapeModel* prior = nullptr;
  double prior_people = 5.0;
  double prior_people_for_mean = 1.0;
};

/// Mean and modes of backs, of `persons` different people: a Gaussian over skin points and labels
/// together.
[[nodiscard]] ShapeModel model_of(const std::vector<const Registered*>& backs,
                                  const Template& standard, int persons,
                                  const StatisticsOptions& options);

}  // namespace tuina::body
