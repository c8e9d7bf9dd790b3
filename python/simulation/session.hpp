// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "python/module/parts.hpp"

namespace tuina::python {

/// Whole massages in simulation.
void add_sessions(py::module_& module);

}  // namespace tuina::python
