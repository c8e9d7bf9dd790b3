// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>

namespace tuina {

/// Called with the finished share of long work, from 0 to 1; may be empty.
using Progress = std::function<void(double done)>;

}  // namespace tuina
