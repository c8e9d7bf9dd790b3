// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace tuina::web {

/// What somebody who was let in may do: watch and stop, or take control, too, when nobody has it.
enum class Role : std::uint8_t { watch, operate };

}  // namespace tuina::web
