// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tuina/sim/person/phantom_form.hpp"

namespace tuina::sim {

/// Places landmarks and acupoints of a phantom by the rules of docs/bodies.md, in `couch`, into
/// `person`.
void mark_points(const Proportions& proportions, const PhantomForm& form, const PhantomPose& pose,
                 bool arms_up, Person& person);

}  // namespace tuina::sim
