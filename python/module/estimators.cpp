// SPDX-License-Identifier: Apache-2.0
#include "python/module/presses.hpp"
#include "tuina/tissue/record_estimate.hpp"

namespace tuina::python {
namespace {

using Options = tissue::PressEstimatorOptions;

/// An estimator that refuses what would come out of order. It is fed while no other thread of
/// Python runs, since two of them might feed the same one.
template <typename Estimator>
struct Fed {
  Estimator estimator;
  std::optional<tissue::TimedPress> last;

  /// Refuses rows before any of them is taken.
  void check_begin(const std::vector<tissue::TimedPress>& rows) const {
    if (rows.empty() || !last) return;
    const std::string fault = tissue::fault_of(rows.front(), &*last);
    if (!fault.empty()) throw Refused{{Fault::bad_input, "sample 0: " + fault}};
  }
  template <typename Each>
  void take(const std::vector<tissue::TimedPress>& rows, const Each& each) {
    check_begin(rows);
    for (const auto& row : rows) {
      estimator.update(row.time_s, row.press);
      each(row.time_s, estimator.estimate());
    }
    if (!rows.empty()) last = rows.back();
  }
};

void set_option(Options& options, double Options::*member, const char* name, double value) {
  if (!(value >= 0.0))
    throw Refused{{Fault::usage, fmt::format("{} is {}; 0 or more is needed", name, value)}};
  options.*member = value;
}

void add_options(py::module_& module) {
  auto type = py::class_<Options>(
      module, "EstimatorOptions",
      "Prior and noise model of both estimators. The defaults suit presses on a person who hardly "
      "moves.");
  type.def(py::init([](const py::kwargs& given) {
    py::object made = py::cast(Options{});
    for (const auto& [name, value] : given) py::setattr(made, name, value);
    return made.cast<Options>();
  }));
  const auto add = [&](const char* name, double Options::*member, const char* what) {
    type.def_property(
        name, [member](const Options& self) { return self.*member; },
        [member, name](Options& self, double value) { set_option(self, member, name, value); },
        what);
  };
  add("force_noise_n", &Options::force_noise_n, "One standard deviation of one sample, N.");
  add("position_noise_m", &Options::position_noise_m, "One standard deviation of one sample, m.");
  add("contact_sd_m", &Options::contact_sd_m, "Standard deviation of the skin about 0, m.");
  add("untared_sd_n", &Options::untared_sd_n,
      "Standard deviation of the zero of the force where no free air shows it, N.");
  add("force_delay_s", &Options::force_delay_s, "Delay of the force against the position, s.");
  add("timing_sd_s", &Options::timing_sd_s, "Standard deviation of that delay, s.");
  add("tool_mass_kg", &Options::tool_mass_kg, "Mass beyond the force sensor, kg.");
  add("torso_n_per_m", &Options::torso_n_per_m,
      "Stiffness in series with the tissue, N/m; 0 or infinity is rigid.");
  add("torso_sd", &Options::torso_sd, "Relative standard deviation of the torso's compliance.");
  add("breathing_m", &Options::breathing_m, "Motion of the skin by breathing, peak to peak, m.");
  add("breathing_hz", &Options::breathing_hz, "Breaths in a second.");
  type.def_readwrite("follows_skin", &Options::follows_skin,
                     "The tool follows the skin by its force.");
  module.def("record_options", &tissue::record_options,
             "Options for a record that somebody else has made: its zero is the skin within 1 mm.");
  module.def(
      "pressed_by_robot",
      [](double torso_n_per_m, double tool_mass_kg) {
        return tissue::pressed_by_robot(torso_n_per_m, tool_mass_kg);
      },
      py::arg("torso_n_per_m"), py::arg("tool_mass_kg"),
      "Options for presses by the robot itself, on a torso that gives way and breathes.");
}

void add_estimate(py::module_& module) {
  py::class_<TissueEstimate>(module, "TissueEstimate", "alpha and beta of F = alpha tan(beta x).")
      .def_property_readonly(
          "alpha_n", [](const TissueEstimate& self) { return self.tissue.alpha_n; }, "Hardness, N.")
      .def_property_readonly(
          "beta_per_m", [](const TissueEstimate& self) { return self.tissue.beta_per_m; },
          "Grows as the layer gets thinner, 1/m.")
      .def_readonly("alpha_ci95_n", &TissueEstimate::alpha_ci95_n,
                    "Half-width of the 95 % interval, N.")
      .def_readonly("beta_ci95_per_m", &TissueEstimate::beta_ci95_per_m,
                    "Half-width of the 95 % interval, 1/m.")
      .def_readonly("contact_m", &TissueEstimate::contact_m, "Position of the skin, m.")
      .def_readonly("presses", &TissueEstimate::presses)
      .def_readonly("converged", &TissueEstimate::converged)
      .def_property_readonly(
          "converged_after_s",
          [](const TissueEstimate& self) {
            return self.converged ? std::optional(self.converged_after_s) : std::nullopt;
          },
          "Time since the first contact, s; None: not converged.");
  const auto column = [](double TissueEstimate::*member) {
    return [member](const py::object& self) {
      return view(self.cast<History&>().after, member, self);
    };
  };
  const auto law = [](double TangentTissue::*member) {
    return [member](const py::object& self) {
      const auto& after = self.cast<History&>().after;
      return view(after.empty() ? nullptr : &(after.front().tissue.*member),
                  {static_cast<py::ssize_t>(after.size())}, {sizeof(TissueEstimate)}, self);
    };
  };
  py::class_<History>(module, "EstimateHistory",
                      "The estimate after each sample; arrays of N, views.")
      .def("__len__", [](const History& self) { return self.time_s.size(); })
      .def_property_readonly(
          "time_s", [](const py::object& self) { return view(self.cast<History&>().time_s, self); },
          "s")
      .def_property_readonly("alpha_n", law(&TangentTissue::alpha_n), "N")
      .def_property_readonly("beta_per_m", law(&TangentTissue::beta_per_m), "1/m")
      .def_property_readonly("alpha_ci95_n", column(&TissueEstimate::alpha_ci95_n), "N")
      .def_property_readonly("beta_ci95_per_m", column(&TissueEstimate::beta_ci95_per_m), "1/m")
      .def_property_readonly(
          "converged",
          [](const py::object& self) {
            return view(self.cast<History&>().after, &TissueEstimate::converged, self);
          },
          "bool");
}

/// What both estimators have.
template <typename Estimator>
auto add_estimator(py::module_& module, const char* name, const char* about) {
  using Self = Fed<Estimator>;
  return py::class_<Self>(module, name, about)
      .def(py::init([](const Options& options) {
             return Self{Estimator(options), {}};
           }),
           py::arg_v("options", Options{}, "EstimatorOptions()"))
      .def(
          "update",
          [](Self& self, const py::object& time_s, const py::object& position_m,
             const py::object& force_n) {
            self.take(presses_of(time_s, position_m, force_n), [](double, const auto&) {});
            return self.estimator.estimate();
          },
          py::arg("time_s"), py::arg("position_m"), py::arg("force_n"),
          "Adds one sample, or arrays of samples: s, m along the inward normal (larger is deeper), "
          "N "
          "onto the person. Returns the estimate after the last. Times grow from call to call.")
      .def(
          "follow",
          [](Self& self, const Presses& presses) {
            History history;
            self.take(presses.rows, [&](double time_s, const TissueEstimate& estimate) {
              history.add(time_s, estimate);
            });
            return history;
          },
          py::arg("presses"), "Adds a record, and returns the estimate after each of its samples.")
      .def_property_readonly(
          "estimate", [](const Self& self) { return self.estimator.estimate(); },
          "The estimate after the last sample.")
      .def_property_readonly(
          "nis", [](const Self& self) { return self.estimator.nis(); },
          "About 1 if the law describes the tissue, above 4 if not.")
      .def(
          "stiffness_sd",
          [](const Self& self, double force_n) { return self.estimator.stiffness_sd(force_n); },
          py::arg("force_n"), "Relative standard deviation of the tangent stiffness at a force, N.")
      .def(
          "reset",
          [](Self& self) {
            self.estimator.reset();
            self.last.reset();
          },
          "Forgets the person but not the options.");
}

}  // namespace

void add_estimators(py::module_& module) {
  add_options(module);
  add_estimate(module);
  add_estimator<tissue::PressEstimator>(module, "PressEstimator",
                                        "Recursive estimator of alpha and beta from one person's "
                                        "presses, by the inverse tangent law.")
      .def(
          "stiffness_n_per_m",
          [](const Fed<tissue::PressEstimator>& self, double force_n) {
            return self.estimator.stiffness_n_per_m(force_n);
          },
          py::arg("force_n"), "Tangent stiffness of the tissue at a force, N/m.");
  add_estimator<tissue::CreepEstimator>(
      module, "CreepEstimator",
      "Recursive estimator for tissue that need not follow the tangent law: it learns relaxation "
      "and damping too, and foretells the force of the next press.")
      .def(
          "force_half_width",
          [](const Fed<tissue::CreepEstimator>& self, double force_n) {
            return self.estimator.force_half_width(force_n);
          },
          py::arg("force_n"),
          "Half of the 95 % band of the force that a next press meets, as a share of force_n; "
          "infinite before the first press is over.");
}

}  // namespace tuina::python
