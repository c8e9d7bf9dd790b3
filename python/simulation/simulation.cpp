// SPDX-License-Identifier: Apache-2.0
#include "apps/simulated/labelled_phantom.hpp"
#include "apps/simulated/scanned_people.hpp"
#include "python/module/presses.hpp"
#include "python/simulation/session.hpp"
#include "tuina/sim/person/person.hpp"
#include "tuina/sim/tissue_worlds.hpp"

namespace tuina::python {
namespace {

body::LabelledBody person(const std::string& words, const std::optional<std::string>& position,
                          std::uint64_t seed) {
  const auto posture = posture_of(position);
  return without_gil(
      [&] { return app::labelled(value_of(sim::parse_person(words, posture, seed))); });
}

SurfaceFile scan(const body::LabelledBody& person, std::uint64_t seed) {
  return without_gil([&] {
    return SurfaceFile{
        .cloud = value_of(app::see(person, {.by = app::Scan::By::laser}, seed)).cloud_in_couch};
  });
}

py::tuple presses(double alpha_n, double beta_per_m, const std::string& world, std::uint64_t seed) {
  const TangentTissue tissue = tissue_of(alpha_n, beta_per_m);
  std::string names;
  for (const sim::TissueWorld& known : sim::tissue_worlds()) {
    names += (names.empty() ? "" : ", ") + known.name;
    if (known.name != world) continue;
    auto made = without_gil([&] {
      Random random = make_random(seed, "python");
      return sim::press_in_world(known, sim::Pressing::swells, tissue, random);
    });
    return py::make_tuple(Presses{std::move(made.record)}, Presses{std::move(made.truth)},
                          made.last_press);
  }
  throw Refused{{Fault::usage, fmt::format("world is {}; one of {} is needed", world, names)}};
}

}  // namespace

PYBIND11_MODULE(simulation, module) {
  module.doc() =
      "A world without hardware: people, scans, presses and whole massages, with their truth.\n"
      "SI units; places in couch. The same seed gives the same world.";
  const py::object error = py::module_::import("tuina._tuina").attr("Error");
  register_error(py::object(error).release().ptr());  // which is never given back
  module.def("person", &person, py::arg("person") = "phantom:medium",
             py::arg("position") = py::none(), py::arg("seed") = 1,
             "A person with known points: phantom:slim, phantom:medium or phantom:hefty, drawn by "
             "the seed, or a labelled body FILE.ply. position: sitting or prone.");
  module.def("scan", &scan, py::arg("person"), py::arg("seed") = 1,
             "The person as the simulated laser scanner with its calibration errors sees them, in "
             "couch, m.");
  module.def(
      "presses", &presses, py::arg("alpha_n"), py::arg("beta_per_m"), py::arg("world") = "control",
      py::arg("seed") = 1,
      "Presses of tissue in a world of docs/tissue_measured.md, at 1 kHz with the noise of "
      "sensors; alpha and beta are drawn around those given, with 15 % and 8 % of deviation.\n"
      "Returns what the sensors said, what was true, and the sample at which the last press "
      "begins.");
  add_sessions(module);
}

}  // namespace tuina::python
