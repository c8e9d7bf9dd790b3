// SPDX-License-Identifier: Apache-2.0
#include "tuina/robot/arm_model.hpp"

#include <doctest/doctest.h>

#include <kdl/chaindynparam.hpp>
#include <kdl/chainfksolverpos_recursive.hpp>
#include <kdl/chainjnttojacdotsolver.hpp>
#include <kdl/chainjnttojacsolver.hpp>

#include "tests/allocation.hpp"
#include "tests/robot/oracles.hpp"
#include "tuina/core/random.hpp"
#include "tuina/robot/ready_posture.hpp"
#include "tuina/robot/robot_model.hpp"

using namespace tuina;
using namespace tuina::robot;

namespace {

constexpr int random_states = 10'000;
constexpr double agreement = 1e-10;

struct State {
  JointVector q, dq;
};

State draw(Random& random, int joints = 6) {
  State state{JointVector(joints), JointVector(joints)};
  for (int i = 0; i < joints; ++i) {
    state.q[i] = uniform(random, -pi, pi);
    state.dq[i] = uniform(random, -3.0, 3.0);
  }
  return state;
}

/// A mount that stands on no axis, so that a wrong gravity or rail direction cannot hide.
RobotMount askew() {
  RobotMount mount = mount_for(BodyPosture::prone);
  const Transform tilt(Eigen::AngleAxisd(0.4, Vector3(1, 2, 3).normalized()));
  for (const Arm arm : both_arms)
    mount.base_from_shoulder[arm] = tilt * mount.base_from_shoulder[arm];
  mount.rail_axis_in_base = Vector3(2, 1, -1).normalized();
  return mount;
}

double largest(const Eigen::Ref<const Eigen::MatrixXd>& difference) {
  return difference.cwiseAbs().maxCoeff();
}

/// The largest difference to KDL in everything that the model of an arm says.
double difference_to_kdl(const ArmTable& table) {
  const RobotMount mount = askew();
  const int joints = table.joints;
  const ArmModel model(table, mount, Arm::right);
  constexpr double rail_m = 0.2;
  const KDL::Chain chain = kdl_chain(table, mount.base_from_shoulder_at(Arm::right, rail_m));
  KDL::ChainFkSolverPos_recursive forward(chain);
  KDL::ChainJntToJacSolver jacobian_solver(chain);
  KDL::ChainJntToJacDotSolver jacobian_dot_solver(chain);
  KDL::ChainDynParam dynamics(chain, KDL::Vector(0, 0, -gravity_m_per_s2));
  Random random = make_random(1, "arm states");
  double worst = 0.0;
  for (int n = 0; n < random_states; ++n) {
    const State state = draw(random, joints);
    const ArmDynamics ours = model.evaluate(state.q, state.dq, rail_m);
    KDL::JntArray q(joints), dq(joints), coriolis(joints), gravity(joints);
    q.data = state.q;
    dq.data = state.dq;
    KDL::Frame pose;
    KDL::Jacobian jacobian(joints);
    KDL::Twist bias;
    KDL::JntSpaceInertiaMatrix mass(joints);
    REQUIRE(forward.JntToCart(q, pose) >= 0);
    REQUIRE(jacobian_solver.JntToJac(q, jacobian) >= 0);
    REQUIRE(jacobian_dot_solver.JntToJacDot(KDL::JntArrayVel(q, dq), bias) >= 0);
    REQUIRE(dynamics.JntToMass(q, mass) >= 0);
    REQUIRE(dynamics.JntToCoriolis(q, dq, coriolis) >= 0);
    REQUIRE(dynamics.JntToGravity(q, gravity) >= 0);
    const Vector3 position(pose.p.data);
    const Eigen::Matrix<double, 3, 3, Eigen::RowMajor> turn(pose.M.data);
    Vector6 bias_vector;
    bias_vector << bias.vel.x(), bias.vel.y(), bias.vel.z(), bias.rot.x(), bias.rot.y(),
        bias.rot.z();
    worst = std::max(
        {worst, (ours.base_from_tool.translation() - position).norm(),
         largest(ours.base_from_tool.linear() - turn), largest(ours.jacobian - jacobian.data),
         largest(ours.jacobian_dot_dq - bias_vector), largest(ours.mass_kg_m2 - mass.data),
         largest(ours.coriolis_nm - coriolis.data), largest(ours.gravity_nm - gravity.data)});
  }
  return worst;
}

}  // namespace

