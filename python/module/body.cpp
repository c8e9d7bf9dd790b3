// SPDX-License-Identifier: Apache-2.0
#include <chrono>

#include "python/module/parts.hpp"
#include "tuina/body/acupoints.hpp"
#include "tuina/body/learn/labelled_body.hpp"
#include "tuina/body/palpation.hpp"
#include "tuina/core/units.hpp"
#include "tuina/record/acupoint_file.hpp"

namespace tuina::python {
namespace {

Back fit(const SurfaceFile& scan, const std::optional<std::string>& position) {
  const body::BackOptions options{.position = posture_of(position)};
  return without_gil([&] {
    // A mesh says what lies between its vertices.
    return Back{value_of(scan.triangles.empty()
                             ? body::fit_back(scan.cloud, options)
                             : body::fit_back(body::sample({scan.cloud.points, scan.triangles},
                                                           5_mm, body::max_mesh_points),
                                              options)),
                scan.cloud.size(), scan.dropped_points};
  });
}

record::MapFile locate(const Back& back, const body::Atlas& atlas, const std::string& method,
                       const py::object& board_normal) {
  const auto known = body::parse_method(method);
  if (!known) {
    throw Refused{
        {Fault::usage, fmt::format("method is {}; surface or field_morphing is needed", method)}};
  }
  std::optional<Vector3> normal;
  if (!board_normal.is_none()) normal = vector_of(board_normal, "board_normal");
  return without_gil([&] {
    const auto start = std::chrono::steady_clock::now();
    auto mapping = value_of(body::locate_acupoints(back.surface, atlas, *known, normal));
    const std::chrono::duration<double, std::milli> taken =
        std::chrono::steady_clock::now() - start;
    return record::MapFile{.mapping = std::move(mapping),
                           .points = back.points,
                           .dropped_points = back.dropped_points,
                           .compute_ms = taken.count()};
  });
}

record::MapFile fix(const record::MapFile& map, const Back& back, const py::dict& places_in_couch,
                    double error_m) {
  std::vector<body::PalpatedPoint> felt;
  for (const auto& [name, place] : places_in_couch) {
    const auto text = py::str(name).cast<std::string>();
    felt.push_back(
        {.name = text,
         .at_in_couch = vector_of(py::reinterpret_borrow<py::object>(place), text.c_str()),
         .error_m = error_m});
  }
  return without_gil([&] {
    record::MapFile fixed = map;
    fixed.mapping = value_of(body::fix_points(map.mapping, back.surface, felt));
    return fixed;
  });
}

void add_back(py::module_& module) {
  py::class_<Back>(module, "BackSurface",
                   "The skin of a person: cleaned, evenly thinned, with outward normals.")
      .def_property_readonly(
          "points",
          [](const py::object& self) {
            return view(self.cast<Back&>().surface.points().points, self);
          },
          "In couch, m: N x 3, a view.")
      .def_property_readonly(
          "normals",
          [](const py::object& self) {
            return view(self.cast<Back&>().surface.points().normals, self);
          },
          "Unit, out of the body: N x 3, a view.")
      .def_property_readonly(
          "position", [](const Back& self) { return name_of(self.surface.position()); },
          "sitting or prone.")
      .def_property_readonly(
          "spacing_m", [](const Back& self) { return self.surface.spacing_m(); },
          "Typical distance of neighbouring points, m.")
      .def(
          "nearest",
          [](const Back& self, const py::object& place_in_couch) {
            const auto point = self.surface.nearest(vector_of(place_in_couch, "place_in_couch"));
            return py::make_tuple(copy(point.at_in_couch), copy(point.normal_in_couch));
          },
          py::arg("place_in_couch"),
          "Place on the smoothed skin, m, and its unit normal out of the body.");
  module.def("fit_back", &fit, py::arg("scan_in_couch"), py::arg("position") = py::none(),
             "Finds the person in a scan: removes couch, chair and bed, estimates normals; a mesh "
             "is sampled every 5 mm.\nposition: sitting or prone; None: recognised. Fails without "
             "a person, with less than a back, with more than one person, and when the cloud is "
             "not in metres.");
}

void add_map(py::module_& module) {
  auto map = py::class_<record::MapFile>(module, "Mapping",
                                         "Acupoints of one person, located on their back.");
  add_points(
      map, [](const record::MapFile& self) -> const auto& { return self.mapping; });
  map.def_property_readonly(
         "method", [](const record::MapFile& self) { return name_of(self.mapping.method); },
         "surface or field_morphing.")
      .def_property_readonly(
          "position", [](const record::MapFile& self) { return name_of(self.mapping.position); },
          "sitting or prone.")
      .def_property_readonly(
          "coverage", [](const record::MapFile& self) { return self.mapping.coverage; },
          "Share of the atlas' back that the scan shows.")
      .def_property_readonly(
          "rms_residual_m", [](const record::MapFile& self) { return self.mapping.rms_residual_m; },
          "RMS distance of the scan from the fitted back, m; surface only.")
      .def_property_readonly(
          "covariance_m2",
          [](const py::object& self) {
            const auto& all = self.cast<record::MapFile&>().mapping.covariance_m2;
            return view(all.data(), {all.rows(), all.cols()},
                        {sizeof(double), static_cast<py::ssize_t>(sizeof(double)) * all.rows()},
                        self);
          },
          "Joint covariance of acupoints, then landmarks, x, y, z of each in couch, m^2: a view; "
          "surface only.")
      .def("fix", &fix, py::arg("back"), py::arg("places_in_couch"), py::arg("error_m") = 3e-3,
           "The map with points that a finger has found, {name: (x, y, z)} in couch, m; the others "
           "follow.\nerror_m: standard deviation of the finger in each direction. Fails for an "
           "unknown name and a place off the skin.")
      .def(
          "to_json", [](const record::MapFile& self) { return record::to_json(self); },
          "The text of acupoints.json, as `tuina map` writes it.");
  auto read = py::class_<record::MappedBack>(module, "MappedBack",
                                             "Acupoints of one scan, as acupoints.json has them.");
  add_points(
      read, [](const record::MappedBack& self) -> const auto& { return self; });
  read.def_property_readonly(
      "position",
      [](const record::MappedBack& self) {
        return self.position ? std::optional(name_of(*self.position)) : std::nullopt;
      },
      "sitting, prone, or None where the file does not say.");
}

}  // namespace

void add_body(py::module_& module) {
  add_back(module);
  add_map(module);
  module.def("locate_acupoints", &locate, py::arg("back"), py::arg("atlas"),
             py::arg("method") = "surface", py::arg("board_normal") = py::none(),
             "Locates the atlas' acupoints on a back, in couch, m.\nmethod: surface (a learned "
             "shape model) or field_morphing (the thesis); board_normal: normal of its plane of "
             "projection. Fails when the scan shows no back that the atlas covers.");
  module.def(
      "read_acupoints",
      [](const std::string& path) { return value_of(record::read_acupoints(path)); },
      py::arg("path"),
      "Reads acupoints.json of `tuina map`. Fails for a missing point of the seven, a place that "
      "is "
      "not in metres and a normal that is not of length one, with its name.");
}

}  // namespace tuina::python
