// SPDX-License-Identifier: Apache-2.0
#include "tuina/session/run.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <string>
#include <thread>

#include "tests/fake_robot.hpp"
#include "tests/fake_scanner.hpp"
#include "tuina/core/units.hpp"
#include "tuina/session/relay.hpp"
#include "tuina/sim/world.hpp"

using namespace tuina;
using namespace tuina::session;

namespace {

// Instrumented code is ten times slower, and the code of these tests is that of others here.
#ifdef __SANITIZE_ADDRESS__
constexpr bool too_slow = true;
#else
constexpr bool too_slow = false;
#endif

struct Room {
  sim::WorldOptions options = {};
  sim::Person person = sim::parse_person("phantom:medium", BodyPosture::prone, 3).value();
  std::unique_ptr<sim::World> world =
      sim::World::make(person,
                       robot::place_robot(robot::load_robot("thesis").value(), person.position),
                       options, 3)
          .value();
  Order order = {.consent = {.answered_by = "the simulated person"},
                 .programme = massage::load_programme("lower_back").value(),
                 .plan_options = {},
                 .atlas = body::read_atlas(TUINA_SOURCE_DIR "/models/atlas.tuina").value(),
                 .calibration = world->believed_calibration(),
                 .robot = robot::load_robot("thesis").value(),
                 .placed = {"thesis", person.position, world->believed_base_from_couch()},
                 .commands = {}};
  Observers nobody{{}};

