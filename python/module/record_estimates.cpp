// SPDX-License-Identifier: Apache-2.0
#include "python/module/presses.hpp"
#include "tuina/tissue/classification.hpp"
#include "tuina/tissue/press_forecast.hpp"
#include "tuina/tissue/record_estimate.hpp"

namespace tuina::python {
namespace {

using Options = tissue::PressEstimatorOptions;

/// The estimate of a whole record, and what a later press is foretold by.
struct Estimated {
  tissue::RecordEstimate made;
  History history;
  double begin_s = 0.0, end_s = 0.0;

  [[nodiscard]] tissue::Classification found() const {
    return tissue::classify(made.estimator.estimate(), made.estimator.nis());
  }
};

Estimated estimate(const Presses& presses, const std::optional<double>& force_noise_n,
                   const std::optional<double>& position_noise_m, const Options& options) {
  if (presses.rows.empty()) throw Refused{{Fault::bad_input, "the record has no samples"}};
  const auto known = known_noise(force_noise_n, position_noise_m);
  return without_gil([&] {
    Estimated all{.begin_s = presses.rows.front().time_s, .end_s = presses.rows.back().time_s};
    all.made = tissue::estimate_record(
        presses.rows, options, known,
        [&](double time_s, const TissueEstimate& now) { all.history.add(time_s, now); });
    return all;
  });
}

py::tuple predict(const Estimated& self, const py::object& time_s, const py::object& position_m,
                  const py::object& force_n) {
  const auto rows = presses_of(time_s, position_m, force_n, true);
  const auto foretold = without_gil([&] {
    return value_of(tissue::foretell_press(self.made.estimator, self.begin_s, self.end_s, rows));
  });
  const auto count = static_cast<py::ssize_t>(foretold.size());
  py::array_t<double> times(count), forces(count), lows(count), highs(count);
  for (py::ssize_t i = 0; i < count; ++i) {
    const auto& [at_s, band] = foretold[static_cast<std::size_t>(i)];
    times.mutable_at(i) = at_s;
    forces.mutable_at(i) = band.force_n;
    lows.mutable_at(i) = band.low_n;
    highs.mutable_at(i) = band.high_n;
  }
  return py::make_tuple(times, forces, lows, highs);
}

}  // namespace

void add_record_estimates(py::module_& module) {
  py::class_<Estimated>(module, "RecordEstimate",
                        "What CreepEstimator made of a record, as `tuina tissue estimate` does.")
      .def_property_readonly(
          "estimate", [](const Estimated& self) { return self.made.estimator.estimate(); },
          "After the last sample.")
      .def_property_readonly(
          "history",
          [](const py::object& self) {
            return py::cast(self.cast<Estimated&>().history,
                            py::return_value_policy::reference_internal, self);
          },
          "After each sample.")
      .def_property_readonly(
          "nis", [](const Estimated& self) { return self.made.estimator.nis(); },
          "About 1 if the law describes the tissue, above 4 if not.")
      .def_property_readonly(
          "force_noise_n", [](const Estimated& self) { return self.made.noise.force_n; },
          "Standard deviation of a sample, as told or as the record shows it, N.")
      .def_property_readonly(
          "position_noise_m", [](const Estimated& self) { return self.made.noise.position_m; },
          "Likewise, m.")
      .def_property_readonly(
          "tissue_class", [](const Estimated& self) { return name_of(self.found().label); },
          "bone, hard, soft or unknown.")
      .def_property_readonly(
          "class_probabilities",
          [](const Estimated& self) {
            const auto found = self.found();
            py::dict all;
            all["bone"] = found.of[0];
            all["hard"] = found.of[1];
            all["soft"] = found.of[2];
            return all;
          },
          "Of bone, hard and soft; they sum to one.")
      .def(
          "predict", &predict, py::arg("time_s"), py::arg("position_m"), py::arg("force_n"),
          "Foretells the forces of a later press, where its force_n is NaN; the forces that are "
          "given tell where the skin is.\nReturns time_s, force_n, and the low and high end of the "
          "95 % band, N. The press begins after the record, or on a clock of its own.");
  module.def("estimate_record", &estimate, py::arg("presses"),
             py::arg("force_noise_n") = py::none(), py::arg("position_noise_m") = py::none(),
             py::arg_v("options", tissue::record_options(), "record_options()"),
             "Estimates the tissue from a record as it grows; what it says at a time never depends "
             "on what comes later.\nNoise: N and m; None: read from the record. The noise in "
             "options is not used.");
}

}  // namespace tuina::python
