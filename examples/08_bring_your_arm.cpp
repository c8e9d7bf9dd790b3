// SPDX-License-Identifier: Apache-2.0
// A whole session with arms of your own: implement Robot, hand it to session::run. An ideal arm is
// integrated here where a driver would talk to motors.
#include <fmt/core.h>

#include <Eigen/Dense>

#include "simulated_order.hpp"
#include "tuina/robot.hpp"
#include "tuina/sim.hpp"
using namespace tuina;

namespace {

class MyRobot final : public robot::Robot {
 public:
  MyRobot(const sim::Person& person, const robot::RobotPlacement& stand)
      : models_(robot::both_models(stand.arm, stand.mount)),
        base_from_couch_(stand.mount.base_from_couch),
        skin_(person.skin_in_couch, sim::lay_tissue(person, 1)) {}

  Result<void> stand_ready(const robot::ReadyPose& pose) override {
    for (const Arm arm : both_arms) {
      now_.arms[arm].q_rad = pose.q_rad[arm];
      now_.arms[arm].dq_rad_per_s = JointVector::Zero(pose.q_rad[arm].size());
      torque_nm_[arm] = JointVector::Zero(pose.q_rad[arm].size());
    }
    now_.rail_m = pose.rail_m;
    return {};
  }
  std::optional<robot::RobotReading> read() noexcept override {
    for (const Arm arm : both_arms) move(arm, now_.arms[arm]);
    now_.time_s = control_period_s * static_cast<double>(++now_.tick);
    return now_;
  }
  void apply(const robot::RobotCommand& now) noexcept override { torque_nm_ = now.torque_nm; }
  const char* fault() const noexcept override { return nullptr; }

 private:
  void move(Arm arm, robot::ArmReading& state) noexcept {
    const auto dynamics = models_[arm].evaluate(state.q_rad, state.dq_rad_per_s, now_.rail_m);
    const Vector3 speed = dynamics.jacobian.topRows<3>() * state.dq_rad_per_s;
    const sim::ContactTruth& touch = skin_.touch(
        arm, now_.time_s, base_from_couch_.inverse() * dynamics.base_from_tool.translation(),
        base_from_couch_.linear().transpose() * speed);
    const Vector3 push_n = base_from_couch_.linear() * touch.on_tool_in_couch.force_n;
    const JointVector bent_nm = torque_nm_[arm] - dynamics.gravity_nm - dynamics.coriolis_nm +
                                dynamics.jacobian.topRows<3>().transpose() * push_n;
    state.dq_rad_per_s += control_period_s * dynamics.mass_kg_m2.ldlt().solve(bent_nm);
    state.q_rad += control_period_s * state.dq_rad_per_s;
    // The wrist sensor carries the tool and feels its weight, too.
    const double weight_n = models_[arm].table().tool_mass_kg * gravity_m_per_s2;
    state.wrench_in_tool.force_n =
        dynamics.base_from_tool.linear().transpose() * (push_n - weight_n * Vector3::UnitZ());
    state.wrench_in_tool.torque_nm.z() = 1e-9 * now_.time_s;  // one that is constant is stuck
    state.wrench_time_s = now_.time_s;
  }

  PerArm<robot::ArmModel> models_;
  Transform base_from_couch_;
  sim::BackContact skin_;
  robot::RobotReading now_;
  PerArm<JointVector> torque_nm_;
};

}  // namespace

int main() {
  const auto person = sim::parse_person("phantom:medium", BodyPosture::prone, 1).value();
  const auto stand = robot::place_robot(robot::load_robot("thesis").value(), person.position);
  const auto world = sim::World::make(person, stand, {}, 1).value();
  MyRobot mine(person, stand);
  session::Observers nobody({});
  const auto session =
      session::run({world->camera(), world->turntable(), mine}, simulated_order(*world), {}, nobody)
          .value();
  fmt::print("{} paths performed in {:.0f} s, {} stops\n", session.performed.size(),
             session.massage_s, session.stops.size());
  return session.stops.empty() && !session.performed.empty() ? 0 : 1;
}
