// SPDX-License-Identifier: Apache-2.0
// The massage of both arms on a phantom, one millisecond at a time: what it takes from the heap,
// and what it does when the person jumps.
#include <doctest/doctest.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <functional>
#include <string>

#include "tests/allocation.hpp"
#include "tests/too_slow.hpp"
#include "tuina/motion/ready_plan.hpp"
#include "tuina/robot/clearance.hpp"
#include "tuina/session/guarded_field.hpp"
#include "tuina/session/massage_step.hpp"
#include "tuina/sim/robot/back_contact.hpp"
#include "tuina/sim/world.hpp"

using namespace tuina;

namespace {

/// A phantom, a robot, and a plan on the phantom's true back.
struct Room {
  std::unique_ptr<sim::World> world;
  PerArm<robot::ArmModel> models;
  motion::ReadyPlan plan;
  session::MassageStep massage;
  safety::RobotGuard guard;
  double highest_set_n = 0.0;  ///< force that an arm was to press with
  PerArm<double> set_n = {};   ///< likewise, in the last millisecond
};

/// `spoil` may change what the session believes to be ready.
std::unique_ptr<Room> enter(BodyPosture position,
                            const std::function<void(motion::ReadyPlan&)>& spoil = {}) {
  constexpr std::uint64_t seed = 3;
  auto person = sim::parse_person("phantom:medium", position, seed);
  REQUIRE(person.has_value());
  PointCloud skin_in_couch;
  skin_in_couch.points = person->skin_in_couch.vertices;
  const auto back = body::fit_back(skin_in_couch, {.position = position});
  REQUIRE(back.has_value());
  const auto programme = massage::load_programme("relax");
  REQUIRE(programme.has_value());
  auto paths = massage::plan(*back, person->acupoints, person->landmarks, *programme);
  REQUIRE(paths.has_value());

  const robot::RobotMount mount = robot::mount_for(position);
  const robot::ArmTable table = robot::thesis_arm();
  const PerArm<robot::ArmModel> models = robot::both_models(table, mount);
  constexpr double standoff_m = 40e-3;
  auto ready = motion::make_ready(std::move(*paths), *back, mount, models, mount.base_from_couch,
                                  standoff_m);
  REQUIRE(ready.has_value());
  if (spoil) spoil(*ready);
  session::MassageStep massage(ready->plan, ready->jobs, models,
                               {.base_from_couch = mount.base_from_couch, .rail_m = ready->rail_m});
  const auto field =
      session::zone_field(*back, person->acupoints, person->landmarks, {}, mount.base_from_couch);
  REQUIRE(field.has_value());
  safety::RobotGuard guard(models, {.obstacles = mount.obstacles, .field = *field});
  // The robot is as its table says: here the session is judged, not its model.
  const robot::RobotPlacement placement =
      robot::place_robot(robot::load_robot("thesis").value(), position);
  auto world = sim::World::make(
      *person, placement,
      {.arm_errors = {.mass_spread = 0.0, .friction_spread = 0.0, .rotor_spread = 0.0}}, seed);
  REQUIRE(world.has_value());
  REQUIRE((*world)->robot().stand_ready({ready->ready_rad, ready->rail_m}).has_value());
  return std::make_unique<Room>(
      Room{std::move(*world), models, std::move(*ready), std::move(massage), std::move(guard)});
}

/// One millisecond; the time it is.
double live(Room& room) noexcept {
  const robot::RobotReading reading = *room.world->robot().read();
  const safety::RobotProposal proposal = room.massage.propose(reading);
  for (const Arm arm : both_arms) {
    room.set_n[arm] = proposal.arms[arm].set_force_n;
    room.highest_set_n = std::max(room.highest_set_n, room.set_n[arm]);
  }
  const safety::RobotVerdict verdict = room.guard.check(reading, proposal);
  room.world->robot().apply(verdict.command);
  room.massage.heed(verdict);
  return reading.time_s;
}

double force_n(const Room& room, Arm arm) {
  return room.world->truth().arms[arm].contact.force_n;
}

}  // namespace

