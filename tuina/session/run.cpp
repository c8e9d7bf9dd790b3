// SPDX-License-Identifier: Apache-2.0
#include "tuina/session/run.hpp"

#include <algorithm>
#include <utility>

#include "tuina/body/palpation.hpp"
#include "tuina/control/late_force.hpp"
#include "tuina/core/stopwatch.hpp"
#include "tuina/core/units.hpp"
#include "tuina/session/control_loop.hpp"
#include "tuina/session/guarded_field.hpp"
#include "tuina/session/performed_paths.hpp"
#include "tuina/session/scan_step.hpp"

namespace tuina::session {
namespace {

constexpr std::size_t max_rescans = 3;

/// A plan that two arms can carry out, of one scan and of what was said of it by hand.
struct Planned {
  body::Mapping located;
  robot::RobotPlacement placement;
  motion::ReadyPlan ready;
  std::vector<KnownPlace> known;
  double plan_ms = 0.0;
};

double distance_to(std::span<const Acupoint> points, const body::PalpatedPoint& fixed) {
  const auto found = std::find_if(points.begin(), points.end(),
                                  [&](const Acupoint& point) { return point.name == fixed.name; });
  return found == points.end() ? 0.0 : (found->at_in_couch - fixed.at_in_couch).norm();
}

/// Plan of the ordered programme on a mapped person, without the paths that are `done`. `rail_m`: a
/// robot that stands already keeps its base there; nothing before the first plan.
Result<Planned> plan_on(const MappedPerson& mapped, const ByHand& said, const Order& order,
                        const Config& config, std::optional<double> rail_m,
                        const std::vector<std::string>& done) {
  const Stopwatch watch;
  Planned planned{.located = mapped.located};
  if (!said.fixed.empty()) {
    auto fixed = body::fix_points(mapped.located, mapped.back, said.fixed);
    if (!fixed) return tl::unexpected(fixed.error());
    planned.located = std::move(*fixed);
  }
  massage::PlanOptions options = order.plan_options;
  options.no_go = said.no_go;
  auto plan = massage::plan(mapped.back, planned.located.acupoints, planned.located.landmarks,
                            order.programme, options);
  if (!plan) return tl::unexpected(plan.error());
  leave_out(*plan, done);
  planned.placement = robot::place_robot(order.robot, mapped.back.position(),
                                         head_at_plus_y(planned.located.acupoints));
  auto ready =
      motion::make_ready(std::move(*plan), mapped.back, planned.placement.mount,
                         robot::both_models(planned.placement.arm, planned.placement.mount),
                         order.placed.base_from_couch, from_mm(config.massage.standoff_mm), rail_m);
  if (!ready) return tl::unexpected(ready.error());
  planned.ready = std::move(*ready);
  std::vector<Sentence>& notes = planned.ready.plan.notes;
  if (!rail_m && !carried(order.said, mapped.located.acupoints, max_other_misfit_m)) {
    notes.push_back(sentence("note_said_dropped",
                             "what was said by hand in an earlier session is not used: the "
                             "acupoints lie otherwise to each other than then"));
  }
  Recognised known = recognised(order.known, mapped.back.position(), planned.located.acupoints);
  if (!known.note.empty()) notes.push_back(std::move(known.note));
  planned.known = std::move(known.places);
  for (const body::PalpatedPoint& point : said.fixed) {
    notes.push_back(sentence("note_by_hand", "{} was put by hand {:.0f} mm from where it was found",
                             point.name, to_mm(distance_to(mapped.located.acupoints, point))));
  }
  planned.plan_ms = 1e3 * watch.seconds();
  return planned;
}

/// Shows the plan until somebody says go, and plans anew for every change that is asked for.
Result<void> review(const MappedPerson& mapped, const Order& order, const Config& config,
                    Observer& observer, ByHand& said, Planned& planned) {
  const ByHand ordered = said;
  std::string refused;
  while (order.review) {
    const Review seen = order.review(planned.ready, refused);
    if (seen.answer == Review::Answer::go) break;
    if (seen.answer == Review::Answer::no)
      return fail(Fault::stopped, "the plan was not approved, and no arm has moved");
    ByHand wanted = joined(ordered, seen.wanted);
    auto changed = plan_on(mapped, wanted, order, config, std::nullopt, {});
    refused = changed ? "" : changed.error().message;
    if (!changed) continue;
    planned = std::move(*changed);
    said = std::move(wanted);
    observer.on_map(planned.located);
  }
  return {};
}

/// The guard is told of this back what it has to know, and of the robot.
Result<void> arm_guard(Devices devices, const Order& order, const Config& config,
                       const MappedPerson& mapped, const ByHand& said, const Planned& planned) {
  auto field = zone_field(mapped.back, planned.located.acupoints, planned.located.landmarks,
                          said.no_go, order.placed.base_from_couch);
  if (!field) return tl::unexpected(field.error());
  return devices.supervisor->arm({.arm = planned.placement.arm,
                                  .mount = planned.placement.mount,
                                  .options = {.obstacles = planned.placement.mount.obstacles,
                                              .max_set_force_n = config.safety.force_ceiling_n,
                                              .field = std::move(*field)}});
}

/// Scan, map, plan, review and arming of the guard; afterwards the arms may move. `rail_m` and
/// `done` as of `plan_on`; with a `rail_m`, that is after a person has moved, nobody reviews.
Result<void> prepare(Devices devices, const Order& order, const Config& config, Observer& observer,
                     std::optional<double> rail_m, const std::vector<std::string>& done,
                     Session& session) {
  auto mapped = scan_and_map(devices.camera, devices.turntable, order, config, observer);
  if (!mapped) return tl::unexpected(mapped.error());
  const BodyPosture position = mapped->back.position();
  if (order.placed.position != position)
    return fail(Fault::config, "the robot stands there for a person {}, and this one is {}",
                name_of(order.placed.position), name_of(position));
  const std::vector<Acupoint>& lies = mapped->located.acupoints;
  auto now = rail_m ? carried(session.said, lies, max_moved_misfit_m)
                    : carried(order.said, lies, max_other_misfit_m);
  if (!now && (rail_m || !order.review)) return tl::unexpected(now.error());
  if (!rail_m) now = joined(now.value_or(ByHand()), {order.plan_options.no_go, order.fixed});
  auto planned = plan_on(*mapped, *now, order, config, rail_m, done);
  if (!planned) return tl::unexpected(planned.error());
  if (!now->fixed.empty()) observer.on_map(planned->located);
  observer.on_progress(Stage::plan, 1.0);
  if (!rail_m) {
    auto looked_at = review(*mapped, order, config, observer, *now, *planned);
    if (!looked_at) return looked_at;
  }
  auto armed = arm_guard(devices, order, config, *mapped, *now, *planned);
  if (!armed) return armed;
  // Only now, so that a session whose second scan fails still tells of its first.
  session.said = {.by_hand = std::move(*now), .lay = lies};
  session.known = std::move(planned->known);
  session.scan = std::move(mapped->scan);
  session.locate_ms = mapped->locate_ms;
  session.located = std::move(planned->located);
  session.placement = planned->placement;
  session.base_from_couch = order.placed.base_from_couch;
  session.ready = std::move(planned->ready);
  session.plan_ms = planned->plan_ms;
  return {};
}

MassageOptions massage_options(const Order& order, const Config& config, const Session& session,
                               double lag_s) {
  return {.base_from_couch = session.base_from_couch,
          .rail_m = session.ready.rail_m,
          .standoff_m = from_mm(config.massage.standoff_mm),
          .force_ceiling_n = config.safety.force_ceiling_n,
          .steer = config.massage.steer,
          .adaptive = order.adaptive,
          .cautious = config.massage.cautious,
          .intensity = session.intensity,
          .controller = control::for_late_force({}, lag_s),
          .known = session.known};
}

/// How much of what happens in a massage observers were told.
struct Happened {
  std::optional<LiveCommand> commanded;
  std::size_t ended = 0, decided = 0, stopped = 0;

