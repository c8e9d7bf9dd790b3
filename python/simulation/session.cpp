// SPDX-License-Identifier: Apache-2.0
#include "python/simulation/session.hpp"

#include "apps/simulated/session_files.hpp"
#include "apps/simulated/simulated_session.hpp"
#include "tuina/control/arm_controller.hpp"
#include "tuina/history/visit.hpp"
#include "tuina/record/acupoint_file.hpp"
#include "tuina/record/plan_file.hpp"

namespace tuina::python {
namespace {

/// A contact that has ended, for whoever is asked what comes next.
struct Contact {
  session::Performed performed;
  std::string path;
};

/// A session that was given.
struct Given {
  std::string json;
  SurfaceFile scan;
  record::MapFile map;
  record::PlanFile plan;
  std::vector<Contact> contacts;
  std::vector<std::string> stops;
  double massage_s = 0.0;
  std::vector<double> acupoint_errors_m;
  PerArm<std::vector<telemetry::TraceRow>> trace;
};

/// Asks a function of Python after each contact; what it raises ends the session. Every half second
/// of the session it looks whether somebody has pressed Ctrl-C.
class Therapist final : public session::Observer {
 public:
  explicit Therapist(const py::object& on_contact) : on_contact_(on_contact) {}

  void on_plan(const motion::ReadyPlan& ready, const Transform& /*base_from_couch*/) override {
    plan_ = &ready.plan;
  }
  void on_performed(const session::Performed& performed) noexcept override {
    if (on_contact_.is_none() || raised_) return;
    const py::gil_scoped_acquire held;
    try {
      const py::object answer = on_contact_(contact_of(performed));
      if (!answer.is_none()) command_ = command_of(answer);
    } catch (py::error_already_set& error) {
      stop(error);
    }
  }
  [[nodiscard]] std::optional<session::LiveCommand> next_command() {
    constexpr int ticks_between_looks = 500;
    if (++ticks_ % ticks_between_looks == 0) (void)interrupted();
    return std::exchange(command_, std::nullopt);
  }
  [[nodiscard]] bool interrupted() {
    if (raised_) return true;
    const py::gil_scoped_acquire held;
    if (PyErr_CheckSignals() != 0) {
      py::error_already_set error;
      stop(error);
    }
    return raised_.has_value();
  }
  /// Raises what a function of Python has raised.
  void raise() {
    if (raised_) throw py::error_already_set(*raised_);
  }
  [[nodiscard]] Contact contact_of(const session::Performed& performed) const {
    return {performed, plan_->paths[static_cast<std::size_t>(performed.path)].path.name};
  }

 private:
  void stop(py::error_already_set& error) {
    raised_.emplace(error);
    command_ = session::LiveCommand::stop;
  }
  static session::LiveCommand command_of(const py::object& answer) {
    std::string names;
    for (std::size_t i = 0; i < session::live_command_names.size(); ++i) {
      const std::string name = session::live_command_names[i];
      if (py::isinstance<py::str>(answer) && answer.cast<std::string>() == name)
        return static_cast<session::LiveCommand>(i);
      names += (i > 0 ? ", " : "") + name;
    }
    PyErr_SetString(PyExc_ValueError,
                    fmt::format("on_contact returned {}; None or one of {} is needed",
                                py::repr(answer).cast<std::string>(), names)
                        .c_str());
    throw py::error_already_set();
  }

  const py::object& on_contact_;
  const massage::Plan* plan_ = nullptr;
  std::optional<session::LiveCommand> command_;
  std::optional<py::error_already_set> raised_;
  int ticks_ = 0;
};

/// What Python sees of a session.
Given given_of(app::SessionResult& result, std::string json) {
  session::Session& session = result.session;
  Given given{.json = std::move(json),
              .scan = {.cloud = session.scan.cloud_in_couch},
              .map = {.mapping = session.located,
                      .points = session.scan.cloud_in_couch.size(),
                      .compute_ms = session.locate_ms},
              .plan = record::plan_file_of(session.ready, session.plan_ms),
              .massage_s = session.massage_s,
              .acupoint_errors_m = result.truth.acupoint_errors_m};
  for (const session::Performed& done : session.performed) {
    const auto& path = session.ready.plan.paths[static_cast<std::size_t>(done.path)].path;
    given.contacts.push_back({done, path.name});
  }
  for (const session::Stop& stop : session.stops)
    given.stops.push_back(session::explain(stop).words);
  for (const telemetry::TraceRow& row : result.truth.trace) given.trace[row.arm].push_back(row);
  return given;
}

/// What is ordered, by the words of `tuina massage`.
struct Words {
  std::string person, programme, robot;
  std::optional<std::string> position;
  std::string method;
  std::string no_go, atlas;
  bool adaptive = true;

