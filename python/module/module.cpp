// SPDX-License-Identifier: Apache-2.0
#include "python/module/parts.hpp"

namespace tuina::python {
PYBIND11_MODULE(_tuina, module) {
  module.doc() =
      "Scans to acupoints, acupoints to plans, presses to tissue, and records of sessions.\n"
      "SI units; places in the frame couch (x to the person's left, z up), see "
      "docs/frames_and_units.md.\nWhat goes wrong is a tuina.Error.";
  module.attr("__version__") = TUINA_VERSION;
  PyObject* error = PyErr_NewExceptionWithDoc(
      "tuina.Error",
      "What the library says no with: one sentence for people, the one that the program says too.\n"
      "`fault` says what a caller can do: usage, not_found, bad_input, config, file, device or "
      "stopped.",
      nullptr, nullptr);
  module.add_object("Error", py::reinterpret_borrow<py::object>(error));
  register_error(error);  // this module holds the reference that was made
  add_clouds(module);
  add_atlas(module);
  add_body(module);
  add_massage(module);
  add_tissue(module);
  add_estimators(module);
  add_record_estimates(module);
  add_record(module);
}

}  // namespace tuina::python