TEST_CASE("the bent arm of the thesis' table has its tool at (0.3, 0.4, 0) m from the shoulder") {
  const RobotMount mount;
  const ArmModel arm(thesis_arm(), mount, Arm::left);
  const Vector3 tool_in_base = arm.base_from_tool(JointVector::Zero(6), 0.0).translation();
  CHECK((tool_in_base - Vector3(0.3, 0.4, 0.0)).norm() < 1e-12);
  CHECK(arm.reach_m() == doctest::Approx(0.7));
}

TEST_CASE(
    "pose, Jacobian, its derivative, mass, Coriolis and gravity agree with KDL on 10^4 states") {
  for (const ShippedRobot& robot : shipped_robots()) {
    CAPTURE(robot.name);
    CHECK(difference_to_kdl(load_robot(robot.name)->arm) < agreement);
  }
}

TEST_CASE("both arms agree with MuJoCo's reading of the generated MJCF on 10^4 states") {
  const RobotMount mount = askew();
  const PerArm<ArmTable> tables{.of = {thesis_arm(), thesis_arm()}};
  const auto m = mujoco_model(to_mjcf(mount, tables, 0.001));
  const std::unique_ptr<mjData, MujocoFree> d(mj_makeData(m.get()));
  REQUIRE(m->nv == 13);
  const std::array<ArmModel, 2> models = {ArmModel(tables[Arm::left], mount, Arm::left),
                                          ArmModel(tables[Arm::right], mount, Arm::right)};
  Random random = make_random(2, "arm states");
  double worst = 0.0;
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> full_mass(13, 13),
      velocity(3, 13), turning(3, 13);
  for (int n = 0; n < random_states / 2; ++n) {
    const PerArm<State> states{.of = {draw(random), draw(random)}};
    const double rail_m = uniform(random, -0.3, 0.3);
    d->qpos[0] = rail_m;
    d->qvel[0] = 0.0;
    for (const Arm arm : both_arms) {
      for (int i = 0; i < 6; ++i) {
        const int k = 1 + 6 * static_cast<int>(arm) + i;
        d->qpos[k] = states[arm].q[i];
        d->qvel[k] = states[arm].dq[i];
      }
    }
    mj_fwdPosition(m.get(), d.get());
    mj_fwdVelocity(m.get(), d.get());
    mj_fullM(m.get(), full_mass.data(), d->qM);
    // With no acceleration at all, MuJoCo's cacc holds the motion's own part, less gravity.
    mju_zero(d->qacc, m->nv);
    mju_zero(d->qfrc_applied, m->nv);
    mj_rnePostConstraint(m.get(), d.get());
    for (const Arm arm : both_arms) {
      const ArmDynamics ours =
          models[static_cast<std::size_t>(arm)].evaluate(states[arm].q, states[arm].dq, rail_m);
      const int site =
          mj_name2id(m.get(), mjOBJ_SITE, arm == Arm::left ? "left_tool" : "right_tool");
      const int first = 1 + 6 * static_cast<int>(arm);
      mj_jacSite(m.get(), d.get(), velocity.data(), turning.data(), site);
      const Vector3 position(d->site_xpos + 3 * site);
      const Eigen::Matrix<double, 3, 3, Eigen::RowMajor> turn(d->site_xmat + 9 * site);
      double acceleration[6];
      mj_objectAcceleration(m.get(), d.get(), mjOBJ_SITE, site, acceleration, 0);
      Vector6 bias;  // MuJoCo puts the rotation first
      bias << acceleration[3], acceleration[4], acceleration[5], acceleration[0], acceleration[1],
          acceleration[2];
      bias.head<3>() += Vector3(0, 0, -gravity_m_per_s2);
      const Eigen::Map<const Eigen::VectorXd> qfrc_bias(d->qfrc_bias + first, 6);
      worst = std::max({worst, (ours.base_from_tool.translation() - position).norm(),
                        largest(ours.base_from_tool.linear() - turn),
                        largest(ours.jacobian.topRows<3>() - velocity.middleCols(first, 6)),
                        largest(ours.jacobian.bottomRows<3>() - turning.middleCols(first, 6)),
                        largest(ours.jacobian_dot_dq - bias),
                        largest(ours.mass_kg_m2 - full_mass.block(first, first, 6, 6)),
                        largest(ours.coriolis_nm + ours.gravity_nm - qfrc_bias)});
    }
  }
  CHECK(worst < agreement);
}

