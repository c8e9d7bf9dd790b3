// SPDX-License-Identifier: Apache-2.0
// Stops, pauses and new scans that come together, and a massage that does not end.
#include <doctest/doctest.h>

#include "tests/session/room.hpp"
#include "tests/too_slow.hpp"
#include "tuina/core/units.hpp"
#include "tuina/session/performed_paths.hpp"

using namespace tuina;
using namespace tuina::session;

namespace {

/// A person who moves by 20 mm under the hands of a massage.
constexpr double moves_at_s = 25.0;
sim::WorldOptions moving() {
  sim::WorldOptions options;
  options.shift_m = 20_mm;
  options.shift_at_s = moves_at_s;
  return options;
}

/// What commands need to know of the massage that they are for.
struct Watcher final : Observer {
  explicit Watcher(const sim::World& of) : world(of) {}
  const sim::World& world;
  int plans = 0;
  double time_s = 0.0, planned_s = 0.0;
  double works_s = 0.0;    ///< time at which an arm last was on its way
  double contact_n = 0.0;  ///< true force of both tools in the last millisecond
  bool worked = false;     ///< an arm has left since the last plan

  void on_plan(const motion::ReadyPlan&, const Transform&) override {
    ++plans;
    planned_s = time_s;
    worked = false;
  }
  void on_tick(const Tick& tick) noexcept override {
    time_s = tick.reading.time_s;
    bool both_wait = true;
    contact_n = 0.0;
    for (const Arm arm : both_arms) {
      both_wait = both_wait && tick.view[arm].phase == ArmPhase::waiting;
      contact_n += world.truth().arms[arm].contact.force_n;
    }
    worked = worked || !both_wait;
    if (!both_wait) works_s = time_s;
  }
  /// After the person has moved the arms wait for longer than between two paths.
  [[nodiscard]] bool rests() const { return time_s > moves_at_s && time_s > works_s + 3.0; }
};

}  // namespace

TEST_CASE("a stop while a new scan is due stops the massage, and is told" *
          doctest::skip(test::too_slow)) {
  Room room{.options = moving()};
  Watcher watcher(*room.world);
  bool stopped = false;
  room.order.commands = [&](double) -> std::optional<LiveCommand> {
    if (stopped || !watcher.rests()) return std::nullopt;
    stopped = true;
    return LiveCommand::stop;
  };
  const auto session =
      session::run({room.world->camera(), room.world->turntable(), room.world->robot()}, room.order,
                   {}, watcher);
  REQUIRE(session.has_value());
  REQUIRE(stopped);
  CHECK(watcher.plans == 1);
  CHECK(session->rescans_s.empty());
  REQUIRE(session->stops.size() == 1);
  CHECK(session->stops.front().cause == safety::Cause::asked_to);
}

TEST_CASE("a pause outlasts a new scan: no arm sets out before somebody says go on" *
          doctest::skip(test::too_slow)) {
  constexpr double waits_s = 4.0;
  Room room{.options = moving()};
  Watcher watcher(*room.world);
  bool paused = false, stopped = false, worked_in_pause = true;
  room.order.commands = [&](double time_s) -> std::optional<LiveCommand> {
    if (!paused && watcher.rests()) {
      paused = true;
      return LiveCommand::pause;
    }
    if (!stopped && watcher.plans == 2 && time_s > watcher.planned_s + waits_s) {
      stopped = true;
      worked_in_pause = watcher.worked;
      return LiveCommand::stop;
    }
    return std::nullopt;
  };
  const auto session =
      session::run({room.world->camera(), room.world->turntable(), room.world->robot()}, room.order,
                   {}, watcher);
  REQUIRE(session.has_value());
  REQUIRE(stopped);
  CHECK(session->rescans_s.size() == 1);
  CHECK_FALSE(worked_in_pause);
}

TEST_CASE("a massage may pause for longer than it takes; one that never ends is stopped and told" *
          doctest::skip(test::too_slow)) {
  Room room;
  room.order.programme.parts.resize(1);
  Watcher watcher(*room.world);
  SUBCASE("a pause") {
    constexpr double pause_s = 200.0;
    int told = 0;
    room.order.commands = [&](double time_s) -> std::optional<LiveCommand> {
      if (told == 0 && time_s > 5.0) return ++told, LiveCommand::pause;
      if (told == 1 && time_s > 5.0 + pause_s) return ++told, LiveCommand::resume;
      return std::nullopt;
    };
    const auto session = room.run_before(watcher);
    REQUIRE(session.has_value());
    CHECK(session->stops.empty());
    CHECK(session->massage_s > pause_s);
    CHECK(3.0 * session->ready.plan.duration_s + 60.0 < pause_s);  // what it may last without
  }
  SUBCASE("for ever") {
    room.order.commands = [](double) { return std::optional(LiveCommand::repeat); };
    const auto session = room.run_before(watcher);
    REQUIRE(session.has_value());
    CHECK(session->stops.size() == 1);
    CHECK(explain(session->stops.front()).key == "stopped_not_done");
    CHECK_FALSE(session->performed.empty());
    CHECK(watcher.contact_n == 0.0);
  }
}

TEST_CASE("a path that was repeated is done once, and another of its name is still to come") {
  Session session;
  for (const char* name : {"press SI11_L", "rub SI11_L", "press SI11_L"})
    session.ready.plan.paths.push_back({.path = {.name = name}});
  massage::Plan again = session.ready.plan;
  for (int i = 0; i < 2; ++i) session.performed.push_back({.path = 0, .whole = true});
  PerformedPaths performed;
  performed.set_aside(session);
  leave_out(again, performed.done());
  REQUIRE(again.paths.size() == 2);
  CHECK(again.paths[0].path.name == "rub SI11_L");
  CHECK(again.paths[1].path.name == "press SI11_L");
}