  [[nodiscard]] Tick tick(const robot::RobotReading& reading, const safety::RobotVerdict& verdict,
                          const MassageStep& massage) noexcept {
    const auto next = []<typename T>(const std::vector<T>& all, std::size_t& told) {
      return told < all.size() ? std::optional(all[told++]) : std::nullopt;
    };
    return {.reading = reading,
            .verdict = verdict,
            .view = massage.view(),
            .performed = massage.performed().size(),
            .intensity = massage.intensity(),
            .commanded = std::exchange(commanded, std::nullopt),
            .ended = next(massage.performed(), ended),
            .decided = next(massage.decisions(), decided),
            .stopped = next(massage.stops(), stopped)};
  }
};

/// Carries the plan of the session out. Returns whether the person lies elsewhere than scanned.
Result<bool> carry_out(Devices devices, const Order& order, const Config& config,
                       Observer& observer, Session& session) {
  const motion::ReadyPlan& ready = session.ready;
  const auto models = robot::both_models(session.placement.arm, session.placement.mount);
  MassageStep massage(ready.plan, ready.jobs, models,
                      massage_options(order, config, session, devices.lag_s));
  if (session.paused) massage.obey(LiveCommand::pause);
  observer.on_plan(ready, session.base_from_couch);
  // A contact that never ends, or is asked for again and again, must not hold anyone.
  const double max_s = 3.0 * ready.plan.duration_s + 60.0;
  const double began_s = session.massage_s;
  double ended_s = -1.0, paused_s = 0.0;
  bool late = false;
  std::size_t told = 0;
  Happened happened;
  const Stopwatch watch;

  const auto propose = [&](const robot::RobotReading& reading) {
    if (const auto command = order.commands ? order.commands(reading.time_s) : std::nullopt) {
      massage.obey(*command);
      if (*command == LiveCommand::stop) devices.supervisor->expect_stop();
      session.commands.emplace_back(reading.time_s, *command);
      happened.commanded = command;
    }
    return massage.propose(reading);
  };
  const auto look = [&](const robot::RobotReading& reading, const safety::RobotVerdict& verdict) {
    massage.heed(verdict);
    session.massage_s = reading.time_s;
    while (told < massage.performed().size()) observer.on_performed(massage.performed()[told++]);
    observer.on_tick(happened.tick(reading, verdict, massage));
    if (massage.finished() && !massage.wants_scan()) return false;
    if (massage.finished() && ended_s < 0.0) ended_s = reading.time_s;
    // While a new scan is due, the arms are held still for as long as a sweep takes.
    if (ended_s >= 0.0 && massage.wants_scan())
      return reading.time_s - ended_s < config.scan.sweep_s;
    if (massage.paused()) paused_s += control_period_s;
    const double past_s = reading.time_s - began_s - paused_s;
    if (!late && past_s >= max_s) {  // the tools leave the skin before anything else happens
      late = true;
      massage.obey(LiveCommand::stop);
      devices.supervisor->expect_stop();
    }
    constexpr std::uint64_t progress_every_ticks = 500;
    if (reading.tick % progress_every_ticks == 0)
      observer.on_progress(Stage::massage, std::min(0.999, past_s / ready.plan.duration_s));
    return true;
  };
  const auto driven = run_control_loop(devices.robot, *devices.supervisor, propose, look);
  session.compute_s += watch.seconds();
  if (!driven) return tl::unexpected(driven.error());
  observer.on_progress(Stage::massage, 1.0);
  keep(massage, session);
  if (late && !session.stops.empty()) session.stops.back().late_s = max_s;
  return massage.wants_scan();
}

}  // namespace

bool head_at_plus_y(std::span<const Acupoint> acupoints) {
  double shoulders_y = 0.0, loins_y = 0.0;
  for (const Acupoint& point : acupoints) {
    if (point.name.starts_with("SI11")) shoulders_y += 0.5 * point.at_in_couch.y();
    if (point.name == "GV4") loins_y = point.at_in_couch.y();
  }
  return shoulders_y > loins_y;
}

Result<Session> run(Devices devices, const Order& order, const Config& config, Observer& observer) {
  if (order.consent.answered_by.empty())
    return fail(Fault::stopped, "nobody has answered the health questions");
  link::OwnSupervisor own;
  if (devices.supervisor == nullptr) devices.supervisor = &own;
  Session session;
  session.intensity = order.intensity;
  if (auto ready = prepare(devices, order, config, observer, std::nullopt, {}, session); !ready)
    return tl::unexpected(ready.error());
  const double rail_m = session.ready.rail_m;
  if (auto stands = devices.robot.stand_ready({session.ready.ready_rad, rail_m}); !stands)
    return tl::unexpected(stands.error());

  PerformedPaths performed;
  for (;;) {
    const auto wants_scan = carry_out(devices, order, config, observer, session);
    if (!wants_scan) return tl::unexpected(wants_scan.error());
    if (!*wants_scan) break;
    performed.set_aside(session);
    devices.supervisor->rest();
    const auto again =
        session.rescans_s.size() < max_rescans
            ? prepare(devices, order, config, observer, rail_m, performed.done(), session)
            : Result<void>(fail(Fault::bad_input, "the person keeps moving"));
    if (!again) {
      session.stops.push_back({session.massage_s, Arm::left, safety::Cause::person_moved});
      std::vector<Sentence>& notes = session.ready.plan.notes;
      notes.push_back(
          sentence("note_after_moving", "after the person had moved: {}", again.error().message));
      if (std::ranges::none_of(session.performed, &Performed::whole))
        notes.push_back(sentence("note_never_there",
                                 "no tool has found the skin where it was scanned: are the robot's "
                                 "place and its joints' zeros, gears and sides as told?"));
      session.ready.plan.paths.clear();
      break;
    }
    session.rescans_s.push_back(session.massage_s);
  }
  performed.join(session);
  return session;
}

}  // namespace tuina::session
