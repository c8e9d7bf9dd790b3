// SPDX-License-Identifier: Apache-2.0
// Arms of amplifiers with an analog input, as the thesis' are: fill in DacEncoder with the library
// of your card, on the host's clock. Here ideal arms stand for a card, on a clock of its own.
#include <fmt/core.h>

#include <Eigen/Dense>

#include "tuina/hardware/analog_robot.hpp"
#include "tuina/robot/ready_posture.hpp"
using namespace tuina;

namespace {

constexpr double volts_per_nm = 0.08, counts_per_rad = 4096 * 100 / (2 * pi);

class MyCard final : public hardware::DacEncoder {
 public:
  MyCard(const PerArm<robot::ArmModel>& models, const PerArm<JointVector>& q_rad)
      : models_(models), q_rad_(q_rad) {
    for (const Arm arm : both_arms) speed_[arm] = torque_nm_[arm] = 0.0 * q_rad[arm];
  }

  // Your card sets volts, enable lines and brakes; in `read` it reads its counters.
  void write(std::span<const double> volts, const PerArm<bool>& powered) noexcept override {
    powered_ = powered;
    for (const Arm arm : both_arms)
      for (Eigen::Index i = 0; i < q_rad_[arm].size(); ++i, volts = volts.subspan(1))
        torque_nm_[arm][i] = volts.front() / volts_per_nm;
  }
  bool read(std::span<std::int64_t> counts) noexcept override {
    for (const Arm arm : both_arms) {
      move(arm);
      for (const double q_rad : q_rad_[arm]) {
        counts.front() = std::llround(q_rad * counts_per_rad);
        counts = counts.subspan(1);
      }
    }
    return true;
  }

 private:
  void move(Arm arm) noexcept {
    if (!powered_[arm]) return speed_[arm].setZero(), void();  // on its brakes
    const auto dynamics = models_[arm].evaluate(q_rad_[arm], speed_[arm], 0.0);
    const JointVector left_nm = torque_nm_[arm] - dynamics.gravity_nm - dynamics.coriolis_nm;
    speed_[arm] += control_period_s * dynamics.mass_kg_m2.ldlt().solve(left_nm);
    q_rad_[arm] += control_period_s * speed_[arm];
  }

  PerArm<robot::ArmModel> models_;
  PerArm<JointVector> q_rad_, speed_, torque_nm_;
  PerArm<bool> powered_;
};

}  // namespace

int main() {
  const robot::ArmTable table = robot::thesis_arm();
  robot::RobotMount mount = robot::mount_for(BodyPosture::sitting);
  mount.min_rail_m = mount.max_rail_m = 0.0;
  const auto models = robot::both_models(table, mount);
  const robot::ReadyPose ready = {.q_rad = robot::ready_posture(table, mount)};
  MyCard card(models, {.of = {ready.q_rad[Arm::left].array() + 5_deg, ready.q_rad[Arm::right]}});
  const std::vector joints(6, hardware::AnalogJoint{volts_per_nm, counts_per_rad, 0});
  const auto arms = hardware::AnalogRobot::open(card, {.of = {joints, joints}}, table, mount,
                                                hardware::AnalogRobot::Clock::card);
  if (!arms || !(*arms)->stand_ready(ready)) return 1;
  double off_rad = 0.0;
  robot::RobotCommand command;
  for (int i = 0; i < 500; ++i) {
    const auto reading = (*arms)->read().value();
    for (const Arm arm : both_arms)
      command.torque_nm[arm] = models[arm].gravity_nm(reading.arms[arm].q_rad);
    off_rad = (reading.arms[Arm::left].q_rad - ready.q_rad[Arm::left]).norm();
    (*arms)->apply(command);
  }
  fmt::print("half a second on their own torques, {:.3f} deg from ready\n", to_deg(off_rad));
  return off_rad < 1_deg ? 0 : 1;
}