  Result<Session> run_with(robot::Robot& robot) {
    return session::run({world->camera(), world->turntable(), robot}, order, {}, nobody);
  }
};

bool says(const std::string& text, const char* part) {
  return text.find(part) != std::string::npos;
}

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

TEST_CASE("nobody is scanned before the health questions are answered") {
  Room room;
  room.order.consent = {};
  tests::FakeScanner scanner;
  tests::FakeRobot robot;
  const auto session = run({scanner, scanner, robot}, room.order, {}, room.nobody);
  REQUIRE_FALSE(session.has_value());
  CHECK(session.error().fault == Fault::stopped);
  CHECK(robot.stood == 0);
}

TEST_CASE("a plan is changed by hand before an arm moves, and what cannot be done is said") {
  Room room;
  tests::FakeRobot robot;
  Observers nobody{{}};
  std::vector<std::vector<std::string>> seen;
  std::vector<std::string> refusals;
  const Vector3 far_off(0.0, 0.0, 2.0);
  room.order.review = [&](const motion::ReadyPlan& plan, const std::string& refused) -> Review {
    refusals.push_back(refused);
    auto& names = seen.emplace_back();
    for (const auto& path : plan.plan.paths) names.push_back(path.path.name);
    if (seen.size() == 1) {
      // A square of 80 mm around the place of the first path.
      const Vector3 at = plan.plan.paths.front().path.points.front().at_in_couch;
      massage::NoGo area{.name = "here", .corners_in_couch = {}};
      for (const auto& [x, y] : {std::pair(-1, -1), {1, -1}, {1, 1}, {-1, 1}})
        area.corners_in_couch.emplace_back(at + 40_mm * Vector3(x, y, 0));
      return {.answer = Review::Answer::change, .wanted = {.no_go = {area}, .fixed = {}}};
    }
    if (seen.size() == 2) {
      return {.answer = Review::Answer::change,
              .wanted = {.no_go = {}, .fixed = {{.name = "GV4", .at_in_couch = far_off}}}};
    }
    return {};
  };
  const auto session =
      run({room.world->camera(), room.world->turntable(), robot}, room.order, {}, nobody);
  REQUIRE_FALSE(session.has_value());
  CHECK(session.error().fault == Fault::stopped);
  CHECK(robot.stood == 0);
  REQUIRE(seen.size() == 3);
  const auto has = [](const std::vector<std::string>& names, const std::string& name) {
    return std::find(names.begin(), names.end(), name) != names.end();
  };
  CHECK_FALSE(has(seen[1], seen[0].front()));
  CHECK(seen[1].size() < seen[0].size());
  CHECK(seen[2] == seen[1]);
  CHECK(refusals[0].empty());
  CHECK(refusals[1].empty());
  CHECK(says(refusals[2], "GV4"));
}

TEST_CASE("a session ends with the words of the device that failed") {
  Room room;
  SUBCASE("a camera that falls silent: the robot never stands up") {
    room.order.calibration = tests::calibration_of_fake();
    tests::FakeScanner scanner({.silent_from = 4});
    tests::FakeRobot robot;
    const auto session = run({scanner, scanner, robot}, room.order, {}, room.nobody);
    REQUIRE_FALSE(session.has_value());
    CHECK(session.error().fault == Fault::device);
    CHECK(says(session.error().message, "no frame within"));
    CHECK(robot.stood == 0);
  }
  SUBCASE("a robot that does not stand up") {
    tests::FakeRobot robot({.refuses_to_stand = true});
    const auto session = room.run_with(robot);
    REQUIRE_FALSE(session.has_value());
    CHECK(session.error().message == "the brakes do not open");
    CHECK(robot.applied == 0);
  }
  SUBCASE("a robot that falls silent") {
    tests::FakeRobot robot({.silent_from = 300});
    const auto session = room.run_with(robot);
    REQUIRE_FALSE(session.has_value());
    CHECK(says(session.error().message, "no reading for 10 ms"));
  }
  SUBCASE("a robot whose arms do not move: they are given up, and the massage ends") {
    tests::FakeRobot robot;
    const auto session = room.run_with(robot);
    if (session) {
      for (const Performed& path : session->performed)
        CHECK(path.contact_fault == control::ContactFault::blocked);
    } else {
      CHECK(says(session.error().message, "was not done after"));
    }
  }
}

TEST_CASE("a robot that stands for a person sitting is not used for one who lies") {
  Room room;
  room.order.placed.position = BodyPosture::sitting;
  tests::FakeRobot robot;
  const auto session = room.run_with(robot);
  REQUIRE_FALSE(session.has_value());
  CHECK(says(session.error().message, "the robot stands there for a person sitting"));
  CHECK(robot.stood == 0);
}

TEST_CASE("an observer that hangs does not delay the session: it misses what a ring cannot hold") {
  class Hanging final : public Observer {
   public:
    void on_tick(const Tick&) noexcept override {
      while (hangs) std::this_thread::sleep_for(std::chrono::milliseconds(1));
      ++ticks;
    }
    std::atomic<bool> hangs = true;
    std::uint64_t ticks = 0;
  } observer;
  constexpr std::uint64_t given = 5000;
  std::uint64_t left_out = 0;
  {
    Relay relay(observer);
    Tick tick;
    for (std::uint64_t i = 0; i < given; ++i) {
      tick.reading.tick = i;
      relay.on_tick(tick);
    }
    left_out = relay.left_out();
    observer.hangs = false;
  }
  CHECK(left_out > 0);  // a session that waited would leave nothing out, and never end
  CHECK(observer.ticks + left_out == given);
}

TEST_CASE("a session whose clock nobody lives by may wait for its observer: nothing is left out") {
  class Slow final : public Observer {
   public:
    void on_scan(const scanner::Scan&) override { scan_after = ticks; }
    void on_tick(const Tick&) noexcept override {
      if (++ticks % 1000 == 0) std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    std::uint64_t ticks = 0, scan_after = 0;
  } slow;
  {
    Relay relay(slow, Relay::Behind::wait);
    for (std::uint64_t i = 0; i < 20000; ++i) relay.on_tick({});
    // A new scan comes after the milliseconds before it, and from one thread at a time.
    relay.on_scan({});
    CHECK(relay.left_out() == 0);
  }
  CHECK(slow.ticks == 20000);
  CHECK(slow.scan_after == 20000);
}

TEST_CASE("every millisecond reaches an observer that keeps up, in order") {
  class Count final : public Observer {
   public:
    void on_tick(const Tick& tick) noexcept override {
      in_order = in_order && tick.reading.tick == ticks;
      ++ticks;
    }
    std::uint64_t ticks = 0;
    bool in_order = true;
  } count;
  {
    Relay relay(count);
    Tick tick;
    for (std::uint64_t i = 0; i < 3000; ++i) {
      tick.reading.tick = i;
      relay.on_tick(tick);
    }
  }
  CHECK(count.ticks == 3000);
  CHECK(count.in_order);
}

TEST_CASE("a stop while a new scan is due stops the massage, and is told" *
          doctest::skip(too_slow)) {
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
          doctest::skip(too_slow)) {
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

TEST_CASE("a massage may pause for longer than it takes; one that never ends lets go and fails" *
          doctest::skip(too_slow)) {
  Room room;
  room.order.programme.parts.resize(1);
  Watcher watcher(*room.world);
  const auto run_on = [&] {
    return session::run({room.world->camera(), room.world->turntable(), room.world->robot()},
                        room.order, {}, watcher);
  };
  SUBCASE("a pause") {
    constexpr double pause_s = 200.0;
    int told = 0;
    room.order.commands = [&](double time_s) -> std::optional<LiveCommand> {
      if (told == 0 && time_s > 5.0) return ++told, LiveCommand::pause;
      if (told == 1 && time_s > 5.0 + pause_s) return ++told, LiveCommand::resume;
      return std::nullopt;
    };
    const auto session = run_on();
    REQUIRE(session.has_value());
    CHECK(session->stops.empty());
    CHECK(session->massage_s > pause_s);
    CHECK(3.0 * session->ready.plan.duration_s + 60.0 < pause_s);  // what it may last without
  }
  SUBCASE("for ever") {
    room.order.commands = [](double) { return std::optional(LiveCommand::repeat); };
    const auto session = run_on();
    REQUIRE_FALSE(session.has_value());
    CHECK(says(session.error().message, "was not done after"));
    CHECK(watcher.contact_n == 0.0);
  }
}
