// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>

#include "tuina/core/random.hpp"
#include "tuina/core/result.hpp"
#include "tuina/robot/arm_table.hpp"
#include "tuina/robot/mount.hpp"
#include "tuina/robot/robot.hpp"
#include "tuina/robot/robot_model.hpp"
#include "tuina/sim/robot/back_contact.hpp"

namespace tuina::sim {

/// How wrong the table that a controller believes is about the arm that stands there.
struct TableErrors {
  double mass_spread = 0.10;      ///< each link's mass is drawn within this share
  double friction_spread = 0.20;  ///< each joint's friction
  double rotor_spread = 0.05;
  double mass_scale = 1.0;      ///< of all links alike, on top
  double friction_scale = 1.0;  ///< 0: an arm without friction
};

/// The arm that truly stands there, drawn around the one that is believed.
[[nodiscard]] robot::ArmTable draw_arm(const robot::ArmTable& believed, const TableErrors& errors,
                                       Random& random);

/// Sensors and drives: what the simulated devices can do. The thesis names the card (16-bit DAC,
/// Table 2-4) and the kind of wrist sensor; the rest are the values of devices of that kind.
struct PlantOptions {
  std::uint64_t seed = 1;
  double physics_hz = 4000.0;           ///< a multiple of 1 kHz
  double encoder_counts = 200'000.0;    ///< per turn of the joint; 0: exact
  double velocity_low_pass_hz = 100.0;  ///< of the differenced encoder
  int dac_bits = 16;                    ///< over plus and minus the torque limit
  double wrist_low_pass_hz = 100.0;
  double wrist_noise_n = 0.05;  ///< standard deviation of a sample
  double wrist_noise_nm = 0.001;
  double friction_windup_rad = 0.3e-3;  ///< a gear gives by so much before it slips
};

/// What only the simulation knows of one arm.
struct ArmTruth {
  JointVector q_rad;
  JointVector dq_rad_per_s;
  Transform couch_from_tool = Transform::Identity();
  Vector3 velocity_in_couch = Vector3::Zero();  ///< of the tool's origin
  ContactTruth contact;
};

struct PlantTruth {
  double time_s = 0.0;
  double rail_m = 0.0;
  PerArm<ArmTruth> arms;
};

/// A two-armed robot in MuJoCo with a person (or none) in front of it. `read` lets one millisecond
/// pass with the torques applied last and then looks; the first `read` looks at the start. Reading
/// and applying take no heap.
class Plant final : public robot::Robot {
 public:
  struct Start {
    PerArm<JointVector> q_rad;
    double rail_m = 0.0;
  };
  /// The robot of the thesis. `arms` are the true tables, `mount` the true one. The person may be
  /// null and must outlive the plant.
  [[nodiscard]] static Result<std::unique_ptr<Plant>> make(const robot::RobotMount& mount,
                                                           const PerArm<robot::ArmTable>& arms,
                                                           const Start& start, BackContact* person,
                                                           const PlantOptions& options = {});
  /// Any robot: drives hold what belongs to neither arm nor linear base where it stands.
  [[nodiscard]] static Result<std::unique_ptr<Plant>> make(const robot::RobotPlacement& placement,
                                                           const PerArm<robot::ArmTable>& arms,
                                                           const Start& start, BackContact* person,
                                                           const PlantOptions& options = {});
  ~Plant() override;
  Plant(const Plant&) = delete;
  Plant& operator=(const Plant&) = delete;

  [[nodiscard]] robot::RobotReading read() noexcept override;
  void apply(const robot::RobotCommand& command) noexcept override;
  [[nodiscard]] const char* fault() const noexcept override;

  /// A hand that leads the arm, at the tool's centre but above the wrist sensor, which does not
  /// feel it; it lasts until it is changed.
  void push(Arm arm, const Wrench& hand_in_base) noexcept;

  /// As of the last `read`.
  [[nodiscard]] const PlantTruth& truth() const noexcept;

 private:
  struct World;
  explicit Plant(std::unique_ptr<World> world);
  std::unique_ptr<World> world_;
};

}  // namespace tuina::sim
