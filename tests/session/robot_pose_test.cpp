// SPDX-License-Identifier: Apache-2.0
#include "tuina/session/robot_pose.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <utility>

#include "tests/folder.hpp"
#include "tuina/core/io/file.hpp"
#include "tuina/core/random.hpp"
#include "tuina/sim/robot/robot_touches.hpp"

using namespace tuina;

namespace {

const robot::ArmTable table = robot::thesis_arm();

PerArm<robot::ArmModel> arms_for(BodyPosture position) {
  return robot::both_models(table, robot::mount_for(position));
}

std::vector<robot::Touch> touched(BodyPosture position, int rows, std::uint64_t seed,
                                  const sim::TouchErrors& errors = {}) {
  auto touches = sim::touch_board(table, robot::mount_for(position), position, rows, errors, seed);
  REQUIRE(touches.has_value());
  return *touches;
}

Vector3 middle_of_back(BodyPosture position) {
  return position == BodyPosture::sitting ? Vector3(0.0, 20_mm, 420_mm)
                                          : Vector3(0.0, -350_mm, 190_mm);
}

std::string why_refused(const std::vector<robot::Touch>& touches) {
  const auto pose = session::locate_robot(touches, arms_for(BodyPosture::sitting));
  REQUIRE_FALSE(pose.has_value());
  return pose.error().message;
}

}  // namespace

TEST_CASE("touches without errors give the pose of the robot exactly") {
  for (const BodyPosture position : {BodyPosture::sitting, BodyPosture::prone}) {
    const auto touches =
        touched(position, 2, 1, {.hand_m = 0.0, .joint_zero_rad = 0.0, .spot_m = 0.0});
    CHECK(touches.size() == 8);
    const auto pose = session::locate_robot(touches, arms_for(position));
    REQUIRE(pose.has_value());
    const Transform truth = robot::mount_for(position).base_from_couch;
    // The arms were led there by inverse kinematics, which stops at a fiftieth of a millimetre.
    CHECK((pose->base_from_couch.matrix() - truth.matrix()).norm() < 1e-4);
  }
}

TEST_CASE("the error of the robot's pose is a millimetre or two, and what it is said to be") {
  for (const BodyPosture position : {BodyPosture::sitting, BodyPosture::prone}) {
    for (const std::size_t count : {5U, 8U, 12U}) {
      double true2 = 0.0, said2 = 0.0;
      constexpr int runs = 100;
      for (std::uint64_t seed = 1; seed <= runs; ++seed) {
        auto touches = touched(position, count == 12 ? 3 : 2, seed);
        touches.resize(count);
        const auto pose = session::locate_robot(touches, arms_for(position));
        CAPTURE(seed);
        CAPTURE((pose ? "" : pose.error().message));
        REQUIRE(pose.has_value());
        const Transform truth = robot::mount_for(position).base_from_couch;
        for (const double aside : {-100_mm, 100_mm}) {
          const Vector3 place = middle_of_back(position) + Vector3(aside, 0.0, 0.0);
          true2 += (pose->base_from_couch * place - truth * place).squaredNorm() / (2.0 * runs);
          said2 += std::pow(pose->expected_error_m(place), 2) / (2.0 * runs);
        }
      }
      MESSAGE(std::string(name_of(position)), ", ", count, " touches: true ",
              to_mm(std::sqrt(true2)), " mm, said ", to_mm(std::sqrt(said2)), " mm");
      CHECK(std::sqrt(true2) < 2.5_mm);
      CHECK(std::sqrt(said2) > 0.7 * std::sqrt(true2));
      CHECK(std::sqrt(said2) < 1.5 * std::sqrt(true2));
    }
  }
}

TEST_CASE("touches that cannot be right are refused, and the cause is named") {
  const auto good = touched(BodyPosture::sitting, 3, 5);
  REQUIRE(session::locate_robot(good, arms_for(BodyPosture::sitting)).has_value());

  auto two = good;
  two.resize(2);
  CHECK(why_refused(two).find("2 spots were touched; at least 3") != std::string::npos);

  std::vector<robot::Touch> line;
  for (const robot::Touch& touch : good) {
    if (std::abs(touch.spot_in_couch.x()) < 10_mm) line.push_back(touch);
  }
  REQUIRE(line.size() >= 3);
  CHECK(why_refused(line).find("of one line") != std::string::npos);

  auto in_millimetres = good;
  for (robot::Touch& touch : in_millimetres) touch.spot_in_couch *= 1000.0;
  CHECK(why_refused(in_millimetres).find("millimetres?") != std::string::npos);

  auto bigger = good;
  for (robot::Touch& touch : bigger) touch.spot_in_couch *= 1.1;
  CHECK(why_refused(bigger).find("size of the board") != std::string::npos);

  auto another = good;
  another[4].spot_in_couch.z() += 60_mm;
  CHECK(why_refused(another).find("line 6: the arm was") != std::string::npos);

  CHECK(why_refused(touched(BodyPosture::prone, 3, 5)).find("would lean by") != std::string::npos);

  auto behind = good;
  for (robot::Touch& touch : behind) touch.spot_in_couch.x() *= -1.0;
  CHECK(why_refused(behind).find("from behind") != std::string::npos);
}

TEST_CASE("touches and pose survive their files, and a file that is wrong is refused by line") {
  const auto touches = touched(BodyPosture::prone, 2, 7);
  const test::Folder folder;
  const auto file = folder / "touches.csv";
  REQUIRE(write_file(file, session::to_csv(touches)).has_value());
  const auto again = session::read_touches(file, table);
  REQUIRE(again.has_value());
  const auto pose = session::locate_robot(*again, arms_for(BodyPosture::prone));
  const auto direct = session::locate_robot(touches, arms_for(BodyPosture::prone));
  REQUIRE(pose.has_value());
  REQUIRE(direct.has_value());
  CHECK((pose->base_from_couch.matrix() - direct->base_from_couch.matrix()).norm() < 1e-4);

  const std::string text =
      session::to_toml({.position = BodyPosture::prone, .base_from_couch = pose->base_from_couch});
  const auto read = session::parse_robot_pose(text, "robot.toml");
  REQUIRE(read.has_value());
  CHECK(read->position == BodyPosture::prone);
  CHECK((read->base_from_couch.matrix() - pose->base_from_couch.matrix()).norm() < 1e-12);

  for (const auto& [from, to] :
       {std::pair{"translation_m", "translation_mm"},
        std::pair{"rotation_vector_rad = [", "rotation_vector_rad = [nan, "},
        std::pair{"[robot]", "[rebot]"}, std::pair{"prone", "standing"}}) {
    std::string wrong = text;
    wrong.replace(wrong.find(from), std::string(from).size(), to);
    const auto refused = session::parse_robot_pose(wrong, "robot.toml");
    REQUIRE_FALSE(refused.has_value());
    CHECK(refused.error().message.find("robot.toml:") == 0);
  }

  for (const auto& [from, to, why] :
       {std::tuple{"\n0,", "\n2,", "touches.csv:3: arm is 2"},
        std::tuple{",1.00000\n", ",1.50000\n", "the normal is 1.500 long"}}) {
    std::string wrong = session::to_csv(touches);
    wrong.replace(wrong.find(from), std::string(from).size(), to);
    REQUIRE(write_file(file, wrong).has_value());
    const auto refused = session::read_touches(file, table);
    REQUIRE_FALSE(refused.has_value());
    CAPTURE(refused.error().message);
    CHECK(refused.error().message.find(why) != std::string::npos);
  }
}
