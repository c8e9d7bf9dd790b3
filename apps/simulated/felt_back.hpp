// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "apps/simulated/simulated_session.hpp"
#include "tuina/record/session_file.hpp"

namespace tuina::app {

/// Puts all that the presses of a session tell about a person into its record: tissue and stiffness
/// of each place in the order of pressing, what changed at those pressed twice, and the condition
/// of the body.
void add_felt_back(const SessionResult& result, record::SessionFile& file);

}  // namespace tuina::app
