// SPDX-License-Identifier: Apache-2.0
#include "apps/evaluation/safety/sessions.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <mutex>
#include <optional>

#include "apps/evaluation/safety/search.hpp"
#include "apps/simulated/session_order.hpp"
#include "tuina/core/parallel.hpp"
#include "tuina/core/units.hpp"

namespace tuina::app {
namespace {

constexpr double max_release_s = 0.6, over_pressed_n = 2.0;

/// The true forces of a session, and the moment at which somebody asks for a stop: once an arm has
/// been in a phase for some time.
class Bystander final : public session::Observer {
 public:
  Bystander(const sim::World& world, std::optional<session::ArmPhase> stops_in)
      : world_(world), stops_in_(stops_in) {}

  void on_tick(const session::Tick& tick) noexcept override {
    double force_n = 0.0;
    for (const sim::ArmTruth& arm : world_.truth().arms.of)
      force_n = std::max(force_n, arm.contact.force_n);
    max_force_n = std::max(max_force_n, force_n);
    const double time_s = tick.reading.time_s;
    bool there = false;
    for (const session::ArmView& arm : tick.view.of) there = there || arm.phase == stops_in_;
    phase_s_ = there ? phase_s_ + control_period_s : 0.0;
    if (stops_in_ && asked_s < 0.0 && phase_s_ > 0.1) {
      asked_s = time_s;
      asked_at_n = force_n;
      asks_ = true;
    }
    if (asked_s < 0.0) return;
    max_after_n = std::max(max_after_n, force_n);
    if (force_n > 0.0) released_s = time_s - asked_s;
  }
  [[nodiscard]] std::optional<session::LiveCommand> command() {
    if (!asks_) return std::nullopt;
    asks_ = false;
    return session::LiveCommand::stop;
  }

  double max_force_n = 0.0;
  double asked_s = -1.0, asked_at_n = 0.0, max_after_n = 0.0, released_s = 0.0;

