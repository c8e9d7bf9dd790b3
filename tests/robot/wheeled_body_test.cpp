// SPDX-License-Identifier: Apache-2.0
#include "tuina/robot/wheeled_body.hpp"

#include <doctest/doctest.h>

#include <algorithm>

#include "tests/robot/oracles.hpp"
#include "tuina/core/random.hpp"
#include "tuina/robot/ready_posture.hpp"
#include "tuina/robot/robot_model.hpp"

using namespace tuina;
using namespace tuina::robot;

namespace {

constexpr double agreement = 1e-10;

const RobotModel successor = load_robot("successor").value();

Description successor_robot() {
  return wheeled_robot({.of = {successor.arm, successor.arm}},
                       successor.mounting(BodyPosture::prone).upright_from_shoulder);
}

double largest(const Eigen::Ref<const Eigen::MatrixXd>& difference) {
  return difference.cwiseAbs().maxCoeff();
}

JointVector draw(Random& random, double range) {
  JointVector q(7);
  for (int i = 0; i < 7; ++i) q[i] = uniform(random, -range, range);
  return q;
}

struct Simulated {
  std::unique_ptr<mjModel, MujocoFree> model;
  std::unique_ptr<mjData, MujocoFree> data;

  explicit Simulated(const std::string& xml)
      : model(mujoco_model(xml)), data(mj_makeData(model.get())) {}

  [[nodiscard]] int dof(const std::string& part) const {
    int joint = mj_name2id(model.get(), mjOBJ_JOINT, part.c_str());
    if (joint < 0) joint = mj_name2id(model.get(), mjOBJ_JOINT, (part + "_joint").c_str());
    REQUIRE(joint >= 0);
    return model->jnt_dofadr[joint];
  }
  void set(const Description& robot, const std::vector<double>& q, const std::vector<double>& dq) {
    for (std::size_t i = 0; i < robot.parts.size(); ++i) {
      data->qpos[dof(robot.parts[i].name)] = q[i];
      data->qvel[dof(robot.parts[i].name)] = dq[i];
    }
    mj_fwdPosition(model.get(), data.get());
    mj_fwdVelocity(model.get(), data.get());
  }
  [[nodiscard]] Eigen::MatrixXd mass() const {
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> full(model->nv,
                                                                                model->nv);
    mj_fullM(model.get(), full.data(), data->qM);
    return full;
  }
};

struct WholeState {
  std::vector<double> q, dq;
};

WholeState draw(const Description& robot, Random& random) {
  WholeState state;
  for (const Part& part : robot.parts) {
    state.q.push_back(part.limited ? uniform(random, part.lowest, part.highest)
                                   : uniform(random, -pi, pi));
    state.dq.push_back(uniform(random, -2.0, 2.0));
  }
  return state;
}

}  // namespace

