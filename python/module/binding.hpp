// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "tuina/core/acupoint.hpp"
#include "tuina/core/geometry.hpp"
#include "tuina/core/result.hpp"
#include "tuina/tissue/press_record.hpp"

/// What both modules of Python need to turn the library's values into those of Python.
namespace tuina::python {

namespace py = pybind11;

/// An error on its way to Python, where it becomes `tuina.Error`.
struct Refused {
  Error error;
};

/// Makes `Refused` of this module an error of that type, `tuina.Error`, which must stay.
void register_error(PyObject* type);

template <typename T>
[[nodiscard]] T value_of(Result<T> result) {
  if (!result) throw Refused{std::move(result.error())};
  if constexpr (!std::is_void_v<T>) return std::move(*result);
}

/// Does long work while other threads of Python run.
template <typename Work>
[[nodiscard]] auto without_gil(const Work& work) {
  const py::gil_scoped_release released;
  return work();
}

/// Numbers that lie in an object of Python, shown without a copy and read-only: `first` and then
/// every `strides` bytes. `owner` lives as long as the array.
template <typename Number>
[[nodiscard]] py::array view(const Number* first, std::vector<py::ssize_t> shape,
                             std::vector<py::ssize_t> strides, py::handle owner) {
  py::array array(py::dtype::of<Number>(), std::move(shape), std::move(strides), first, owner);
  py::detail::array_proxy(array.ptr())->flags &= ~py::detail::npy_api::NPY_ARRAY_WRITEABLE_;
  return array;
}

/// One number of each item.
template <typename Item, typename Number>
[[nodiscard]] py::array view(const std::vector<Item>& items, Number Item::*member,
                             py::handle owner) {
  return view(items.empty() ? nullptr : &(items.front().*member),
              {static_cast<py::ssize_t>(items.size())}, {sizeof(Item)}, owner);
}

/// One place or direction of each item: rows of x, y, z.
template <typename Item>
[[nodiscard]] py::array view(const std::vector<Item>& items, Vector3 Item::*member,
                             py::handle owner) {
  return view(items.empty() ? nullptr : (items.front().*member).data(),
              {static_cast<py::ssize_t>(items.size()), 3}, {sizeof(Item), sizeof(double)}, owner);
}

[[nodiscard]] inline py::array view(const std::vector<Vector3>& rows, py::handle owner) {
  return view(rows.empty() ? nullptr : rows.front().data(),
              {static_cast<py::ssize_t>(rows.size()), 3}, {sizeof(Vector3), sizeof(double)}, owner);
}

template <typename Number>
[[nodiscard]] py::array view(const std::vector<Number>& numbers, py::handle owner) {
  return view(numbers.data(), {static_cast<py::ssize_t>(numbers.size())}, {sizeof(Number)}, owner);
}

[[nodiscard]] inline py::array copy(const Vector3& vector) {
  return py::array_t<double>(3, vector.data());
}

/// Numbers of Python as doubles. Refused: what is no array of real numbers.
[[nodiscard]] py::array_t<double, py::array::c_style> numbers_of(const py::object& given,
                                                                 const char* name);
/// N rows of finite x, y, z; anything else is refused with the row.
[[nodiscard]] std::vector<Vector3> rows_of(const py::object& given, const char* name);
/// x, y, z.
[[nodiscard]] Vector3 vector_of(const py::object& given, const char* name);
/// A record of presses of three columns of the same length; a force may be NaN where
/// `force_may_lack`.
[[nodiscard]] std::vector<tissue::TimedPress> presses_of(const py::object& time_s,
                                                         const py::object& position_m,
                                                         const py::object& force_n,
                                                         bool force_may_lack = false);
/// "sitting" or "prone".
[[nodiscard]] BodyPosture posture_of(const std::string& name);
[[nodiscard]] std::optional<BodyPosture> posture_of(const std::optional<std::string>& name);

/// Adds what a map of a back has, whoever made it; `get` gives it from the object.
template <typename Class, typename Get>
void add_points(Class& type, Get get) {
  using Self = typename Class::type;
  const auto self_of = [get](const py::object& self) -> decltype(auto) {
    return get(self.cast<Self&>());
  };
  type.def_property_readonly(
          "names",
          [self_of](const py::object& self) {
            std::vector<std::string> names;
            for (const Acupoint& point : self_of(self).acupoints) names.push_back(point.name);
            return names;
          },
          "Names of the acupoints, in the order of the arrays; BL47_L is on the person's left.")
      .def_property_readonly(
          "at_in_couch",
          [self_of](const py::object& self) {
            return view(self_of(self).acupoints, &Acupoint::at_in_couch, self);
          },
          "Places of the acupoints in couch, m: N x 3, a view.")
      .def_property_readonly(
          "normals_in_couch",
          [self_of](const py::object& self) {
            return view(self_of(self).acupoints, &Acupoint::normal_in_couch, self);
          },
          "Unit normals there, out of the body: N x 3, a view.")
      .def_property_readonly(
          "uncertainty_m",
          [self_of](const py::object& self) {
            return view(self_of(self).acupoints, &Acupoint::uncertainty_m, self);
          },
          "Radii that hold the true point in 95 % of cases, m: N, a view.")
      .def_property_readonly(
          "landmarks_in_couch",
          [self_of](const py::object& self) {
            py::dict places;
            for (const Landmark& landmark : self_of(self).landmarks)
              places[py::str(landmark.name)] = copy(landmark.at_in_couch);
            return places;
          },
          "Places of the landmarks in couch, m, by name.");
}

}  // namespace tuina::python
