// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tuina/core/result.hpp"

namespace CLI {
class App;
}

namespace tuina::app {

/// Refuses a command, after its words were read, that would write onto what it reads: a file, or
/// one in a folder with a recording; or that would write two things into one file. One would be
/// lost.
[[nodiscard]] Result<void> check_not_onto_inputs(const CLI::App& chosen);

}  // namespace tuina::app
