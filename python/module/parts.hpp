// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "python/module/binding.hpp"
#include "tuina/body/back_surface.hpp"
#include "tuina/core/io/surface_file.hpp"

namespace tuina::python {

/// The skin of a person, and how many points the scan had that shows it.
struct Back {
  body::BackSurface surface;
  std::size_t points = 0, dropped_points = 0;
};

/// Each adds the classes and functions of one subject to the module.
void add_clouds(py::module_& module);
void add_body(py::module_& module);
void add_atlas(py::module_& module);
void add_massage(py::module_& module);
void add_tissue(py::module_& module);
void add_estimators(py::module_& module);
void add_record_estimates(py::module_& module);
void add_record(py::module_& module);

}  // namespace tuina::python