TEST_CASE("twenty seconds of massage by two arms take nothing from the heap") {
  for (const BodyPosture position : {BodyPosture::sitting, BodyPosture::prone}) {
    const auto room = enter(position);
    PerArm<double> highest_n;
    const auto before = test::allocations();
    for (int ms = 0; ms < 20'000; ++ms) {
      live(*room);
      for (const Arm arm : both_arms)
        highest_n[arm] = std::max(highest_n[arm], force_n(*room, arm));
    }
    CHECK(test::allocations() == before);
    CHECK(room->massage.stops().empty());
    // They were at work, and not only on their way.
    CHECK(highest_n[Arm::left] > 10.0);
    CHECK(highest_n[Arm::right] > 10.0);
    CHECK(room->massage.performed().size() >= 2);
    // A press aims at a little less than its order, for the true force swings about its target.
    double ordered_n = 0.0;
    for (const massage::PlannedPath& path : room->plan.plan.paths)
      for (const ContactPoint& point : path.path.points)
        ordered_n = std::max(ordered_n, point.force_n);
    CHECK(room->highest_set_n > 0.95 * ordered_n);
    CHECK(room->highest_set_n <= ordered_n - 0.3);
  }
}

TEST_CASE("a person who jumps up stops the massage: the cause is told, and both arms let go") {
  const auto room = enter(BodyPosture::prone);
  double time_s = 0.0;
  while (time_s < 60.0 && (force_n(*room, Arm::left) < 15.0 || force_n(*room, Arm::right) < 15.0)) {
    time_s = live(*room);
  }
  REQUIRE(room->massage.stops().empty());
  REQUIRE(time_s < 60.0);

  const double jump_s = time_s;
  room->world->contact().add_shift(
      {.start_s = jump_s,
       .by_in_couch = 60e-3 * room->world->contact().mean_normal_in_couch(),
       .speed_m_per_s = 0.4});
  double highest_n = 0.0;
  while (!room->massage.finished() && time_s < jump_s + 10.0) {
    time_s = live(*room);
    for (const Arm arm : both_arms) highest_n = std::max(highest_n, force_n(*room, arm));
  }
  REQUIRE(room->massage.finished());
  REQUIRE_FALSE(room->massage.stops().empty());
  const session::Stop& stop = room->massage.stops().front();
  MESSAGE(fmt::format("{} arm: {}, {:.3f} s after the jump; {:.0f} N at most", name_of(stop.arm),
                      safety::name_of(stop.cause), stop.time_s - jump_s, highest_n));
  CHECK(stop.cause != safety::Cause::none);
  CHECK(stop.time_s > jump_s);
  CHECK(stop.time_s < jump_s + 0.2);
  for (const Arm arm : both_arms) {
    CAPTURE(name_of(arm));
    CHECK(force_n(*room, arm) == 0.0);
    CHECK(room->world->truth().arms[arm].contact.gap_m > 0.0);
  }
}