  [[nodiscard]] app::SessionOrder order() const {
    const auto known = body::parse_method(method);
    if (!known) {
      throw Refused{
          {Fault::usage, fmt::format("method is {}; surface or field_morphing is needed", method)}};
    }
    return {.person = person,
            .position = posture_of(position),
            .programme = programme,
            .robot = robot,
            .method = *known,
            .atlas = atlas,
            .no_go = no_go,
            .adaptive = adaptive};
  }
};

Given massage(const Words& words, std::uint64_t seed, const session::Config& config,
              const std::optional<std::string>& out, const py::object& on_contact) {
  const app::SessionOrder order = words.order();
  Therapist therapist(on_contact);
  auto given = without_gil([&] {
    const std::filesystem::path folder = out.value_or("");
    std::error_code fault;
    if (out && !std::filesystem::create_directories(folder, fault) &&
        !std::filesystem::is_directory(folder))
      throw Refused{{Fault::file, fmt::format("{}: the folder cannot be made: {}", folder.string(),
                                              fault.message())}};
    if (out) {
      if (const auto free = history::is_free(folder); !free) throw Refused{free.error()};
    }
    auto result = app::run_simulated_session(
        order, config, {.quiet = true, .seed = seed}, out ? folder / "session.mcap" : folder,
        {.waits = &therapist,
         .commands = [&](double) { return therapist.next_command(); },
         .ends_scan = [&] { return therapist.interrupted(); }});
    if (!result) {
      return Result<Given>(tl::unexpected(result.error()));
    }
    std::string json = record::to_json(app::session_file(*result, order, seed));
    if (out) {
      value_of(app::write_session(*result, config, json, folder));
      value_of(app::finish_record(*result, folder));
    }
    return Result<Given>(given_of(*result, std::move(json)));
  });
  therapist.raise();
  return value_of(std::move(given));
}

void add_contact(py::module_& module) {
  py::class_<Contact>(module, "Contact", "How one path of the plan went, in session time.")
      .def_readonly("path", &Contact::path, "Its name, press BL47_L.")
      .def_property_readonly(
          "arm", [](const Contact& self) { return name_of(self.performed.arm); }, "left or right.")
      .def_property_readonly(
          "begin_s", [](const Contact& self) { return self.performed.begin_s; }, "First touch, s.")
      .def_property_readonly(
          "end_s", [](const Contact& self) { return self.performed.end_s; }, "s")
      .def_property_readonly(
          "contact_fault",
          [](const Contact& self) { return control::name_of(self.performed.contact_fault); },
          "Why it was cut short, or none.")
      .def_property_readonly(
          "whole", [](const Contact& self) { return self.performed.whole; },
          "Every point of the path was served.")
      .def_property_readonly(
          "felt", [](const Contact& self) { return self.performed.felt; },
          "The tissue after the last press; None: only pressing feels it.");
}

void add_given(py::module_& module) {
  const auto trace_of = [](const py::object& self, const std::string& arm) {
    for (const Arm known : both_arms)
      if (arm == name_of(known)) return std::cref(self.cast<Given&>().trace[known]);
    throw Refused{{Fault::usage, fmt::format("arm is {}; left or right is needed", arm)}};
  };
  py::class_<Given>(module, "Session", "A massage that was given, with the truth beside it.")
      .def(
          "to_json", [](const Given& self) { return self.json; },
          "The text of session.json, as `tuina massage --json` prints it.")
      .def_readonly("scan", &Given::scan, "What the scanner saw, in couch, m.")
      .def_readonly("mapping", &Given::map, "The acupoints that were found.")
      .def_readonly("plan", &Given::plan)
      .def_readonly("contacts", &Given::contacts, "In the order of their ends.")
      .def_readonly("stops", &Given::stops, "Stops, a sentence each.")
      .def_readonly("massage_s", &Given::massage_s, "Robot time at the end, s.")
      .def_property_readonly(
          "acupoint_errors_m",
          [](const py::object& self) { return view(self.cast<Given&>().acupoint_errors_m, self); },
          "How far each acupoint was found from the true one, m: N, a view.")
      .def(
          "trace",
          [trace_of](const py::object& self, const std::string& arm) {
            using Row = telemetry::TraceRow;
            const std::vector<Row>& rows = trace_of(self, arm);
            py::dict columns;
            columns["time_s"] = view(rows, &Row::time_s, self);
            columns["target_n"] = view(rows, &Row::target_n, self);
            columns["true_force_n"] = view(rows, &Row::true_force_n, self);
            columns["measured_force_n"] = view(rows, &Row::measured_force_n, self);
            columns["depth_m"] = view(rows, &Row::depth_m, self);
            columns["tool_in_couch"] = view(rows, &Row::tool_in_couch, self);
            return columns;
          },
          py::arg("arm"),
          "The rows of trace.csv of one arm, left or right, as views: s, N, m; tool_in_couch is "
          "N x 3.");
}

}  // namespace

void add_sessions(py::module_& module) {
  add_contact(module);
  add_given(module);
  module.def(
      "massage",
      [](const std::string& person, const std::string& programme,
         const std::optional<std::string>& position, const std::string& robot,
         const std::string& method, std::uint64_t seed, const session::Config& config,
         bool adaptive, const std::string& atlas, const std::string& no_go,
         const std::optional<std::string>& out, const py::object& on_contact) {
        return massage({person, programme, robot, position, method, no_go, atlas, adaptive}, seed,
                       config, out, on_contact);
      },
      py::kw_only(), py::arg("person") = "phantom:medium", py::arg("programme") = "relax",
      py::arg("position") = py::none(), py::arg("robot") = "thesis", py::arg("method") = "surface",
      py::arg("seed") = 1, py::arg_v("config", session::Config{}, "tuina.Config()"),
      py::arg("adaptive") = true, py::arg("atlas") = "", py::arg("no_go") = "",
      py::arg("out") = py::none(), py::arg("on_contact") = py::none(),
      "Scans a simulated person, plans and gives a massage, as `tuina massage` does with the same "
      "words.\nout: a folder for session.mcap, report.html and the other files. on_contact: called "
      "with each Contact as it ends; it may return pause, resume, stop, skip, repeat, softer or "
      "firmer; the simulation waits for it. What it raises stops the arms, ends the session, and "
      "is "
      "raised again; the files are written all the same.");
}

}  // namespace tuina::python
