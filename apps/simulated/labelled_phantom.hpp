// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tuina/body/learn/labelled_body.hpp"
#include "tuina/sim/person/phantom.hpp"

namespace tuina::app {

/// A simulated person with the truth, as a body to learn from or to judge by.
[[nodiscard]] inline body::LabelledBody labelled(const sim::Person& person) {
  body::LabelledBody made;
  made.id = person.name;
  made.body_type = sim::name_of(person.body_type);
  made.position = person.position;
  made.skin_in_couch = person.skin_in_couch;
  made.acupoints = person.acupoints;
  made.landmarks = person.landmarks;
  return made;
}

}  // namespace tuina::app
