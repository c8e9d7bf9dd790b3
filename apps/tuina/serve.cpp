// SPDX-License-Identifier: Apache-2.0
#include <chrono>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <thread>

#include "apps/cli/asked_to_end.hpp"
#include "apps/cli/position_option.hpp"
#include "apps/serve/live_site.hpp"
#include "apps/serve/make_password.hpp"
#include "apps/serve/page_port.hpp"
#include "apps/simulated/pace_option.hpp"
#include "apps/simulated/ros2_option.hpp"
#include "apps/tuina/history/fleet_reporter.hpp"
#include "apps/tuina/history/open.hpp"
#include "apps/tuina/history/people_of_page.hpp"
#include "apps/tuina/verbs.hpp"

namespace tuina::app {
namespace {

/// The live page of this machine.
class Serve final : public Verb {
 public:
  [[nodiscard]] const char* name() const override { return "serve"; }
  [[nodiscard]] const char* summary() const override {
    return "a page to start, watch and steer massages of simulated people in a browser";
  }
  [[nodiscard]] const char* example() const override { return "tuina serve --port 8642"; }
  [[nodiscard]] const char* alias() const override { return "dashboard"; }
  void describe(Options& options) override {
    add_page_port(options, port_);
    options
        .add("--listen", listen_,
             "address in numbers; another than 127.0.0.1 needs --certificate and --password-file")
        .show_default();
    auto certificate =
        options.add("--certificate", certificate_,
                    "PEM file of certificate and key: the page is shown by TLS only");
    auto password =
        options.add("--password-file", password_,
                    "file of --make-password: who knows a password of it comes in, too");
    certificate.needs(password);
    password.needs(certificate);
    auto made =
        options.add("--make-password", make_password_,
                    "ask for a password, write what it is known by into this file, and end");
    options.flag("--viewers", viewers_, "the password is for those who may watch and stop, no more")
        .needs(made);
    pace_.describe(options, "real unless given");
    add_robot_option(options, order_.robot);
    auto device = options.add("--device", order_.device,
                              "a TOML file that names the arms (docs/armlink.md), in place of "
                              "those simulated here; the page then chooses no person");
    options
        .add("--person", order_.person,
             "who is before these arms, which --seed and --robot must fit, too")
        .show_default()
        .needs(device);
    position_.describe(options, "of that person").needs(device);
    ros2_.describe(options, "the sessions, and offer services for live commands,");
    auto history = options.add("--history", history_,
                               "postgresql://... or a SQLite file: tell there what this robot "
                               "does, for `tuina fleet`; while the server is away it waits here");
    options.add("--called", machine_.name, "name of this robot among others; else the computer's")
        .needs(history);
    options.add("--calibration", order_.calibration,
                "file of the scanner's calibration: of the scanner that --device names; `tuina "
                "fleet` shows its age");
    options
        .add("--robot-pose", order_.robot_pose,
             "where the robot of --device stands: a file of `tuina calibrate --robot`")
        .needs(device);
    options.add("--out", out_, "folder for the sessions and audit.log").show_default();
    options.add("--page", page_,
                "folder of a page that was built, instead of the one that the program carries");
  }

  [[nodiscard]] Result<Answer> run(const CommonOptions& common) override {
    if (!make_password_.empty()) return made_password();
    auto config = effective_config(common);
    if (!config) return tl::unexpected(config.error());
    if (!page_.empty() && !std::filesystem::exists(std::filesystem::path(page_) / "page.js"))
      return fail(Fault::file, "--page {}: no page.js is in this folder; `./run serve` builds one",
                  page_);
    auto doors = doors_asked_for();
    if (!doors) return tl::unexpected(doors.error());
    auto robot = robot::load_robot(order_.robot);
    if (!robot) return tl::unexpected(robot.error());
    auto devices = devices_of(common.seed);
    if (!devices) return tl::unexpected(devices.error());
    std::error_code fault;
    std::filesystem::create_directories(out_, fault);
    if (!std::filesystem::is_directory(out_))
      return fail(Fault::file, "--out {}: the folder cannot be made: {}", out_, fault.message());
    if (const auto begun = ros2_.begin(); !begun) return tl::unexpected(begun.error());
    if (const auto told = begin_report(); !told) return tl::unexpected(told.error());
    LiveSession::Options session{.config = std::move(*config),
                                 .common = common,
                                 .pace = pace_.pace(1.0),
                                 .robot = order_.robot,
                                 .robot_model = std::move(*robot),
                                 .folder = out_,
                                 .devices = std::move(*devices)};
    report_sessions(session);
    if (!history_.empty()) session.people = people_of_page(history_);
    auto site = LiveSite::open({.place = std::move(doors->place),
                                .passwords = std::move(doors->passwords),
                                .page = page_,
                                .session = std::move(session),
                                .node = ros2_.node(),
                                .reach = ros2_.reach()});
    if (!site) return tl::unexpected(site.error());
    end_when_asked(AskedAgain::is_nothing_new);
    std::fputs(((*site)->invite() + "\n").c_str(), common.json ? stderr : stdout);
    std::fflush(stdout);
    std::fputs(fmt::format("{}  (Foxglove, Lichtblick: docs/page.md)\n", (*site)->program_address())
                   .c_str(),
               stderr);
    while (!asked_to_end()) {
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
      if (report_) report_->now(doing((*site)->session().state()));
    }
    const int port = (*site)->port();
    site->reset();
    report_.reset();
    std::string text = fmt::format("ended; sessions and audit.log are in {}", out_);
    if (ros2_.node() != nullptr) text += "\n" + ros2_.text();
    return Answer{.json = nlohmann::json{{"port", port}, {"folder", out_}}.dump(2),
                  .text = std::move(text)};
  }

