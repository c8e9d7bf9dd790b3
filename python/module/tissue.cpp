// SPDX-License-Identifier: Apache-2.0
#include "apps/cli/press_file.hpp"
#include "python/module/presses.hpp"
#include "tuina/tissue/curve_fit.hpp"
#include "tuina/tissue/tangent_model.hpp"

namespace tuina::python {
namespace {

using tissue::CurveFit;
using tissue::TimedPress;

/// A number of each sample that lies in its press.
py::array view_of(const py::object& self, double Press::*member) {
  const auto& rows = self.cast<Presses&>().rows;
  return view(rows.empty() ? nullptr : &(rows.front().press.*member),
              {static_cast<py::ssize_t>(rows.size())}, {sizeof(TimedPress)}, self);
}

void add_presses(py::module_& module) {
  py::class_<Presses>(module, "Presses", "A record of presses of one place, sample by sample.")
      .def(
          py::init([](const py::object& time_s, const py::object& position_m,
                      const py::object& force_n) {
            return Presses{presses_of(time_s, position_m, force_n)};
          }),
          py::arg("time_s"), py::arg("position_m"), py::arg("force_n"),
          "Three columns of the same length, which are copied: times that grow, s; positions along "
          "the inward normal, larger is deeper, the skin near zero, m; forces onto the person, N.\n"
          "Refuses other shapes and what is not finite, with the sample.")
      .def("__len__", [](const Presses& self) { return self.rows.size(); })
      .def_property_readonly(
          "time_s",
          [](const py::object& self) {
            return view(self.cast<Presses&>().rows, &TimedPress::time_s, self);
          },
          "s: N, a view.")
      .def_property_readonly(
          "position_m", [](const py::object& self) { return view_of(self, &Press::depth_m); },
          "Along the inward normal, m: N, a view.")
      .def_property_readonly(
          "force_n", [](const py::object& self) { return view_of(self, &Press::force_n); },
          "Onto the person, N: N, a view.");
  module.def(
      "read_presses",
      [](const std::string& path) {
        return without_gil([&] { return Presses{value_of(app::read_presses(path))}; });
      },
      py::arg("path"),
      "Reads CSV with the columns time_s, position_mm and force_n. Fails with file, line and what "
      "would be right.");
}

void add_fit(py::module_& module) {
  py::class_<CurveFit>(module, "CurveFit", "F = alpha tan(beta x), fitted to a whole record.")
      .def_property_readonly(
          "alpha_n", [](const CurveFit& self) { return self.tissue.alpha_n; }, "Hardness, N.")
      .def_property_readonly(
          "beta_per_m", [](const CurveFit& self) { return self.tissue.beta_per_m; },
          "Grows as the layer gets thinner, 1/m.")
      .def_readonly("alpha_ci95_n", &CurveFit::alpha_ci95_n, "Half-width of the 95 % interval, N.")
      .def_readonly("beta_ci95_per_m", &CurveFit::beta_ci95_per_m,
                    "Half-width of the 95 % interval, 1/m.")
      .def_readonly("contact_m", &CurveFit::contact_m,
                    "Position of the skin on the axis of the record, m.")
      .def_readonly("offset_n", &CurveFit::offset_n, "What the sensor says in free air, N.")
      .def_readonly("rmse_n", &CurveFit::rmse_n, "Of the force, over samples above 1 N.")
      .def_readonly("reduced_chi_square", &CurveFit::reduced_chi_square,
                    "About 1 where the law describes the tissue.")
      .def_readonly("peak_force_n", &CurveFit::peak_force_n)
      .def_readonly("samples", &CurveFit::samples);
  module.def(
      "fit_curve",
      [](const Presses& presses, const std::optional<double>& force_noise_n,
         const std::optional<double>& position_noise_m) {
        const auto known = known_noise(force_noise_n, position_noise_m);
        return without_gil([&] {
          return value_of(
              tissue::fit_curve(presses.rows, known.over(tissue::estimate_noise(presses.rows))));
        });
      },
      py::arg("presses"), py::arg("force_noise_n") = py::none(),
      py::arg("position_noise_m") = py::none(),
      "Fits alpha, beta, the skin and the sensor's offset to all samples at once.\nNoise: standard "
      "deviations of one sample, N and m; None: read from the record. Fails for a record without a "
      "contact or too short.");
  module.def(
      "force_at_depth",
      [](const py::object& depth_m, double alpha_n, double beta_per_m) {
        const auto depths = numbers_of(depth_m, "depth_m");
        for (py::ssize_t i = 0; i < depths.size(); ++i)
          if (!std::isfinite(depths.data()[i]))
            throw Refused{{Fault::usage, fmt::format("depth_m[{}] is {}; finite numbers are needed",
                                                     i, depths.data()[i])}};
        return py::vectorize([tissue = tissue_of(alpha_n, beta_per_m)](double depth) {
          return tissue::force_at_depth(tissue, depth);
        })(depths);
      },
      py::arg("depth_m"), py::arg("alpha_n"), py::arg("beta_per_m"),
      "F = alpha tan(beta x), N, at depths beneath the skin, m; zero above it. Beyond 97 % of the "
      "pole the curve goes on straight.");
}

}  // namespace

tissue::KnownNoise known_noise(const std::optional<double>& force_n,
                               const std::optional<double>& position_m) {
  const std::pair<const char*, const std::optional<double>&> both[] = {
      {"force_noise_n", force_n}, {"position_noise_m", position_m}};
  for (const auto& [name, value] : both) {
    if (value && !(*value > 0.0 && std::isfinite(*value)))
      throw Refused{{Fault::usage, fmt::format("{} is {}; more than 0 is needed", name, *value)}};
  }
  tissue::KnownNoise known;
  if (force_n) known.force_n = *force_n;
  if (position_m) known.position_m = *position_m;
  return known;
}

void add_tissue(py::module_& module) {
  add_presses(module);
  add_fit(module);
}

}  // namespace tuina::python
