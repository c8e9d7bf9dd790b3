// SPDX-License-Identifier: Apache-2.0
#include "tuina/robot/whole_body.hpp"

#include <doctest/doctest.h>

#include <algorithm>

#include "tests/robot/oracles.hpp"
#include "tuina/core/random.hpp"
#include "tuina/robot/successor.hpp"

using namespace tuina;
using namespace tuina::robot;

namespace {

std::vector<double> draw(const Description& robot, Random& random) {
  std::vector<double> q;
  for (const Part& part : robot.parts)
    q.push_back(part.limited ? uniform(random, part.lowest, part.highest)
                             : uniform(random, -pi, pi));
  return q;
}

/// Both hands on a person who lies before the robot, 0.75 m above the floor.
PerArm<std::optional<ContactGoal>> on_the_bed(double ahead_m) {
  const auto place = [&](double left_m) {
    return ContactGoal{.at_in_base = {ahead_m, left_m, 0.75}, .normal_in_base = Vector3::UnitZ()};
  };
  return {.of = {place(0.12), place(-0.12)}};
}

WholePosture reach(const Description& robot, double ahead_m,
                   const std::vector<std::string>& moving) {
  std::vector<double> q(robot.parts.size(), 0.0);
  return reach_with(robot, q, on_the_bed(ahead_m), successor_arm().tool_radius_m, moving);
}

}  // namespace

TEST_CASE("wheels, base, waist and arms move the successor's tools as MuJoCo says") {
  const Description robot = successor_robot();
  const auto model = mujoco_model(to_mjcf(robot, 1e-3));
  const std::unique_ptr<mjData, MujocoFree> data(mj_makeData(model.get()));
  Random random = make_random(4, "whole body");
  double worst = 0.0;
  for (int n = 0; n < 1'000; ++n) {
    const std::vector<double> q = draw(robot, random);
    std::vector<int> dofs;
    for (std::size_t i = 0; i < q.size(); ++i) {
      const int joint = mj_name2id(model.get(), mjOBJ_JOINT, robot.parts[i].name.c_str());
      REQUIRE(joint >= 0);
      dofs.push_back(model->jnt_dofadr[joint]);
      data->qpos[model->jnt_qposadr[joint]] = q[i];
    }
    mj_fwdPosition(model.get(), data.get());
    for (const char* name : {"left_tool", "right_tool"}) {
      const Marker* tool = find_marker(robot, name);
      REQUIRE(tool != nullptr);
      const MarkerKinematics ours = kinematics_of(robot, q, *tool);
      const int site = mj_name2id(model.get(), mjOBJ_SITE, name);
      Eigen::Matrix<double, 6, Eigen::Dynamic, Eigen::RowMajor> theirs(6, model->nv);
      mj_jacSite(model.get(), data.get(), theirs.data(), theirs.data() + 3 * model->nv, site);
      worst = std::max(
          worst,
          (ours.base_from_marker.translation() - Vector3(data->site_xpos + 3 * site)).norm());
      for (std::size_t i = 0; i < q.size(); ++i) {
        worst =
            std::max(worst, (ours.jacobian.col(static_cast<Eigen::Index>(i)) - theirs.col(dofs[i]))
                                .cwiseAbs()
                                .maxCoeff());
      }
    }
  }
  CHECK(worst < 1e-10);
}

TEST_CASE("where the arms alone are too short the successor bends its waist") {
  const Description robot = successor_robot();
  constexpr double far_m = 0.85;
  CHECK_FALSE(reach(robot, far_m, {"left_", "right_"}).reached);
  const WholePosture bent = reach(robot, far_m, {"waist", "left_", "right_"});
  REQUIRE(bent.reached);
  for (std::size_t i = 0; i < robot.parts.size(); ++i) {
    const Part& part = robot.parts[i];
    CAPTURE(part.name);
    if (part.limited) CHECK(bent.q[i] >= part.lowest);
    if (part.limited) CHECK(bent.q[i] <= part.highest);
    if (part.name == "waist_pitch") CHECK(bent.q[i] > 5_deg);
    if (part.name.starts_with("base") || part.name.starts_with("wheel")) CHECK(bent.q[i] == 0.0);
  }
  for (const Arm arm : both_arms) {
    const Marker* tool = find_marker(robot, std::string(name_of(arm)) + "_tool");
    const ContactGoal goal = *on_the_bed(far_m)[arm];
    const Transform at = kinematics_of(robot, bent.q, *tool).base_from_marker;
    const Vector3 foremost = at.translation() - successor_arm().tool_radius_m * Vector3::UnitZ();
    CHECK((foremost - goal.at_in_base).norm() < 1e-4);
    CHECK(at.linear().col(0).dot(-goal.normal_in_base) > 0.9999);
  }
}

TEST_CASE("the successor's base drives to what its waist cannot bend to") {
  const Description robot = successor_robot();
  CHECK_FALSE(reach(robot, 1.6, {"waist", "left_", "right_"}).reached);
  CHECK(reach(robot, 1.6, {"base_", "waist", "left_", "right_"}).reached);
}