TEST_CASE("a person who shrinks back ends no massage: after two quiet seconds it goes on" *
          doctest::skip(test::too_slow)) {
  const auto room = enter(BodyPosture::prone);
  double time_s = 0.0;
  while (time_s < 60.0 && (force_n(*room, Arm::left) < 15.0 || force_n(*room, Arm::right) < 15.0))
    time_s = live(*room);
  REQUIRE(time_s < 60.0);

  const double shrinks_s = time_s;
  const Vector3 away_m = -15e-3 * room->world->contact().mean_normal_in_couch();
  for (const double back : {0.0, 1.0}) {
    room->world->contact().add_shift({.start_s = shrinks_s + 0.3 * back,
                                      .by_in_couch = (1.0 - 2.0 * back) * away_m,
                                      .speed_m_per_s = 0.3});
  }
  PerArm<bool> off = {};
  PerArm<double> touched_again_s = {{-1.0, -1.0}};
  PerArm<double> first_n;  // with which the next contact begins
  while (time_s < shrinks_s + 25.0) {
    time_s = live(*room);
    for (const Arm arm : both_arms) {
      const bool touches = room->massage.view()[arm].phase == session::ArmPhase::contact;
      off[arm] = off[arm] || !touches;
      if (off[arm] && touches && touched_again_s[arm] < 0.0) {
        touched_again_s[arm] = time_s;
        first_n[arm] = room->set_n[arm];
      }
    }
  }
  CHECK(room->massage.stops().empty());
  CHECK_FALSE(room->massage.wants_scan());
  REQUIRE_FALSE(room->massage.performed().empty());
  CHECK(room->massage.performed().front().contact_fault == control::ContactFault::contact_lost);
  for (const Arm arm : both_arms) {
    CHECK(touched_again_s[arm] > shrinks_s + 2.0);
    CHECK(first_n[arm] < 2.0);  // nothing of the contact that was cut short
  }
}

TEST_CASE("arms that are sent into each other stop before they touch, and nobody is pressed") {
  // The right arm is sent to where the left one works, as if nobody had planned for two.
  const auto room = enter(BodyPosture::prone, [](motion::ReadyPlan& ready) {
    for (motion::ArmJob& job : ready.jobs[Arm::right]) {
      job.path = -1;
      job.waypoints_in_base = {ready.jobs[Arm::left].front().waypoints_in_base.back()};
    }
  });
  double time_s = 0.0, nearest_m = 1.0;
  while (!room->massage.finished() && time_s < 60.0) {
    time_s = live(*room);
    nearest_m = std::min(nearest_m, room->guard.arm_distance_m());
  }
  REQUIRE_FALSE(room->massage.stops().empty());
  CHECK(room->massage.stops().front().cause == safety::Cause::arms_too_close);
  MESSAGE(fmt::format("{:.1f} mm at least, stopped at {:.1f} s", 1e3 * nearest_m,
                      room->massage.stops().front().time_s));
  CHECK(nearest_m > 0.025);
  for (const Arm arm : both_arms) CHECK(force_n(*room, arm) == 0.0);
}

TEST_CASE("an arm that is sent into the bed stops before it gets there") {
  // Beside the person and down, as if nobody had planned with a bed.
  const auto room = enter(BodyPosture::prone, [](motion::ReadyPlan& ready) {
    const Transform base_from_couch = robot::mount_for(BodyPosture::prone).base_from_couch;
    for (motion::ArmJob& job : ready.jobs[Arm::left]) {
      job.path = -1;
      control::ToolPose pose{.normal_in_base = Vector3::UnitZ()};
      for (const double height_m : {0.3, 0.01}) {
        pose.at_in_base = base_from_couch * Vector3(0.33, -0.1, height_m);
        if (height_m > 0.1) job.waypoints_in_base = {pose};
      }
      job.waypoints_in_base.push_back(pose);
    }
    ready.jobs[Arm::right].clear();
  });
  const robot::RobotMount mount = robot::mount_for(BodyPosture::prone);
  double time_s = 0.0, nearest_m = 1.0;
  while (!room->massage.finished() && time_s < 60.0) {
    time_s = live(*room);
    const sim::PlantTruth& truth = room->world->truth();
    const auto pose = room->models[Arm::left].kinematics(truth.arms[Arm::left].q_rad, truth.rail_m);
    nearest_m = std::min(
        nearest_m,
        robot::clearances(room->models[Arm::left], pose, truth.rail_m, mount.obstacles).min_m());
  }
  REQUIRE_FALSE(room->massage.stops().empty());
  CHECK(room->massage.stops().front().cause == safety::Cause::surroundings_too_close);
  MESSAGE(fmt::format("{:.1f} mm at least", 1e3 * nearest_m));
  CHECK(nearest_m > 0.0245);
  CHECK(nearest_m < 0.06);
}

