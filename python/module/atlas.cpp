// SPDX-License-Identifier: Apache-2.0
#include "tuina/body/atlas.hpp"
#include "apps/cli/installed.hpp"
#include "python/module/parts.hpp"
#include "tuina/core/io/file.hpp"

namespace tuina::python {
namespace {

body::Atlas read(const std::optional<std::string>& path) {
  return without_gil([&] {
    return value_of(
        body::read_atlas(path ? std::filesystem::path(*path) : app::shipped_atlas_path()));
  });
}

std::vector<body::LabelledBody> read_bodies(const std::string& folder_or_ply) {
  return without_gil([&] {
    std::vector<body::LabelledBody> bodies;
    for (const auto& path : value_of(body::list_labelled_bodies(folder_or_ply)))
      bodies.push_back(value_of(body::read_labelled_body(path)));
    return bodies;
  });
}

void add_labelled_body(py::module_& module) {
  auto labelled = py::class_<body::LabelledBody>(
      module, "LabelledBody", "A back with known points, in couch, to learn from or to judge by.");
  add_points(
      labelled, [](const body::LabelledBody& self) -> const auto& { return self; });
  labelled.def_readonly("id", &body::LabelledBody::id)
      .def_property_readonly(
          "position", [](const body::LabelledBody& self) { return name_of(self.position); },
          "sitting or prone.")
      .def_property_readonly(
          "skin_in_couch",
          [](const body::LabelledBody& self) {
            return SurfaceFile{.cloud = {.points = self.skin_in_couch.vertices},
                               .triangles = self.skin_in_couch.triangles};
          },
          "The skin as a mesh, m.")
      .def(
          "write",
          [](const body::LabelledBody& self, const std::string& ply) {
            value_of(body::write_labelled_body(self, ply));
          },
          py::arg("ply"), "Writes NAME.ply and NAME.json beside it (docs/bodies.md).");
}

}  // namespace

void add_atlas(py::module_& module) {
  add_labelled_body(module);
  py::class_<body::Atlas>(module, "Atlas", "Models learned from labelled backs, one per position.")
      .def_readonly("made", &body::Atlas::made, "Origin, for people.")
      .def_property_readonly(
          "bodies",
          [](const body::Atlas& self) {
            py::dict bodies;
            for (const auto& known : self.positions)
              bodies[name_of(known.shape.position)] = known.shape.bodies;
            return bodies;
          },
          "How many backs it was learned from, by position.")
      .def(
          "write",
          [](const body::Atlas& self, const std::string& path) {
            value_of(write_file(path, body::to_bytes(self)));
          },
          py::arg("path"), "Writes the atlas file.");
  module.def("read_atlas", &read, py::arg("path") = py::none(),
             "Reads an atlas file; None: the shipped one. Fails for a wrong version, length or "
             "checksum.");
  module.def("read_labelled_bodies", &read_bodies, py::arg("folder_or_ply"),
             "One labelled body NAME.ply with NAME.json beside it, or all of a folder, by name.");
  module.def(
      "learn_atlas",
      [](const std::vector<body::LabelledBody>& bodies, const body::Atlas* prior) {
        return without_gil([&] { return value_of(body::learn_atlas(bodies, prior, {}, nullptr)); });
      },
      py::arg("bodies"), py::arg("prior") = py::none(),
      "Learns an atlas from labelled bodies; the same bodies give the same atlas.\nWith a prior a "
      "few bodies adapt it; without one, a single body gives an atlas of itself.");
}

}  // namespace tuina::python
