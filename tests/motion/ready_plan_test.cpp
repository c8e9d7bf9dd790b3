// SPDX-License-Identifier: Apache-2.0
// Two arms made ready for a plan: do they keep apart, and is what was rehearsed what they do?
#include <doctest/doctest.h>
#include <fmt/format.h>

#include <set>

#include "tests/folder.hpp"
#include "tests/motion/ready_for.hpp"
#include "tuina/motion/arm_move.hpp"
#include "tuina/motion/ready_plan.hpp"
#include "tuina/motion/rollout.hpp"
#include "tuina/motion/startle.hpp"
#include "tuina/robot/ready_posture.hpp"
#include "tuina/robot/robot_model.hpp"
#include "tuina/sim/person/person.hpp"

using namespace tuina;
using test::ready_for;

TEST_CASE("arms that would wait in the robot's own body, or cannot reach there, are refused") {
  const auto person = sim::parse_person("phantom:medium", BodyPosture::prone, 5).value();
  PointCloud skin_in_couch;
  skin_in_couch.points = person.skin_in_couch.vertices;
  const auto back = body::fit_back(skin_in_couch, {.position = person.position});
  REQUIRE(back.has_value());
  auto plan = massage::plan(*back, person.acupoints, person.landmarks,
                            massage::load_programme("relax").value());
  REQUIRE(plan.has_value());
  robot::RobotPlacement placement =
      robot::place_robot(robot::load_robot("thesis").value(), person.position);
  const auto models = robot::both_models(placement.arm, placement.mount);
  const JointVector ready_rad = robot::ready_posture(placement.arm, placement.mount)[Arm::left];
  robot::Obstacle body{.kind = robot::both_surroundings[1],
                       .base_from_box = Transform::Identity(),
                       .edges_m = Vector3::Constant(20e-3),
                       .rides = true};
  body.base_from_box.translation() = models[Arm::left].base_from_tool(ready_rad, 0.0).translation();
  placement.mount.obstacles.push_back(body);
  const auto refusal = [&] {
    const auto ready = motion::make_ready(*plan, *back, placement.mount, models,
                                          placement.mount.base_from_couch, 40e-3);
    REQUIRE_FALSE(ready.has_value());
    CHECK(ready.error().fault == Fault::config);
    return ready.error().message;
  };
  CHECK(refusal().find("mm from the robot's own body; ready_mm") != std::string::npos);
  placement.mount.ready_from_shoulder *= 3.0;
  CHECK(refusal().find("the left tool can only wait") == 0);
}

TEST_CASE("whatever the timing, the arms are planned at least 45 mm apart, travel included") {
  for (const char* who : {"phantom:slim", "phantom:medium", "phantom:hefty"}) {
    for (const BodyPosture position : {BodyPosture::sitting, BodyPosture::prone}) {
      for (const char* what : {"relax", "demonstration", "lower_back", "shoulders"}) {
        const motion::ReadyPlan ready = ready_for(who, position, what, 5);
        CAPTURE(who);
        CAPTURE(name_of(position));
        CAPTURE(what);
        CHECK(ready.min_arm_distance_m >= 45e-3);
        CHECK(ready.min_arm_distance_m < 0.4);
        for (const robot::Surrounding kind : robot::both_surroundings) {
          CHECK(ready.clear[kind] >= 45e-3);
          CHECK(ready.clear[kind] < 0.6);
        }
      }
    }
  }
}

TEST_CASE("the whole back is worked on, nothing left out because of the other arm") {
  for (const BodyPosture position : {BodyPosture::sitting, BodyPosture::prone}) {
    const motion::ReadyPlan ready = ready_for("phantom:medium", position, "full_back_20min", 5);
    CAPTURE(name_of(position));
    CHECK(ready.reachable);
    CHECK(ready.min_arm_distance_m >= 55e-3);
    CHECK(ready.plan.paths.size() >= 40);
  }
}

TEST_CASE("the successor's seven joints do a programme within their ranges, nothing left out") {
  for (const auto& [position, what] : {std::pair(BodyPosture::sitting, "full_back_20min"),
                                       std::pair(BodyPosture::prone, "relax")}) {
    const motion::ReadyPlan ready = ready_for("phantom:medium", position, what, 5, "successor");
    CAPTURE(name_of(position));
    CHECK(ready.reachable);
    CHECK(ready.min_arm_distance_m >= 45e-3);
    for (const robot::Surrounding kind : robot::both_surroundings) {
      CHECK(ready.clear[kind] >= 45e-3);
    }
    for (const Arm arm : both_arms) {
      for (const motion::ArmJob& job : ready.jobs[arm]) {
        REQUIRE(job.posture_rad.size() == 7);
        CHECK(robot::limit_room_rad(robot::load_robot("successor")->arm, job.posture_rad) > 0.0);
      }
    }
  }
}