TEST_CASE("an arm that does not stand where its plan begins stays there, and the stop says so") {
  // Somebody turned an elbow by thirty degrees between planning and the start.
  const auto room = enter(BodyPosture::sitting,
                          [](motion::ReadyPlan& ready) { ready.ready_rad[Arm::left][3] -= 0.52; });
  const double began_rad = room->plan.ready_rad[Arm::left][3];
  double time_s = 0.0;
  while (!room->massage.finished() && time_s < 10.0) time_s = live(*room);
  REQUIRE(room->massage.stops().size() == 1);
  const session::Stop& stop = room->massage.stops().front();
  CHECK(stop.arm == Arm::left);
  CHECK(stop.cause == safety::Cause::not_as_planned);
  CHECK(session::explain(stop).words ==
        "left arm: does not stand as planned: joint 4 is 30 degrees off, 20 are allowed");
  CHECK(time_s < 10.0);
  CHECK(room->massage.performed().empty());
  const double ends_rad = room->world->truth().arms[Arm::left].q_rad[3];
  CHECK(ends_rad == doctest::Approx(began_rad).epsilon(0.05));
}

namespace {

/// Until both arms press; the time it is.
double until_pressing(Room& room) {
  double time_s = 0.0;
  const auto presses = [&](Arm arm) {
    return room.massage.view()[arm].target_n > 9.0 &&
           room.massage.view()[arm].phase == session::ArmPhase::contact;
  };
  while (time_s < 60.0 && !(presses(Arm::left) && presses(Arm::right))) time_s = live(room);
  REQUIRE(time_s < 60.0);
  return time_s;
}

void live_for(Room& room, double duration_s) {
  for (int ms = 0; ms < static_cast<int>(1e3 * duration_s); ++ms) (void)live(room);
}

double target_n(const Room& room, Arm arm) {
  return room.massage.view()[arm].target_n;
}

}  // namespace

TEST_CASE("each live command shows within 100 ms, and no force jumps" *
          doctest::skip(test::too_slow)) {
  using session::LiveCommand;
  for (const LiveCommand command : {LiveCommand::pause, LiveCommand::skip, LiveCommand::softer,
                                    LiveCommand::firmer, LiveCommand::stop}) {
    CAPTURE(session::name_of(command));
    const auto asked = enter(BodyPosture::prone), left_alone = enter(BodyPosture::prone);
    until_pressing(*asked);
    until_pressing(*left_alone);
    asked->massage.obey(command);
    double max_slope_n_per_s = 0.0, before_n = target_n(*asked, Arm::left);
    for (int ms = 0; ms < 100; ++ms) {
      (void)live(*asked);
      (void)live(*left_alone);
      if (command != LiveCommand::stop) {
        const double now_n = target_n(*asked, Arm::left);
        max_slope_n_per_s = std::max(max_slope_n_per_s, std::abs(now_n - before_n) / 1e-3);
        before_n = now_n;
      }
    }
    const double change_n = target_n(*asked, Arm::left) - target_n(*left_alone, Arm::left);
    if (command == LiveCommand::firmer) {
      CHECK(change_n > 0.1);
    } else {
      CHECK(change_n < -0.1);
    }
    CHECK(max_slope_n_per_s < 250.0);
    CHECK(asked->massage.stops().empty() == (command != LiveCommand::stop));
  }
}

TEST_CASE("a pause keeps a light touch where the tools are, and resume goes on") {
  const auto room = enter(BodyPosture::prone);
  until_pressing(*room);
  REQUIRE(room->massage.view()[Arm::left].probing);
  room->massage.obey(session::LiveCommand::pause);
  live_for(*room, 1.5);
  const Vector3 there = room->massage.view()[Arm::left].tool_in_base;
  live_for(*room, 5.0);
  for (const Arm arm : both_arms) {
    CHECK(target_n(*room, arm) == doctest::Approx(3.0).epsilon(0.05));
    CHECK(force_n(*room, arm) < 5.0);
  }
  CHECK((room->massage.view()[Arm::left].tool_in_base - there).norm() < 3e-3);
  CHECK(room->massage.performed().empty());
  CHECK(room->massage.view()[Arm::left].probing);  // a pause is no probing press
  room->massage.obey(session::LiveCommand::resume);
  until_pressing(*room);
  CHECK(room->massage.stops().empty());
}