 private:
  struct Doors {
    web::Place place;
    std::optional<web::Passwords> passwords;
  };

  static std::string doing(const LiveSession::State& state) {
    if (state.phase == LivePhase::ended) return "idle";
    return name_of(state.phase) + std::string(state.paused ? ", paused" : "");
  }

  // Arms that are missing when the server begins may be there when a session does.
  [[nodiscard]] Result<std::optional<ServedDevices>> devices_of(std::uint64_t seed) {
    order_.position = position_.position();
    if (!order_.device.empty()) {
      if (const auto suits = suits_other_arms(pace_.pace(1.0)); !suits)
        return tl::unexpected(suits.error());
    }
    return served_devices(order_, seed);
  }

  [[nodiscard]] Result<void> begin_report() {
    if (history_.empty()) return {};
    if (machine_.name.empty()) machine_.name = name_of_computer();
    if (auto good = history::check_name(machine_.name); !good) return good;
    if (!order_.calibration.empty()) {
      auto day = day_of_file(order_.calibration);
      if (!day) return tl::unexpected(day.error());
      machine_.calibrated = *day;
    }
    machine_.model = order_.robot;
    machine_.version = TUINA_VERSION;
    auto report = FleetReporter::open(history_, machine_);
    if (!report) return tl::unexpected(report.error());
    report_ = std::move(*report);
    return {};
  }
  /// The site tells the history of its sessions, if there is one.
  void report_sessions(LiveSession::Options& session) const {
    FleetReporter* report = report_.get();
    if (report == nullptr) return;
    session.begins = [report] { return report->begin_session(); };
    session.has_ended = [report](const SessionResult& result, const record::SessionFile& file) {
      return report->end_session(result, file);
    };
    session.has_failed = [report](const Error& error) { report->fail_session(error); };
  }

  // To a network by TLS and with a password, or to this machine alone.
  [[nodiscard]] Result<Doors> doors_asked_for() const {
    auto own = web::loopback_address(listen_);
    if (certificate_.empty()) {
      if (!own) return tl::unexpected(own.error());
      return Doors{.place = {.address = *own, .port = port_}, .passwords = {}};
    }
    auto certificate = web::Certificate::read(certificate_);
    if (!certificate) return tl::unexpected(certificate.error());
    auto passwords = web::Passwords::read(password_);
    if (!passwords) return tl::unexpected(passwords.error());
    return Doors{.place = {.address = own.value_or(listen_),
                           .port = port_,
                           .certificate = std::move(*certificate)},
                 .passwords = std::move(*passwords)};
  }

  [[nodiscard]] Result<Answer> made_password() const {
    const auto role = viewers_ ? web::Role::watch : web::Role::operate;
    if (auto made = make_password_file(make_password_, role); !made)
      return tl::unexpected(made.error());
    return Answer{.json = nlohmann::json{{"file", make_password_}}.dump(2),
                  .text = fmt::format("{}: for --password-file", make_password_)};
  }

  PaceOption pace_;
  bool viewers_ = false;
  Ros2Option ros2_;
  int port_ = 8642;
  std::string listen_ = "127.0.0.1";
  std::string certificate_, password_, make_password_;
  SessionOrder order_;  ///< of which a server knows robot and devices
  PositionOption position_;
  std::string out_ = "tuina-sessions";
  std::string page_;
  std::string history_;
  history::Machine machine_;
  std::unique_ptr<FleetReporter> report_;
};

}  // namespace

std::unique_ptr<Verb> make_serve() {
  return std::make_unique<Serve>();
}

}  // namespace tuina::app
