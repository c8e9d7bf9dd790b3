// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tuina/scanner/sweep.hpp"
#include "tuina/session/config.hpp"

namespace tuina::session {

/// How the configuration wants a sweep: symmetric about straight ahead.
[[nodiscard]] scanner::SweepOptions sweep_options(const Config& config);

}  // namespace tuina::session
