// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>

namespace tuina {

/// Long work tells how far it is, from 0 to 1; may be empty.
using Progress = std::function<void(double done)>;

}  // namespace tuina