TEST_CASE("in the whole successor, however it stands, MuJoCo finds arms and parts where we do") {
  const Description robot = successor_robot();
  Simulated mujoco(to_mjcf(robot, 1e-3));
  REQUIRE(mujoco.model->nv == 3 + 4 + 3 + 2 + 14);
  Random random = make_random(2, "successor");
  double worst = 0.0;
  for (int n = 0; n < 5'000; ++n) {
    WholeState state = draw(robot, random);
    // The arms alone move: then what the model says of an arm is what MuJoCo says of it.
    for (std::size_t i = 0; i < robot.parts.size(); ++i) {
      const std::string& name = robot.parts[i].name;
      if (!name.starts_with("left_") && !name.starts_with("right_")) state.dq[i] = 0.0;
    }
    mujoco.set(robot, state.q, state.dq);
    const auto poses = base_from_parts(robot, state.q);
    for (std::size_t i = 0; i < robot.parts.size(); ++i) {
      const int body = mj_name2id(mujoco.model.get(), mjOBJ_BODY, robot.parts[i].name.c_str());
      worst =
          std::max(worst, (poses[i].translation() - Vector3(mujoco.data->xpos + 3 * body)).norm());
    }
    const RobotMount mount = mount_in(robot, state.q);
    const Eigen::MatrixXd mass = mujoco.mass();
    for (const Arm arm : both_arms) {
      const ArmModel model(successor.arm, mount, arm);
      JointVector q(7), dq(7), bias(7);
      Eigen::Index first = 0;
      for (int i = 0; i < 7; ++i) {
        const std::string part =
            std::string(name_of(arm)) + "_" + model.table().links[static_cast<std::size_t>(i)].name;
        const int dof = mujoco.dof(part);
        if (i == 0) first = dof;
        q[i] = mujoco.data->qpos[dof];
        dq[i] = mujoco.data->qvel[dof];
        bias[i] = mujoco.data->qfrc_bias[dof];
      }
      const ArmDynamics ours = model.evaluate(q, dq, 0.0);
      const int site =
          mj_name2id(mujoco.model.get(), mjOBJ_SITE, (std::string(name_of(arm)) + "_tool").c_str());
      worst = std::max(
          {worst,
           (ours.base_from_tool.translation() - Vector3(mujoco.data->site_xpos + 3 * site)).norm(),
           largest(ours.mass_kg_m2 - mass.block(first, first, 7, 7)),
           largest(ours.coriolis_nm + ours.gravity_nm - bias)});
    }
  }
  CHECK(worst < agreement);
}

TEST_CASE("URDF and MJCF of both robots are the same machine, but for the rotors URDF cannot say") {
  const ArmTable arm = thesis_arm();
  for (Description robot :
       {successor_robot(), describe(mount_for(BodyPosture::sitting), {.of = {arm, arm}})}) {
    for (Part& part : robot.parts) part.rotor_inertia_kg_m2 = 0.0;
    Simulated mjcf(to_mjcf(robot, 1e-3)), urdf(to_urdf(robot));
    REQUIRE(urdf.model->nv == mjcf.model->nv);
    Random random = make_random(3, "urdf");
    double worst = 0.0;
    for (int n = 0; n < 200; ++n) {
      const WholeState state = draw(robot, random);
      mjcf.set(robot, state.q, state.dq);
      urdf.set(robot, state.q, state.dq);
      const Eigen::MatrixXd m = mjcf.mass(), u = urdf.mass();
      for (const Part& a : robot.parts) {
        worst = std::max(worst, std::abs(mjcf.data->qfrc_bias[mjcf.dof(a.name)] -
                                         urdf.data->qfrc_bias[urdf.dof(a.name)]));
        for (const Part& b : robot.parts) {
          worst = std::max(worst, std::abs(m(mjcf.dof(a.name), mjcf.dof(b.name)) -
                                           u(urdf.dof(a.name), urdf.dof(b.name))));
        }
      }
    }
    CHECK(worst < 1e-9);
    for (const Part& part : robot.parts) {
      const int joint = mj_name2id(urdf.model.get(), mjOBJ_JOINT, (part.name + "_joint").c_str());
      CHECK((urdf.model->jnt_limited[joint] != 0) == part.limited);
      if (part.limited) CHECK(urdf.model->jnt_range[2 * joint] == doctest::Approx(part.lowest));
    }
  }
}

TEST_CASE("with seven joints the arm still has a mirror image") {
  const RobotMount mount = mount_for(BodyPosture::prone);
  const ArmTable table = successor.arm;
  const ArmModel left(table, mount, Arm::left), right(table, mount, Arm::right);
  Random random = make_random(5, "mirror");
  for (int n = 0; n < 100; ++n) {
    const JointVector q = draw(random, 1.0);
    const Vector3 one = left.base_from_tool(q, 0.0).translation();
    const Vector3 other = right.base_from_tool(mirrored(table, mount, q), 0.0).translation();
    CHECK((one.cwiseProduct(Vector3(1, -1, 1)) - other).norm() < 1e-12);
  }
}
