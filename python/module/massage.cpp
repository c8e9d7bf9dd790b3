// SPDX-License-Identifier: Apache-2.0
#include <chrono>

#include "apps/cli/command_line.hpp"
#include "python/module/parts.hpp"
#include "tuina/massage/programme.hpp"
#include "tuina/record/acupoint_file.hpp"
#include "tuina/record/plan_file.hpp"
#include "tuina/session/lay_plan.hpp"
#include "tuina/telemetry/plot/colours.hpp"

namespace tuina::python {
namespace {

/// A path of a plan; it lives as long as the plan.
using Path = massage::PlannedPath;

template <typename Map>
record::PlanFile lay(const Back& back, const Map& map, const massage::Programme& programme,
                     const std::string& robot, const session::Config& config,
                     const std::string& no_go) {
  return without_gil([&] {
    const auto model = value_of(robot::load_robot(robot));
    const auto options = value_of(session::plan_options(config, no_go));
    const auto start = std::chrono::steady_clock::now();
    const auto ready = value_of(
        session::lay_plan(back.surface, map.acupoints, map.landmarks, programme, model, options));
    const std::chrono::duration<double, std::milli> taken =
        std::chrono::steady_clock::now() - start;
    return record::plan_file_of(ready, taken.count());
  });
}

record::PlanFile lay_on_map(const Back& back, const record::MapFile& map,
                            const massage::Programme& programme, const std::string& robot,
                            const session::Config& config, const std::string& no_go) {
  return lay(back, map.mapping, programme, robot, config, no_go);
}

void add_programme(py::module_& module) {
  py::class_<session::Config>(module, "Config", "Everything that a configuration file may change.")
      .def(py::init([](const std::string& file, const std::vector<std::string>& settings) {
             return value_of(app::effective_config({.config_file = file, .settings = settings}));
           }),
           py::arg("file") = "", py::arg("settings") = std::vector<std::string>{},
           "The defaults with a TOML file over them, and settings such as "
           "\"safety.force_ceiling_n=30\" over both, as --set gives them.")
      .def("to_toml", &session::to_toml, "All of it as TOML, with the limits as comments.");
  py::class_<massage::Programme>(module, "Programme", "A massage as the therapist orders it.")
      .def_readonly("name", &massage::Programme::name)
      .def_readonly("description", &massage::Programme::description)
      .def_readonly("intensity", &massage::Programme::intensity,
                    "1 to 5; 3 leaves the forces as written.")
      .def_property_readonly(
          "techniques",
          [](const massage::Programme& self) {
            std::vector<std::string> names;
            for (const massage::Part& part : self.parts)
              names.emplace_back(name_of(part.technique));
            return names;
          },
          "Technique of each part, in order.");
  module.def(
      "load_programme",
      [](const std::string& name_or_file) {
        return value_of(massage::load_programme(name_or_file));
      },
      py::arg("name_or_file"), "A shipped programme by its name, or a TOML file by its path.");
  module.def(
      "parse_programme",
      [](const std::string& text, const std::string& name) {
        return value_of(massage::parse_programme(text, name));
      },
      py::arg("text"), py::arg("name") = "programme",
      "Reads a programme from TOML text; `name` stands for the file in errors. Everything wrong is "
      "in the one message, a line each.");
  module.def(
      "programme_names",
      [] {
        std::vector<std::string> names;
        for (const auto& shipped : massage::shipped_programmes()) names.emplace_back(shipped.name);
        return names;
      },
      "Names of the shipped programmes.");
  module.def(
      "technique_colours",
      [] {
        std::map<std::string, std::string> colours;
        for (const TechniqueRow& row : technique_table)
          colours.emplace(row.name, telemetry::css(row.colour));
        return colours;
      },
      "Each technique by its name with the colour that pictures and reports give it, as #rrggbb.");
}

void add_path(py::module_& module) {
  py::class_<Path>(module, "PlannedPath", "One technique at one place, with its arm and its time.")
      .def_property_readonly("name", [](const Path& self) { return self.path.name; })
      .def_property_readonly("technique",
                             [](const Path& self) { return name_of(self.path.technique); })
      .def_property_readonly("acupoints", [](const Path& self) { return self.path.acupoints; })
      .def_property_readonly(
          "arm", [](const Path& self) { return name_of(self.arm); }, "left or right.")
      .def_readonly("step", &Path::step, "Paths of one step run at the same time.")
      .def_readonly("start_s", &Path::start_s, "Time of the first touch, if all goes to plan, s.")
      .def_property_readonly(
          "zone", [](const Path& self) { return name_of(self.zone); },
          "Strictest zone that the path touches.")
      .def_readonly("cap_n", &Path::cap_n, "Largest force that may be asked for here, N.")
      .def_property_readonly("peak_n", &Path::ordered_n, "Largest force of the path, N.")
      .def_property_readonly(
          "time_s",
          [](const py::object& self) {
            return view(self.cast<Path&>().path.points, &ContactPoint::time_s, self);
          },
          "Times since the start of the path, s: N, a view.")
      .def_property_readonly(
          "at_in_couch",
          [](const py::object& self) {
            return view(self.cast<Path&>().path.points, &ContactPoint::at_in_couch, self);
          },
          "Places on the undeformed skin in couch, m: N x 3, a view.")
      .def_property_readonly(
          "normals_in_couch",
          [](const py::object& self) {
            return view(self.cast<Path&>().path.points, &ContactPoint::normal_in_couch, self);
          },
          "Unit normals there, out of the body: N x 3, a view.")
      .def_property_readonly(
          "force_n",
          [](const py::object& self) {
            return view(self.cast<Path&>().path.points, &ContactPoint::force_n, self);
          },
          "Force onto the person along minus the normal, N: N, a view.");
}

void add_plan(py::module_& module) {
  py::class_<record::PlanFile>(module, "Plan", "What two arms do, in the order of the steps.")
      .def_property_readonly("programme",
                             [](const record::PlanFile& self) { return self.plan.programme; })
      .def_property_readonly(
          "duration_s", [](const record::PlanFile& self) { return self.plan.duration_s; },
          "Time until both arms have left the skin for good, s.")
      .def_readonly("reachable", &record::PlanFile::reachable,
                    "Every path of the programme by the arm that it is given to.")
      .def_readonly("min_arm_distance_m", &record::PlanFile::min_arm_distance_m,
                    "Between the surfaces of the two arms, m.")
      .def_property_readonly(
          "paths",
          [](const py::object& self) {
            py::list paths;
            for (const Path& path : self.cast<record::PlanFile&>().plan.paths)
              paths.append(py::cast(path, py::return_value_policy::reference_internal, self));
            return paths;
          },
          "In the order of their steps.")
      .def_property_readonly(
          "notes", [](const record::PlanFile& self) { return words_of(self.plan.notes); },
          "Sentences for people: which force was lowered, which path bent, cut or left out, and "
          "why.")
      .def(
          "to_json", [](const record::PlanFile& self) { return record::to_json(self); },
          "The text of plan.json, as `tuina plan` writes it.");
}

}  // namespace

void add_massage(py::module_& module) {
  add_programme(module);
  add_path(module);
  add_plan(module);
  constexpr const char* what =
      "Lays a programme onto a back, for the arms of a robot that stands where its table wants "
      "it.\n"
      "robot: a shipped one or the file of its table; no_go: a TOML file with what must not be "
      "touched. Forces are lowered to the cap of the strictest zone that a path touches; the notes "
      "say so. Fails for a point that the map lacks and when nothing remains.";
  const auto add = [&](auto function) {
    module.def("plan", function, py::arg("back"), py::arg("map"), py::arg("programme"),
               py::arg("robot") = "thesis", py::arg_v("config", session::Config{}, "Config()"),
               py::arg("no_go") = "", what);
  };
  add(&lay_on_map);
  add(&lay<record::MappedBack>);
}

}  // namespace tuina::python
