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
#include "tests/session/room.hpp"
#include "tuina/core/units.hpp"
#include "tuina/massage/zones.hpp"
#include "tuina/session/relay.hpp"
#include "tuina/sim/world.hpp"

using namespace tuina;
using namespace tuina::session;

namespace {

bool says(const std::string& text, const char* part) {
  return text.find(part) != std::string::npos;
}

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
    REQUIRE(session.has_value());
    for (const Performed& path : session->performed)
      CHECK(path.contact_fault == control::ContactFault::blocked);
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

TEST_CASE(
    "the ten seconds that GV4 bears are those of the whole contact, with its probing presses") {
  Room room;
  room.order.programme =
      massage::parse_programme(
          "name = \"gv4\"\ndescription = \"x\"\n[[part]]\ntechnique = \"press\"\n"
          "points = [\"GV4\"]\nrepeats = 9\nrise_s = 1\nhold_s = 1\n",
          "gv4")
          .value();
  const auto session = room.run_before(room.nobody);
  REQUIRE(session.has_value());
  REQUIRE(session->performed.size() == 1);
  const double contact_s = session->performed[0].end_s - session->performed[0].begin_s;
  CHECK(contact_s > 8.0);
  CHECK(contact_s <= massage::rule_of(massage::Zone::gv4).max_duration_s);
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
