// SPDX-License-Identifier: Apache-2.0
#include "apps/simulated/simulated_session.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "apps/simulated/devices/device_arms.hpp"
#include "apps/simulated/keyboard.hpp"
#include "apps/simulated/placed_arms.hpp"
#include "apps/simulated/robot_process.hpp"
#include "apps/simulated/truth_recorder.hpp"
#include "tuina/core/io/file.hpp"
#include "tuina/session/relay.hpp"

namespace tuina::app {
namespace {

using Commands = std::function<std::optional<session::LiveCommand>(double time_s)>;

/// Commands of a person at the terminal, or those of a session before.
Commands commands_of(const SessionOrder& order) {
  if (order.keys) {
    // Keys are read a hundred times a second; the terminal is the keyboard's from the first time
    // on.
    return [keyboard = std::make_shared<Keyboard>(),
            ticks = 0](double) mutable -> std::optional<session::LiveCommand> {
      constexpr int keys_every_ticks = 10;
      if (ticks++ % keys_every_ticks != 0) return std::nullopt;
      return keyboard->read();
    };
  }
  return [given = order.commands,
          next = std::size_t{0}](double time_s) mutable -> std::optional<session::LiveCommand> {
    if (next >= given.size() || time_s < given[next].first) return std::nullopt;
    return given[next++].second;
  };
}

/// Commands of either; those of the first go before.
Commands either(const Commands& first, const Commands& second) {
  if (!first) return second;
  return [first, second](double time_s) {
    const auto command = first(time_s);
    return command ? command : second(time_s);
  };
}

/// A bar on the terminal for each stage of a session.
class ProgressBars final : public session::Observer {
 public:
  explicit ProgressBars(const CommonOptions& common) {
    for (const session::Stage stage : shown) bars_.push_back(progress_bar(common, name_of(stage)));
  }
  void on_progress(session::Stage stage, double share) noexcept override {
    for (std::size_t i = 0; i < shown.size(); ++i) {
      if (shown[i] == stage && bars_[i]) bars_[i](share);
    }
  }

 private:
  // A plan is made in a tenth of a second.
  static constexpr std::array shown = {session::Stage::scan, session::Stage::map,
                                       session::Stage::massage};
  std::vector<Progress> bars_;
};

/// The joints, twenty times a second, and when the last millisecond was.
class JointRecorder final : public session::Observer {
 public:
  void on_tick(const session::Tick& tick) noexcept override {
    last_tick = tick.reading.tick;
    constexpr std::uint64_t rows_every_ticks = 50;
    if (tick.reading.tick % rows_every_ticks != 0) return;
    const auto& arms = tick.reading.arms;
    rows.push_back({.time_s = tick.reading.time_s,
                    .rail_m = tick.reading.rail_m,
                    .q_rad = {.of = {arms[Arm::left].q_rad, arms[Arm::right].q_rad}},
                    .torque_nm = tick.verdict.command.torque_nm});
  }
  std::vector<record::JointRow> rows;
  std::uint64_t last_tick = 0;  ///< of the session
};

/// A camera whose scan somebody may end.
class EndingCamera final : public scanner::Camera {
 public:
  EndingCamera(scanner::Camera& camera, const std::function<bool()>& ends)
      : camera_(camera), ends_(ends) {}
  [[nodiscard]] Result<scanner::Frame> next_frame(double timeout_s) override {
    if (ends_ && ends_()) return fail(Fault::stopped, "the scan was stopped");
    return camera_.next_frame(timeout_s);
  }