TEST_CASE("skip leaves a path for the next one, repeat does it once more" *
          doctest::skip(test::too_slow)) {
  const auto skipped = enter(BodyPosture::prone);
  const double began_s = until_pressing(*skipped);
  skipped->massage.obey(session::LiveCommand::skip);
  live_for(*skipped, 1.5);
  REQUIRE(skipped->massage.performed().size() == 2);
  CHECK(skipped->massage.performed().front().end_s < began_s + 1.0);
  CHECK(skipped->massage.performed().front().contact_fault == control::ContactFault::none);

  const auto repeated = enter(BodyPosture::prone);
  until_pressing(*repeated);
  repeated->massage.obey(session::LiveCommand::repeat);
  double time_s = 0.0;
  while (time_s < 120.0 && repeated->massage.performed().size() < 4) time_s = live(*repeated);
  REQUIRE(repeated->massage.performed().size() == 4);
  std::array<int, 4> paths{};
  for (std::size_t i = 0; i < 4; ++i) paths[i] = repeated->massage.performed()[i].path;
  std::sort(paths.begin(), paths.end());
  CHECK(paths[0] == paths[1]);
  CHECK(paths[2] == paths[3]);
  CHECK(repeated->massage.stops().empty());
}

TEST_CASE(
    "a person who lies 20 mm higher than scanned is let go: the arms fly home for a new scan") {
  const auto room = enter(BodyPosture::prone);
  live(*room);
  PerArm<Vector3> home;
  for (const Arm arm : both_arms) home[arm] = room->massage.view()[arm].tool_in_base;
  room->world->contact().add_shift(
      {.start_s = 0.0,
       .by_in_couch = 20e-3 * room->world->contact().mean_normal_in_couch(),
       .speed_m_per_s = 0.2});
  double time_s = 0.0;
  while (!room->massage.finished() && time_s < 60.0) time_s = live(*room);
  CHECK(room->massage.wants_scan());
  CHECK(time_s < 40.0);
  CHECK(room->massage.stops().empty());
  REQUIRE_FALSE(room->massage.performed().empty());
  for (const session::Performed& done : room->massage.performed()) CHECK_FALSE(done.whole);
  for (const Arm arm : both_arms) {
    CHECK(force_n(*room, arm) == 0.0);
    CHECK((room->massage.view()[arm].tool_in_base - home[arm]).norm() < 20e-3);
  }
}

TEST_CASE(
    "what the presses feel lowers the force where the plan asks for more than the tissue bears") {
  const auto room = enter(BodyPosture::prone);
  double time_s = 0.0;
  while (time_s < 30.0 && room->massage.performed().size() < 2) time_s = live(*room);
  REQUIRE(room->massage.performed().size() >= 2);
  REQUIRE_FALSE(room->massage.decisions().empty());
  const session::Decision& first = room->massage.decisions().front();
  CHECK(std::string(first.rule) == "A1");
  const massage::PlannedPath& planned = room->plan.plan.paths[static_cast<std::size_t>(first.path)];
  double ordered_n = 0.0;
  for (const auto& point : planned.path.points) ordered_n = std::max(ordered_n, point.force_n);
  CHECK(first.to_n <= std::max(0.5 * planned.cap_n, 0.7 * ordered_n) + 1e-9);
  for (const session::Decision& made : room->massage.decisions()) {
    CHECK(made.to_n <= room->plan.plan.paths[static_cast<std::size_t>(made.path)].cap_n + 1e-9);
  }
}
