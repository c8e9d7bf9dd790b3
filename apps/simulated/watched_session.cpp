// SPDX-License-Identifier: Apache-2.0
#include "apps/simulated/watched_session.hpp"

#include <fmt/format.h>

#include <memory>
#include <optional>

#include "apps/cli/asked_to_end.hpp"
#include "apps/simulated/keyboard.hpp"
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

Result<std::string> text_of_programme(const std::string& name_or_file) {
  for (const massage::ShippedProgramme& shipped : massage::shipped_programmes())
    if (shipped.name == name_or_file) return std::string(shipped.toml);
  return read_file(name_or_file);
}

record::SessionStart start_of(const WatchedOrder& order) {
  return {.seed = order.common.seed,
          .version = TUINA_VERSION,
          .order = order.given,
          .answered_by = order.read.consent.answered_by,
          .robot = order.read.robot};
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
Result<std::unique_ptr<record::SessionRecorder>> recorder_of(const WatchedOrder& order) {
  if (order.record_file.empty()) return std::unique_ptr<record::SessionRecorder>();
  auto programme = text_of_programme(order.given.programme);
  if (!programme) return tl::unexpected(programme.error());
  return record::SessionRecorder::begin(
      order.record_file, start_of(order),
      {{"calibration.toml", scanner::to_toml(order.read.calibration)},
       {"config.toml", session::to_toml(order.config)},
       {"consent.toml", order.consent_toml},
       {"programme.toml", std::move(*programme)}});
}

}  // namespace

Attendant until_asked_to_end(Attendant attendant) {
  const auto once = [told = false](double) mutable -> std::optional<session::LiveCommand> {
    if (told || !asked_to_end()) return std::nullopt;
    told = true;
    return session::LiveCommand::stop;
  };
  attendant.commands = attendant.commands ? either(once, attendant.commands) : once;
  attendant.ends_scan = [others = std::move(attendant.ends_scan)] {
    return asked_to_end() || (others && others());
  };
  return attendant;
}

Result<void> run_watched(const session::Devices& devices, WatchedOrder order,
                         const std::vector<session::Observer*>& judges, SessionResult& result) {
  const Attendant& attendant = order.attendant;
  order.read.commands = either(attendant.commands, commands_of(order.given));
  if (attendant.reviews) order.read.review = attendant.reviews;
  auto recorder = recorder_of(order);
  if (!recorder) return tl::unexpected(recorder.error());
  JointRecorder joints;
  ProgressBars bars(order.common);
  session::Observer& terminal = bars;
  // A terminal or a page may be slow; the truth is read in the millisecond in which it is true.
  session::Relay watcher(attendant.watches != nullptr ? *attendant.watches : terminal);
  std::vector<session::Observer*> all = judges;
  all.insert(all.end(), {&joints, &watcher});
  if (attendant.waits != nullptr) all.push_back(attendant.waits);
  using Behind = session::Relay::Behind;
  const Behind behind = order.real_pace ? Behind::leave_out : Behind::wait;
  std::optional<session::Relay> record;
  if (*recorder) all.push_back(&record.emplace(**recorder, behind));
  std::optional<ToldChannels> channels;
  if (attendant.channels != nullptr) {
    channels.emplace(*attendant.channels, start_of(order), behind);
    all.push_back(&*channels->relay);
  }
  // Arms of another machine have a clock of their own; what came late of them, `devices` tells.
  std::optional<record::LateTicks> late;
  if (order.given.pace && order.given.device.empty())
    all.push_back(&late.emplace(*order.given.pace));
  session::Observers observers(all);
  EndingCamera camera(devices.camera, attendant.ends_scan);
  auto session =
      session::run({camera, devices.turntable, devices.robot, devices.supervisor, devices.lag_s},
                   order.read, order.config, observers);
  record.reset();
  if (channels) result.untold_ms = channels->end(joints.last_tick);
  if (!session) {
    // The error of the session is the one to show.
    if (*recorder && (*recorder)->ticks() > 0) (void)(*recorder)->finish(joints.last_tick);
    return tl::unexpected(session.error());
  }
  result.session = std::move(*session);
  if (late) result.late = late->found();
  result.recorder = std::move(*recorder);
  result.joints = std::move(joints.rows);
  result.last_tick = joints.last_tick;
  return {};
}

}  // namespace tuina::app