 private:
  scanner::Camera& camera_;
  const std::function<bool()>& ends_;
};

/// The processes that an order asks for; null when all is to happen in this one.
Result<std::unique_ptr<Processes>> processes_of(const SessionOrder& order,
                                                const CommonOptions& common) {
  if (!order.processes) return std::unique_ptr<Processes>();
  std::vector<std::string> same = {"--person",  order.person, "--robot",
                                   order.robot, "--seed",     fmt::format("{}", common.seed)};
  if (order.position) same.insert(same.end(), {"--position", name_of(*order.position)});
  if (!common.config_file.empty()) same.insert(same.end(), {"--config", common.config_file});
  for (const std::string& setting : common.settings) same.insert(same.end(), {"--set", setting});
  return Processes::start(same, order.pace ? link::Pace::real : link::Pace::max, order.link);
}

Result<std::string> text_of_programme(const std::string& name_or_file) {
  for (const massage::ShippedProgramme& shipped : massage::shipped_programmes())
    if (shipped.name == name_or_file) return std::string(shipped.toml);
  return read_file(name_or_file);
}

record::SessionStart start_of(const SessionOrder& order, const SimulatedRoom& room,
                              std::uint64_t seed) {
  return {.seed = seed,
          .version = TUINA_VERSION,
          .order = order,
          .answered_by = room.order.consent.answered_by,
          .robot = room.order.robot};
}

/// A session told to somebody's channels, behind a relay.
struct ToldChannels {
  ToldChannels(record::ChannelSink& sink, const record::SessionStart& start,
               session::Relay::Behind behind)
      : channels(sink, start), relay(std::in_place, channels, behind) {}
  /// How many milliseconds were left out of a session with that last one.
  std::uint64_t end(std::uint64_t last_tick) {
    relay.reset();
    channels.tell_gap(last_tick + 1);
    return channels.missing_ms();
  }
  record::SessionChannels channels;
  std::optional<session::Relay> relay;
};

/// A record of the session, begun with what is known before it; null without a file for it.
Result<std::unique_ptr<record::SessionRecorder>> recorder_of(const std::filesystem::path& file,
                                                             const SessionOrder& order,
                                                             const SimulatedRoom& room,
                                                             const session::Config& config,
                                                             std::uint64_t seed) {
  if (file.empty()) return std::unique_ptr<record::SessionRecorder>();
  auto programme = text_of_programme(order.programme);
  if (!programme) return tl::unexpected(programme.error());
  return record::SessionRecorder::begin(
      file, start_of(order, room, seed),
      {{"calibration.toml", scanner::to_toml(room.order.calibration)},
       {"config.toml", session::to_toml(config)},
       {"consent.toml", room.consent_toml},
       {"programme.toml", std::move(*programme)}});
}

/// A robot that is no part of this program; null and empty where all is to happen in this one.
struct FarRobot {
  std::unique_ptr<Processes> processes = {};
  std::unique_ptr<DeviceArms> arms = {};
  robot::Robot* robot = nullptr;
  link::Supervisor* supervisor = nullptr;
  const SharedTruth* truth = nullptr;
};

Result<FarRobot> far_robot(const SessionOrder& order, const session::Config& config,
                           const CommonOptions& common, const sim::World& world) {
  FarRobot far;
  if (loop_of(config) && (order.processes || !order.device.empty()))
    return fail(Fault::usage,
                "simulation.arms = {}: only arms that are simulated in this program take places",
                config.simulation.arms);
  if (!order.device.empty()) {
    auto arms = DeviceArms::open(order.device, world, world_name(order, world, common.seed));
    if (!arms) return tl::unexpected(arms.error());
    far.arms = std::move(*arms);
    far.robot = &far.arms->robot();
    far.supervisor = far.arms.get();
    far.truth = &far.arms->truth();
    return far;
  }
  auto processes = processes_of(order, common);
  if (!processes) return tl::unexpected(processes.error());
  if (!*processes) return far;
  far.processes = std::move(*processes);
  far.robot = &far.processes->robot();
  far.supervisor = &far.processes->robot();
  far.truth = &far.processes->truth();
  return far;
}

}  // namespace

std::optional<double> tool_to_acupoint_m(const SessionResult& result, std::size_t performed) {
  const session::Session& session = result.session;
  const auto& path =
      session.ready.plan.paths[static_cast<std::size_t>(session.performed[performed].path)].path;
  const Touched& touched = result.truth.touched[performed];
  if (path.technique != Technique::press || touched.peak_n <= 0.0) return std::nullopt;
  for (const Acupoint& truth : result.person.acupoints) {
    if (truth.name == path.acupoints.front())
      return (touched.at_in_couch - truth.at_in_couch).norm();
  }
  return std::nullopt;
}

double scan_to_touch_s(const SessionResult& result) {
  const session::Session& session = result.session;
  double first_s = session.massage_s;
  for (const session::Performed& done : session.performed)
    first_s = std::min(first_s, done.begin_s);
  const double compute_ms = session.scan.compute_ms + session.locate_ms + session.plan_ms;
  return session.scan.sweep_s + 1e-3 * compute_ms + first_s;
}

Result<SessionResult> run_simulated_session(const SessionOrder& order,
                                            const session::Config& config,
                                            const CommonOptions& common,
                                            const std::filesystem::path& record_file,
                                            const Attendant& attendant) {
  auto room = make_room(order, config, common);
  if (!room) return tl::unexpected(room.error());
  sim::World& world = *room->world;
  room->order.commands = either(attendant.commands, commands_of(order));
  room->order.review = attendant.reviews;

  TruthRecorder truth(world);
  JointRecorder joints;
  ProgressBars bars(common);
  SessionResult result{.person = world.person(),
                       .consent = room->order.consent,
                       .consent_toml = room->consent_toml,
                       .realism = config.simulation.realism};
  auto recorder = recorder_of(record_file, order, *room, config, common.seed);
  if (!recorder) return tl::unexpected(recorder.error());
  {
    // A terminal or a page may be slow; the truth is read in the millisecond in which it is true.
    session::Observer& terminal = bars;
    session::Relay watcher(attendant.watches != nullptr ? *attendant.watches : terminal);
    auto far = far_robot(order, config, common, world);
    if (!far) return tl::unexpected(far.error());
    std::optional<LinkedTruth> told;
    std::vector<session::Observer*> all = {&truth, &joints, &watcher};
    if (attendant.waits != nullptr) all.push_back(attendant.waits);
    using Behind = session::Relay::Behind;
    const Behind behind = order.pace ? Behind::leave_out : Behind::wait;
    std::optional<session::Relay> record;
    if (*recorder) all.push_back(&record.emplace(**recorder, behind));
    std::optional<ToldChannels> channels;
    if (attendant.channels != nullptr) {
      channels.emplace(*attendant.channels, start_of(order, *room, common.seed), behind);
      all.push_back(&*channels->relay);
    }
    if (far->truth != nullptr) {
      told.emplace(*far->truth, world);
      all.insert(all.begin(), &*told);
    }
    // Arms of another machine have a clock of their own; what came late of them, `devices` tells.
    std::optional<record::LateTicks> late;
    if (order.pace && order.device.empty()) all.push_back(&late.emplace(*order.pace));
    session::Observers observers(all);
    EndingCamera camera(world.camera(), attendant.ends_scan);
    std::optional<PlacedArms> placed;
    const auto loop = loop_of(config);
    if (loop)
      placed.emplace(world.robot(), robot::both_models(world.robot_table(), world.mount()), *loop,
                     common.seed);
    robot::Robot& robot = placed                  ? placed->robot
                          : far->robot != nullptr ? *far->robot
                                                  : world.robot();
    auto session = session::run({camera, world.turntable(), robot, far->supervisor,
                                 loop ? believed_lag_s(*loop, common.seed) : 0.0},
                                room->order, config, observers);
    record.reset();
    if (channels) result.untold_ms = channels->end(joints.last_tick);
    if (!session) {
      // The error of the session is the one to show.
      if (*recorder && (*recorder)->ticks() > 0) (void)(*recorder)->finish(joints.last_tick);
      return tl::unexpected(session.error());
    }
    result.session = std::move(*session);
    if (late) result.late = late->found();
    if (far->arms) result.devices = far->arms->record(told->missed());
  }
  result.recorder = std::move(*recorder);
  result.truth = truth.finish();
  result.joints = std::move(joints.rows);
  result.last_tick = joints.last_tick;
  return result;
}

}  // namespace tuina::app