 private:
  const sim::World& world_;
  std::optional<session::ArmPhase> stops_in_;
  double phase_s_ = 0.0;
  bool asks_ = false;
};

/// What one session is given, beside the usual.
struct SessionTrial {
  int number = 0;
  const char* name = "";
  const char* state = "";
  std::optional<session::ArmPhase> stops_in = {};
  double moved_m = 0.0;        ///< after the scan, before the first touch
  bool somebody_else = false;  ///< lies there
};

const std::vector<SessionTrial>& session_trials() {
  using session::ArmPhase;
  static const std::vector<SessionTrial> all = {
      {.number = 37, .name = "asked to stop", .state = "travel", .stops_in = ArmPhase::travel},
      {.number = 37, .name = "asked to stop", .state = "approach", .stops_in = ArmPhase::approach},
      {.number = 37, .name = "asked to stop", .state = "contact", .stops_in = ArmPhase::contact},
      {.number = 37, .name = "asked to stop", .state = "retract", .stops_in = ArmPhase::retract},
      {.number = 25, .name = "15 mm nearer than scanned", .state = "session", .moved_m = 15_mm},
      {.number = 25, .name = "15 mm farther than scanned", .state = "session", .moved_m = -15_mm},
      {.number = 25, .name = "scan of somebody else", .state = "session", .somebody_else = true},
  };
  return all;
}

void judge(const SessionTrial& trial, const Bystander& saw, const session::Session& session,
           SessionCell& cell) {
  if (trial.stops_in) {
    cell.found = fmt::format("asked at {:.1f} N, contact over after {:.0f} ms, at most {:.1f} N",
                             saw.asked_at_n, 1e3 * saw.released_s, saw.max_after_n);
    if (saw.asked_s < 0.0) cell.broken.emplace_back("no arm was ever in that phase");
    if (saw.released_s > max_release_s)
      cell.broken.push_back(fmt::format("contact for {:.0f} ms more, {:.0f} allowed",
                                        1e3 * saw.released_s, 1e3 * max_release_s));
    if (saw.max_after_n > saw.asked_at_n + over_pressed_n)
      cell.broken.push_back(fmt::format("{:.1f} N, {:.1f} allowed", saw.max_after_n,
                                        saw.asked_at_n + over_pressed_n));
    if (session.stops.empty()) cell.broken.emplace_back("no stop is told");
    return;
  }
  const bool noticed = !session.rescans_s.empty() || !session.stops.empty();
  const double trip_n = safety::ceiling_of(safety::Zone::muscle).trip_n;
  cell.found = fmt::format("{} scanned again, {} stops, at most {:.1f} N", session.rescans_s.size(),
                           session.stops.size(), saw.max_force_n);
  if (!noticed) cell.broken.emplace_back("nobody notices");
  if (saw.max_force_n > trip_n)
    cell.broken.push_back(fmt::format("{:.1f} N, {:.0f} allowed", saw.max_force_n, trip_n));
}

Result<SessionCell> run_session_cell(const SessionTrial& trial, std::uint64_t seed,
                                     session::Config config) {
  config.simulation.shift_mm = to_mm(trial.moved_m);
  config.simulation.shift_at_s = 0.5;
  const CommonOptions common{.quiet = true, .seed = seed};
  SessionOrder order{.person = "phantom:medium", .position = BodyPosture::prone};
  auto room = make_room(order, config, common);
  if (!room) return tl::unexpected(room.error());
  order.person = "phantom:hefty";
  auto other = make_room(order, config, common);
  if (!other) return tl::unexpected(other.error());
  sim::World& lies_there = trial.somebody_else ? *other->world : *room->world;
  Bystander saw(lies_there, trial.stops_in);
  room->order.commands = [&saw](double) { return saw.command(); };
  const auto session =
      session::run({room->world->camera(), room->world->turntable(), lies_there.robot()},
                   room->order, config, saw);
  if (!session) return tl::unexpected(session.error());
  SessionCell cell{
      .number = trial.number, .name = trial.name, .state = trial.state, .person = "prone medium"};
  judge(trial, saw, *session, cell);
  return cell;
}

/// What people do who are treated; nobody may be stopped for breathing or shifting.
const std::array<FaultClass, 3>& habits() {
  static const std::array<FaultClass, 3> all = {
      FaultClass{.number = 14,
                 .name = "breathes",
                 .injection = {.breathing = {.amplitude_m = 12_mm, .frequency_hz = 0.5}},
                 .stages = {Stage::contact}},
      FaultClass{.number = 15,
                 .name = "coughs",
                 .injection = {.person = PersonMove{15_mm, 0.15, 2.0 * gravity_m_per_s2, 0.15}},
                 .stages = {Stage::contact}},
      FaultClass{.number = 14,
                 .name = "shifts",
                 .injection = {.person = PersonMove{10_mm, 0.05, 0.2 * gravity_m_per_s2}},
                 .stages = {Stage::contact}}};
  return all;
}

}  // namespace

Result<std::vector<SessionCell>> run_session_cells(std::uint64_t seed,
                                                   const session::Config& config,
                                                   const Progress& progress) {
  std::vector<SessionCell> cells(session_trials().size());
  std::mutex guard;
  std::optional<Error> failure;
  for_each_in_parallel(
      cells.size(),
      [&](std::size_t k) {
        auto cell = run_session_cell(session_trials()[k], seed, config);
        const std::lock_guard lock(guard);
        if (cell) cells[k] = std::move(*cell);
        if (!cell && !failure) failure = cell.error();
      },
      progress);
  if (failure) return tl::unexpected(*failure);
  return cells;
}

Result<CleanSession> run_clean_session(std::uint64_t seed, const session::Config& config) {
  constexpr std::array people = {"phantom:slim", "phantom:medium", "phantom:hefty"};
  const SessionOrder order{.person = people[seed % people.size()],
                           .position = seed % 2 == 0 ? BodyPosture::sitting : BodyPosture::prone,
                           .programme = "full_back_20min"};
  auto room = make_room(order, config, {.quiet = true, .seed = seed});
  if (!room) return tl::unexpected(room.error());
  sim::World& world = *room->world;
  Bystander saw(world, std::nullopt);
  const auto session =
      session::run({world.camera(), world.turntable(), world.robot()}, room->order, config, saw);
  if (!session) return tl::unexpected(session.error());
  CleanSession clean{.person = fmt::format("{} {}", name_of(*order.position), order.person),
                     .massage_s = session->massage_s,
                     .max_force_n = saw.max_force_n};
  for (const session::Stop& stop : session->stops) clean.stops.push_back(explain(stop).words);
  return clean;
}

PersonRun draw_person(const std::vector<Site>& sites, std::uint64_t seed) {
  Random random = make_random(seed, "person");
  const FaultClass& habit = habits()[seed % habits().size()];
  PersonRun run{.does = habit.name, .plan = trial_of(habits()[0], sites, any_choices(random))};
  run.plan.whole = true;
  run.plan.press_s = run.plan.watched_s = 10.0;
  run.plan.seed = seed;
  if (&habit != habits().data())
    run.plan.onsets.push_back({.fault = &habit,
                               .later_s = uniform(random, 1.0, 6.0),
                               .severity = uniform(random, 0.3, 1.0)});
  return run;
}

}  // namespace tuina::app