TEST_CASE("a path out of reach is said to be left out, and not to run after another") {
  const motion::ReadyPlan ready =
      ready_for("phantom:medium", BodyPosture::prone, "full_back_20min", 5, "successor");
  std::set<std::string> left_out, after_another;
  for (const Sentence& note : ready.plan.notes) {
    if (note.key == "note_out_of_reach") left_out.insert(note.values[0]);
    if (note.key == "note_one_after_the_other")
      after_another.insert(note.values.begin(), note.values.begin() + 2);
  }
  CHECK_FALSE(left_out.empty());
  for (const std::string& path : after_another) CHECK_FALSE(left_out.contains(path));
}

TEST_CASE("arms of another build do the programme relax, but for what they are too heavy for") {
  for (const char* name : {"panda", "ur"}) {
    for (const BodyPosture position : {BodyPosture::sitting, BodyPosture::prone}) {
      CAPTURE(name);
      CAPTURE(name_of(position));
      const motion::ReadyPlan ready = ready_for("phantom:medium", position, "relax", 5, name);
      std::size_t too_heavy = 0;
      for (const Sentence& note : ready.plan.notes) {
        if (note.key != "note_out_of_reach") continue;
        CAPTURE(note.words);
        CHECK(note.words.find("too heavy for a person who starts up") != std::string::npos);
        ++too_heavy;
      }
      // Of what a panda may give there, control could be 3 N over an order.
      CHECK(too_heavy <= (name == std::string("panda") ? 5 : 0));
      CHECK(ready.reachable == (too_heavy == 0));
      CHECK(ready.plan.paths.size() + too_heavy == 13);
      for (const massage::PlannedPath& path : ready.plan.paths) CHECK(path.ordered_n() >= 3.0);
      CHECK(ready.min_arm_distance_m >= 45e-3);
      const robot::ArmTable table = robot::load_robot(name)->arm;
      for (const Arm arm : both_arms) {
        for (const motion::ArmJob& job : ready.jobs[arm])
          CHECK(robot::limit_room_rad(table, job.posture_rad) > 0.0);
      }
    }
  }
}

TEST_CASE("hand after hand, the idle arm hovers over its place instead of flying home") {
  const test::Folder folder;
  const std::string hands = folder.with("hands.toml",
                                        "name = \"hands\"\n[[part]]\ntechnique = \"press\"\n"
                                        "points = [\"BL47\", \"BL50\"]\n"
                                        "alternating = true\nrepeats = 4\n");
  const motion::ReadyPlan ready = ready_for("phantom:medium", BodyPosture::prone, hands.c_str(), 5);
  REQUIRE(ready.plan.paths.size() == 16);
  int home = 0;
  for (const Arm arm : both_arms) {
    for (const motion::ArmJob& job : ready.jobs[arm]) {
      home += job.path < 0 && job.posture_rad == ready.ready_rad[arm] ? 1 : 0;
    }
  }
  CHECK(home == 2);  // at the end
}

TEST_CASE(
    "an arm whose posture springs are as weak as the controller's turns its wrist over nowhere") {
  constexpr double turned_over_rad = 2.5, posture_share = 0.05;
  for (const char* who : {"phantom:slim", "phantom:medium", "phantom:hefty"}) {
    for (const BodyPosture position : {BodyPosture::sitting, BodyPosture::prone}) {
      const motion::ReadyPlan ready = ready_for(who, position, "full_back_20min", 5);
      const auto placement = robot::place_robot(robot::load_robot("thesis").value(), position);
      const Transform& base_from_couch = placement.mount.base_from_couch;
      const auto models = robot::both_models(placement.arm, placement.mount);
      CAPTURE(who);
      CAPTURE(name_of(position));
      for (const Arm arm : both_arms) {
        motion::Rollout weak(models[arm], ready.rail_m, ready.ready_rad[arm], posture_share,
                             control::PostureGains{}.max_error_rad);
        motion::JointPath passed;
        for (const motion::ArmJob& job : ready.jobs[arm]) {
          for (const control::ToolPose& pose : job.waypoints_in_base)
            weak.transfer(pose, job.posture_rad, passed);
          if (job.path < 0) continue;
          CAPTURE(job.path);
          const ContactPath& path = ready.plan.paths[static_cast<std::size_t>(job.path)].path;
          weak.slide(motion::goals_of(path, base_from_couch), job.posture_rad, passed);
          weak.settle(job.posture_rad, passed);
          CHECK((weak.q_rad() - job.posture_rad).cwiseAbs().maxCoeff() < turned_over_rad);
          const motion::ApproachPose after = motion::approach_pose(path.points.back(), 40_mm);
          weak.transfer({.at_in_base = base_from_couch * after.at_in_couch,
                         .normal_in_base = base_from_couch.linear() * after.normal_in_couch},
                        job.posture_rad, passed);
        }
      }
    }
  }
}

