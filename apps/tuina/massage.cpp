// SPDX-License-Identifier: Apache-2.0
#include <filesystem>
#include <optional>

#include "apps/cli/asked_to_end.hpp"
#include "apps/cli/fixed_points.hpp"
#include "apps/cli/position_option.hpp"
#include "apps/cli/say.hpp"
#include "apps/serve/live_option.hpp"
#include "apps/serve/shown_sentence.hpp"
#include "apps/simulated/keyboard.hpp"
#include "apps/simulated/pace_option.hpp"
#include "apps/simulated/ros2_option.hpp"
#include "apps/simulated/session_files.hpp"
#include "apps/simulated/session_replay.hpp"
#include "apps/simulated/simulated_session.hpp"
#include "apps/simulated/watched_session.hpp"
#include "apps/tuina/history/visit_option.hpp"
#include "apps/tuina/verbs.hpp"
#include "tuina/core/io/unfinished_file.hpp"
#include "tuina/history/visit.hpp"

namespace tuina::app {
namespace {

/// The whole session: scan, map, plan, massage, report.
class Massage final : public Verb {
 public:
  [[nodiscard]] const char* name() const override { return "massage"; }
  [[nodiscard]] const char* summary() const override {
    return "scan a person, plan and give a massage, write the report: simulated, or with devices";
  }
  [[nodiscard]] const char* example() const override {
    return "tuina massage --person phantom:hefty --position prone --programme relax --out "
           "my-report";
  }
  void describe(Options& options) override {
    auto replay = options.add(
        "--replay", replay_,
        "the folder of a session or its session.mcap: the same once more, with its seed and live "
        "commands, compared");
    options
        .add("--person", order_.person,
             "phantom:slim, phantom:medium, phantom:hefty, or a labelled body FILE.ply")
        .show_default();
    position_.describe(options, "auto: recognised from the scan");
    options.add("--programme", order_.programme, "a shipped programme or a TOML file")
        .show_default();
    add_robot_option(options, order_.robot);
    options.add("--no-go", order_.no_go, "a TOML file with what must not be touched");
    options.add("--consent", order_.consent,
                "a TOML file with the answers to the health questions; without it the "
                "simulated person answers");
    options.add("--robot-pose", order_.robot_pose,
                "where the robot stands: a file of `tuina calibrate --robot`; without it the "
                "simulated robot was measured as well");
    options
        .add("--adaptive", adaptive_,
             "on: what the presses feel decides how hard they may be; off: as planned")
        .one_of({"on", "off"})
        .show_default();
    options.flag("--keys", order_.keys, fmt::format("live, at real pace: {}", key_help));
    describe_body(options);
    options.add("--method", method_, "of finding acupoints").one_of({"field_morphing", "surface"});
    options.add("--atlas", order_.atlas,
                "an atlas file or a labelled body instead of the shipped atlas");
    pace_.describe(options, "max, with --keys or --live real, unless given");
    auto processes = options.flag("--processes", order_.processes,
                                  "guard and robot as processes of their own, `tuina guard` "
                                  "and `tuina robot simulate`");
    options.add("--link", order_.link, "name of the memory that these share").needs(processes);
    replay.excludes(visit_.describe(options));
    fixed_.describe(options);
    describe_devices(options, processes);
    ros2_.describe(options, "what happens, and offer services for live commands,");
    auto live = live_.describe(options).excludes(replay);
    live.excludes(options.named("--keys"));
    options
        .add("--out", out_,
             "folder for session.json, scan.ply, acupoints.json, plan.json, trace.csv, joints.csv, "
             "distances.csv, session.mcap, report.html")
        .show_default();
    // What a recorded session tells by itself.
    for (const char* recorded :
         {"--person", "--position", "--programme", "--robot", "--no-go", "--consent",
          "--robot-pose", "--keys", "--method", "--atlas", "--adaptive", "--body-mass-index",
          "--body-fat-percent", "--device", "--calibration", "--fix", "--fix-error-mm"}) {
      replay.excludes(options.named(recorded));
    }
  }

