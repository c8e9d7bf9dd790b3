// SPDX-License-Identifier: Apache-2.0
#include "python/module/parts.hpp"

namespace tuina::python {
namespace {

SurfaceFile make_cloud(const py::object& points, const py::object& normals) {
  SurfaceFile made;
  made.cloud.points = rows_of(points, "points");
  if (normals.is_none()) return made;
  made.cloud.normals = rows_of(normals, "normals");
  if (made.cloud.normals.size() != made.cloud.points.size()) {
    throw Refused{{Fault::bad_input,
                   fmt::format("there are {} normals and {} points; each point has one normal",
                               made.cloud.normals.size(), made.cloud.points.size())}};
  }
  return made;
}

void write(const SurfaceFile& surface, const std::string& path, const std::string& format) {
  const auto known = cloud_format(format);
  if (!known) {
    throw Refused{{Fault::usage,
                   fmt::format("format is {}; ply, ply-ascii, ply-big-endian, pcd or pcd-ascii is "
                               "needed",
                               format)}};
  }
  without_gil([&] { value_of(write_cloud(path, surface.cloud, *known)); });
}

}  // namespace

void add_clouds(py::module_& module) {
  py::class_<SurfaceFile>(module, "PointCloud",
                          "Points of a surface, m; what comes from a scanner is in couch.")
      .def(py::init(&make_cloud), py::arg("points"), py::arg("normals") = py::none(),
           "A cloud of N x 3 points, m, and N x 3 unit normals, if they are known; both are "
           "copied.\nRefuses other shapes and what is not finite, with the row.")
      .def("__len__", [](const SurfaceFile& self) { return self.cloud.size(); })
      .def_property_readonly(
          "points",
          [](const py::object& self) { return view(self.cast<SurfaceFile&>().cloud.points, self); },
          "N x 3, m; a view.")
      .def_property_readonly(
          "normals",
          [](const py::object& self) {
            return view(self.cast<SurfaceFile&>().cloud.normals, self);
          },
          "Unit, out of the surface: N x 3, or 0 x 3 where they are not known; a view.")
      .def_property_readonly(
          "amplitude",
          [](const py::object& self) {
            return view(self.cast<SurfaceFile&>().cloud.amplitude, self);
          },
          "Brightness of the laser line, DN: N, or none; a view.")
      .def_property_readonly(
          "deviation_m",
          [](const py::object& self) {
            return view(self.cast<SurfaceFile&>().cloud.deviation_m, self);
          },
          "Standard deviation of the range, m: N, or none; a view.")
      .def_property_readonly(
          "triangles",
          [](const py::object& self) {
            const auto& triangles = self.cast<SurfaceFile&>().triangles;
            return view(triangles.empty() ? nullptr : triangles.front().data(),
                        {static_cast<py::ssize_t>(triangles.size()), 3},
                        {sizeof(triangles[0]), sizeof(int)}, self);
          },
          "Indices of points, counter-clockwise seen from outside: M x 3, none for a cloud; a "
          "view.")
      .def_readonly("dropped_points", &SurfaceFile::dropped_points,
                    "Points of the file that were no numbers and were left out.")
      .def("write", &write, py::arg("path"), py::arg("format") = "ply",
           "Writes the points: ply, ply-ascii, ply-big-endian, pcd or pcd-ascii.");
  module.def(
      "read_cloud",
      [](const std::string& path) {
        return without_gil([&] { return value_of(read_surface(path)); });
      },
      py::arg("path"),
      "Reads a cloud or mesh: PLY (ascii, binary) or PCD (ascii, binary, binary_compressed), m.\n"
      "Fails on malformed files with file, line or byte, and the remedy.");
}

}  // namespace tuina::python