TEST_CASE("both arms end where they began, and their steps run in one order") {
  const motion::ReadyPlan ready = ready_for("phantom:medium", BodyPosture::prone, "relax", 5);
  for (const Arm arm : both_arms) {
    REQUIRE_FALSE(ready.jobs[arm].empty());
    CHECK(ready.jobs[arm].back().path == -1);
    CHECK(ready.jobs[arm].back().posture_rad == ready.ready_rad[arm]);
    int step = -1;
    for (const motion::ArmJob& job : ready.jobs[arm]) {
      CHECK(job.step > step);
      step = job.step;
    }
  }
  std::vector<int> served(ready.plan.paths.size(), 0);
  for (const Arm arm : both_arms) {
    for (const motion::ArmJob& job : ready.jobs[arm]) {
      if (job.path >= 0) ++served[static_cast<std::size_t>(job.path)];
    }
  }
  for (const int times : served) CHECK(times == 1);
}

TEST_CASE("an arm on its own side is as far from its mirror image as twice its way to the middle") {
  const robot::RobotMount mount = robot::mount_for(BodyPosture::prone);
  const auto models = robot::both_models(robot::thesis_arm(), mount);
  const auto ready = robot::ready_posture(models[Arm::left].table(), mount);
  PerArm<motion::JointPath> stays;
  for (const Arm arm : both_arms) {
    motion::Rollout rollout(models[arm], 0.0, ready[arm], 0.2);
    rollout.transfer(control::tip_pose(models[arm].base_from_tool(ready[arm], 0.0), 17_mm),
                     ready[arm], stays[arm]);
    // A tool that is already there moves nothing.
    CHECK((rollout.q_rad() - ready[arm]).norm() < 1e-6);
  }
  const double apart_m =
      motion::distance_between_m(models, {.of = {&stays[Arm::left], &stays[Arm::right]}});
  const double inward_m = stays[Arm::left].inward_m(models[Arm::left], Arm::left);
  CHECK(inward_m == doctest::Approx(stays[Arm::right].inward_m(models[Arm::right], Arm::right)));
  CHECK(apart_m == doctest::Approx(-2.0 * inward_m).epsilon(1e-3));
}

TEST_CASE("low on the back the arms are light, or the plan says where they press with less") {
  for (const BodyPosture position : {BodyPosture::sitting, BodyPosture::prone}) {
    for (const char* what : {"lower_back"}) {
      CAPTURE(name_of(position));
      CAPTURE(what);
      const motion::ReadyPlan ready = ready_for("phantom:medium", position, what, 5);
      const robot::RobotMount mount = robot::mount_for(position);
      const auto models = robot::both_models(robot::thesis_arm(), mount);
      double max_kg = 0.0;
      for (const Arm arm : both_arms) {
        for (const motion::ArmJob& job : ready.jobs[arm]) {
          if (job.path < 0) continue;
          const auto& planned = ready.plan.paths[static_cast<std::size_t>(job.path)];
          const ContactPoint& middle = planned.path.points[planned.path.points.size() / 2];
          motion::JointPath passed, stay;
          motion::Rollout rollout(models[arm], ready.rail_m, job.posture_rad, 0.3);
          rollout.transfer({mount.base_from_couch * middle.at_in_couch,
                            mount.base_from_couch.linear() * middle.normal_in_couch},
                           job.posture_rad, passed);
          rollout.settle(job.posture_rad, passed);
          stay.q_rad.push_back(rollout.q_rad());
          stay.poses.push_back(models[arm].kinematics(rollout.q_rad(), ready.rail_m));
          const double mass_kg = motion::max_apparent_mass_kg(models[arm], ready.rail_m, stay);
          max_kg = std::max(max_kg, mass_kg);
          CAPTURE(planned.path.name);
          CAPTURE(mass_kg);
          // Rehearsed is the whole path with quick and slow elbows, and this is one place of it.
          double max_n = planned.cap_n;
          for (const ContactPoint& point : planned.path.points)
            max_n = std::max(max_n, point.force_n);
          CHECK(max_n < motion::max_pressing_n(mass_kg, planned.zone, 45.0) + 4.0);
        }
      }
      MESSAGE(fmt::format("{}, {}: felt as {:.1f} kg at most, {} notes", name_of(position), what,
                          max_kg, ready.plan.notes.size()));
    }
  }
}