TEST_CASE("the short forms say the same as the full evaluation") {
  const ArmModel model(thesis_arm(), askew(), Arm::left);
  Random random = make_random(3, "arm states");
  for (int n = 0; n < 100; ++n) {
    const State state = draw(random);
    const ArmDynamics full = model.evaluate(state.q, state.dq, 0.1);
    const auto kinematics = model.kinematics(state.q, 0.1);
    CHECK(largest(full.base_from_tool.matrix() - kinematics.base_from_tool.matrix()) < 1e-12);
    CHECK(largest(full.jacobian - kinematics.jacobian) < 1e-12);
    CHECK(largest(full.gravity_nm - model.gravity_nm(state.q)) < 1e-12);
  }
}

TEST_CASE("the apparent mass is the inverse of the mobility along one direction") {
  const ArmModel model(thesis_arm(), mount_for(BodyPosture::sitting), Arm::left);
  Random random = make_random(4, "arm states");
  for (int n = 0; n < 100; ++n) {
    const State state = draw(random);
    const ArmDynamics dynamics = model.evaluate(state.q, state.dq, 0.0);
    const Vector3 along = Vector3(uniform(random, -1, 1), uniform(random, -1, 1), 1).normalized();
    const double mobility = along.dot(tool_mobility(dynamics).topLeftCorner<3, 3>() * along);
    CHECK(apparent_mass_kg(dynamics, along) == doctest::Approx(1.0 / mobility));
  }
}

TEST_CASE("a tool yields unseen by what its gears wind up under a force") {
  ArmTable table = thesis_arm();
  table.links[1].gear_nm_per_rad = rigid_gear_nm_per_rad;  // an encoder at the joint sees all of it
  table.links[2].gear_nm_per_rad = 0.0;                    // nobody knows it: a usual one
  const ArmModel model(table, askew(), Arm::left);
  Random random = make_random(7, "arm states");
  constexpr double force_n = 20.0, rail_m = 0.1;
  for (int n = 0; n < 100; ++n) {
    const State state = draw(random);
    const Vector3 along = Vector3(state.dq.head<3>()).normalized();
    const auto seen = model.kinematics(state.q, rail_m);
    JointVector q = state.q;
    for (int i = 0; i < table.joints; ++i) {
      const double stiffness = i == 2 ? 140.0 * table.links[2].torque_limit_nm
                                      : table.links[static_cast<std::size_t>(i)].gear_nm_per_rad;
      const double torque_nm = force_n * seen.jacobian.col(i).head<3>().dot(along);
      q[i] += torque_nm / stiffness;
    }
    const Vector3 moved_m =
        model.base_from_tool(q, rail_m).translation() - seen.base_from_tool.translation();
    const double yields = unseen_yield_m_per_n(table, seen.jacobian, along);
    CHECK(force_n * yields == doctest::Approx(moved_m.dot(along)).epsilon(0.02).scale(1e-4));
  }
  for (Link& link : table.links) link.gear_nm_per_rad = rigid_gear_nm_per_rad;
  CHECK(unseen_yield_m_per_n(table, model.kinematics(draw(random).q, 0.0).jacobian,
                             Vector3::UnitX()) == 0.0);
}

TEST_CASE("an arm in a mirrored posture is the other arm's mirror image") {
  const RobotMount mount = mount_for(BodyPosture::prone);
  const ArmTable table = thesis_arm();
  const ArmModel left(table, mount, Arm::left), right(table, mount, Arm::right);
  Random random = make_random(5, "arm states");
  for (int n = 0; n < 100; ++n) {
    const JointVector q = draw(random).q;
    const auto one = left.kinematics(q, 0.0).origins_in_base;
    const auto other = right.kinematics(mirrored(table, mount, q), 0.0).origins_in_base;
    for (std::size_t i = 0; i <= 6; ++i) {
      CHECK((one[i].cwiseProduct(Vector3(1, -1, 1)) - other[i]).norm() < 1e-12);
    }
  }
}

TEST_CASE("the model takes nothing from the heap") {
  const ArmModel model(thesis_arm(), mount_for(BodyPosture::sitting), Arm::left);
  Random random = make_random(6, "arm states");
  const State state = draw(random);
  const auto before = test::allocations();
  const ArmDynamics dynamics = model.evaluate(state.q, state.dq, 0.0);
  const double mass = apparent_mass_kg(dynamics, Vector3::UnitX());
  const auto kinematics = model.kinematics(state.q, 0.0);
  CHECK(test::allocations() == before);
  CHECK(std::isfinite(mass + kinematics.jacobian.sum()));
}