  [[nodiscard]] Result<Answer> run(const CommonOptions& given) override {
    begun_at_ = std::filesystem::file_time_type::clock::now();
    CommonOptions common = given;
    auto config = effective_config(common);
    if (!config) return tl::unexpected(config.error());
    take_words();
    if (order_.processes || !order_.device.empty()) {
      if (const auto suits = suits_other_arms(order_.pace); !suits)
        return tl::unexpected(suits.error());
    }
    std::optional<RecordedSession> recorded;
    if (!replay_.empty()) {
      auto session = recorded_session(given);
      if (!session) return tl::unexpected(session.error());
      recorded.emplace(std::move(*session));
      recorded->order.pace = order_.pace;
      order_ = recorded->order;
      *config = recorded->config;
      common.seed = recorded->seed;
    }
    const auto made = make_folder();
    if (!made) return tl::unexpected(made.error());
    const auto nothing_done = [&](const Error& error) {
      std::error_code fault;
      if (*made) std::filesystem::remove(out_, fault);
      if (!std::filesystem::exists(out_, fault) || std::filesystem::is_empty(out_, fault))
        visit_.take_back();
      return tl::unexpected(error);
    };
    auto fixed = fixed_.read();
    if (!fixed) return nothing_done(fixed.error());
    order_.fixed = std::move(*fixed);
    if (const auto begun = visit_.begin(order_, out_); !begun) return nothing_done(begun.error());
    if (!common.quiet && !visit_.remembered().empty())
      say(fmt::format("{}\n", visit_.remembered()));
    const auto begun = live_.asked() ? ros2_.begin() : ros2_.begin(out_);
    if (!begun) return nothing_done(begun.error());
    const auto open = live_.begin(order_, *config, common, ros2_, out_);
    if (!open) return nothing_done(open.error());
    end_when_asked();
    auto result =
        run_session(order_, *config, common, std::filesystem::path(out_) / "session.mcap",
                    until_asked_to_end(live_.asked() ? live_.attendant() : ros2_.attendant()));
    ros2_.end_session();
    if (!result) {
      live_.end("failed", {{sentence_of(result.error())}});
      return nothing_done(with_record(visit_.with_remembered(result.error())));
    }

    record::SessionFile file = session_file(*result, order_, common.seed);
    file.visit = visit_.label();
    Answer answer{.json = record::to_json(file),
                  .text = session_text(file),
                  .exit_code = result->session.stops.empty() ? 0 : 4};
    if (auto written = write_session(*result, *config, answer.json, out_); !written) {
      // What the session has recorded is kept, as far as it goes.
      static_cast<void>(finish_record(*result, out_));
      return tl::unexpected(with_record(written.error()));
    }
    if (const auto kept = finish_record(*result, out_); !kept) {
      return tl::unexpected(kept.error());
    }
    if (const std::uint64_t missing = result->recorder->missing_ms(); missing > 0)
      answer.text += fmt::format("\n{} ms are missing in session.mcap", missing);
    if (ros2_.node() != nullptr) answer.text += "\n" + ros2_.text(result->untold_ms);
    if (visit_.label()) {
      const auto told = visit_.end(file);
      if (!told) return tl::unexpected(told.error());
      answer.text += "\n" + *told;
    }
    if (recorded) {
      const auto differ = differences(recorded->json, answer.json);
      answer.text += differ.empty() ? "\nas recorded"
                                    : fmt::format("\n{} values differ from the record, first {}",
                                                  differ.size(), differ.front());
    }
    answer.text +=
        fmt::format("\nreport: {}", (std::filesystem::path(out_) / "report.html").string());
    live_.end(answer.exit_code == 0 ? "done" : "stopped", session_lines(file));
    return answer;
  }

 private:
  /// An error that ended a session, and where what was recorded until then is; a record of another
  /// session in this folder is not meant.
  [[nodiscard]] Error with_record(Error error) const {
    for (const char* name : {"session.mcap", "session.mcap.part"}) {
      const auto record = std::filesystem::path(out_) / name;
      std::error_code fault;
      const auto written = std::filesystem::last_write_time(record, fault);
      if (fault || written < begun_at_) continue;
      error.message += fmt::format("; its record is {}", record.string());
      break;
    }
    return error;
  }

  void describe_body(Options& options) {
    options
        .add("--body-mass-index", order_.facts.mass_index,
             "of the person, kg/m^2, if known: a help in telling the body condition")
        .between(10.0, 80.0);
    options.add("--body-fat-percent", order_.facts.fat_percent, "likewise").between(2.0, 70.0);
  }
  void describe_devices(Options& options, const Option& processes) {
    options
        .add("--device", order_.device,
             "a TOML file that names the arms (docs/armlink.md), in place of those simulated here: "
             "person, robot and seed must be theirs; one that names camera and turntable, too, has "
             "nothing simulated, and needs --consent, --calibration and --robot-pose")
        .excludes(processes);
    options.add("--calibration", order_.calibration, "of the scanner that --device names")
        .needs(options.named("--device"));
  }
  void take_words() {
    order_.position = position_.position();
    order_.method = body::parse_method(method_).value_or(order_.method);
    const bool steered = order_.keys || live_.asked();
    order_.pace = pace_.pace(steered ? std::optional(1.0) : std::nullopt);
    order_.adaptive = adaptive_ == "on";
  }
  /// Before the work, not after it: the folder of `--out`. True if it was not there.
  [[nodiscard]] Result<bool> make_folder() const {
    namespace fs = std::filesystem;
    std::error_code fault;
    const bool made = fs::create_directories(out_, fault);
    if (!fs::is_directory(out_))
      return fail(Fault::file, "--out {}: the folder cannot be made: {}", out_, fault.message());
    if (const auto free = history::is_free(out_); !free) return tl::unexpected(free.error());
    // Of a session that was killed there may be a record, and it may be all that is left of it.
    for (const char* name : record::files_of_session) {
      if (const auto can = check_can_begin(fs::path(out_) / name); !can)
        return tl::unexpected(can.error());
    }
    // Answers about somebody's health are nobody else's business.
    if (made && visit_.of_somebody()) fs::permissions(out_, fs::perms::owner_all, fault);
    return made;
  }
  /// The session of --replay, where the other options leave it as it is.
  [[nodiscard]] Result<RecordedSession> recorded_session(const CommonOptions& given) const {
    const CommonOptions usual;
    if (!given.config_file.empty() || !given.settings.empty() || given.seed != usual.seed)
      return fail(Fault::usage, "--replay: the session has its own seed and configuration");
    std::error_code same;
    if (std::filesystem::equivalent(replay_, out_, same) ||
        std::filesystem::equivalent(replay_, std::filesystem::path(out_) / "session.mcap", same))
      return fail(Fault::usage, "--out {}: is the session that is given once more", out_);
    return read_session(replay_);
  }

  Ros2Option ros2_;
  LiveOption live_;
  PaceOption pace_;
  SessionOrder order_;
  VisitOption visit_;
  FixedPoints fixed_;
  std::string replay_;
  PositionOption position_;
  std::string method_;
  std::string adaptive_ = "on";
  std::string out_ = "massage-report";
  std::filesystem::file_time_type begun_at_;
};

}  // namespace

std::unique_ptr<Verb> make_massage() {
  return std::make_unique<Massage>();
}

}  // namespace tuina::app
