// SPDX-License-Identifier: Apache-2.0
#include "python/module/binding.hpp"

#include <cmath>

namespace tuina::python {
namespace {

std::string shape_of(const py::array& array) {
  std::string shape = "(";
  for (py::ssize_t i = 0; i < array.ndim(); ++i)
    shape += fmt::format("{}{}", i > 0 ? ", " : "", array.shape(i));
  return shape + (array.ndim() == 1 ? ",)" : ")");
}

[[noreturn]] void refuse(const std::string& message) {
  throw Refused{{Fault::bad_input, message}};
}

const char* name_of(Fault fault) {
  constexpr const char* names[] = {"usage", "not_found", "bad_input", "config",
                                   "file",  "device",    "stopped"};
  return names[static_cast<std::size_t>(fault)];
}

/// `tuina.Error`.
PyObject* error_type = nullptr;

/// One number per sample.
std::vector<double> column_of(const py::object& given, const char* name) {
  const auto numbers = numbers_of(given, name);
  if (numbers.ndim() > 1) {
    refuse(fmt::format("{} has the shape {}; one number for each sample is needed", name,
                       shape_of(numbers)));
  }
  return {numbers.data(), numbers.data() + numbers.size()};
}

}  // namespace

void register_error(PyObject* type) {
  error_type = type;
  // NOLINTNEXTLINE(performance-unnecessary-value-param): pybind11 wants this signature
  py::register_local_exception_translator([](std::exception_ptr thrown) {
    try {
      if (thrown) std::rethrow_exception(thrown);
    } catch (const Refused& refused) {
      const py::object error =
          py::reinterpret_borrow<py::object>(error_type)(refused.error.message);
      error.attr("fault") = name_of(refused.error.fault);
      PyErr_SetObject(error_type, error.ptr());
    }
  });
}

py::array_t<double, py::array::c_style> numbers_of(const py::object& given, const char* name) {
  const auto array = py::array::ensure(given);
  if (!array) {
    PyErr_Clear();
    refuse(fmt::format("{} is no array of numbers", name));
  }
  const char kind = array.dtype().kind();
  if (kind != 'f' && kind != 'i' && kind != 'u') {
    refuse(fmt::format("{} is an array of {}; real numbers are needed", name,
                       py::str(array.dtype()).cast<std::string>()));
  }
  if (py::isinstance(given, py::module_::import("numpy.ma").attr("MaskedArray")) &&
      given.attr("mask").attr("any")().cast<bool>())
    refuse(fmt::format("{} is masked in part; fill or leave out what is", name));
  return py::array_t<double, py::array::c_style | py::array::forcecast>(array);
}

std::vector<Vector3> rows_of(const py::object& given, const char* name) {
  const auto numbers = numbers_of(given, name);
  if (numbers.ndim() != 2 || numbers.shape(1) != 3) {
    refuse(
        fmt::format("{} has the shape {}; N rows of x, y, z are needed", name, shape_of(numbers)));
  }
  std::vector<Vector3> rows(static_cast<std::size_t>(numbers.shape(0)));
  for (std::size_t i = 0; i < rows.size(); ++i) {
    rows[i] = Eigen::Map<const Vector3>(numbers.data() + 3 * i);
    if (rows[i].allFinite()) continue;
    refuse(fmt::format("{}[{}] is ({}, {}, {}); leave out what was not measured", name, i,
                       rows[i].x(), rows[i].y(), rows[i].z()));
  }
  return rows;
}

Vector3 vector_of(const py::object& given, const char* name) {
  const auto numbers = numbers_of(given, name);
  if (numbers.ndim() != 1 || numbers.size() != 3)
    refuse(fmt::format("{} has the shape {}; x, y, z are needed", name, shape_of(numbers)));
  Vector3 vector = Eigen::Map<const Vector3>(numbers.data());
  if (!vector.allFinite()) {
    refuse(fmt::format("{} is ({}, {}, {}); finite numbers are needed", name, vector.x(),
                       vector.y(), vector.z()));
  }
  return vector;
}

std::vector<tissue::TimedPress> presses_of(const py::object& time_s, const py::object& position_m,
                                           const py::object& force_n, bool force_may_lack) {
  const auto times = column_of(time_s, "time_s"), positions = column_of(position_m, "position_m"),
             forces = column_of(force_n, "force_n");
  if (times.size() != positions.size() || times.size() != forces.size()) {
    refuse(
        fmt::format("time_s has {} numbers, position_m {} and force_n {}; each sample has one "
                    "of each",
                    times.size(), positions.size(), forces.size()));
  }
  std::vector<tissue::TimedPress> presses;
  presses.reserve(times.size());
  for (std::size_t i = 0; i < times.size(); ++i) {
    const std::pair<const char*, double> numbers[] = {
        {"time_s", times[i]}, {"position_m", positions[i]}, {"force_n", forces[i]}};
    for (const auto& [name, value] : numbers) {
      const bool lacks = force_may_lack && std::isnan(value) && name == numbers[2].first;
      if (!std::isfinite(value) && !lacks)
        refuse(fmt::format("{}[{}] is {}; finite numbers are needed", name, i, value));
    }
    const tissue::TimedPress row{times[i], {.depth_m = positions[i], .force_n = forces[i]}};
    const std::string fault = tissue::fault_of(row, presses.empty() ? nullptr : &presses.back());
    if (!fault.empty()) refuse(fmt::format("sample {}: {}", i, fault));
    presses.push_back(row);
  }
  return presses;
}

BodyPosture posture_of(const std::string& name) {
  for (const BodyPosture posture : {BodyPosture::sitting, BodyPosture::prone})
    if (name == name_of(posture)) return posture;
  throw Refused{{Fault::usage, fmt::format("position is {}; sitting or prone is needed", name)}};
}

std::optional<BodyPosture> posture_of(const std::optional<std::string>& name) {
  return name ? std::optional(posture_of(*name)) : std::nullopt;
}

}  // namespace tuina::python
