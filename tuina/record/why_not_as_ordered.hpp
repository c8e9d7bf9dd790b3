// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tuina/record/session_file.hpp"
#include "tuina/session/run.hpp"

namespace tuina::record {

/// Why a path got less or more than the plan orders; empty where it did not. `told` has its forces,
/// `begun_intensity` is that of the session as it began.
[[nodiscard]] Sentence why_not_as_ordered(const session::Session& session,
                                          const session::Performed& done,
                                          const PerformedEntry& told, double begun_intensity);

}  // namespace tuina::record
