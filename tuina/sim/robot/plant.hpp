// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
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

/// Spread of the true arm about the table that a controller believes.
struct TableErrors {
  double mass_spread = 0.10;      ///< relative, per link
  double friction_spread = 0.20;  ///< relative, per joint
  double rotor_spread = 0.05;
  double mass_scale = 1.0;       ///< all links alike, in addition
  double friction_scale = 1.0;   ///< 0: no friction
  double tool_mass_share = 0.0;  ///< the tool is heavier or lighter by just this share
};

/// Draws the true arm around the believed one.
[[nodiscard]] robot::ArmTable draw_arm(const robot::ArmTable& believed, const TableErrors& errors,
                                       Random& random);

/// What gears and wrist sensors do beyond lag, noise and friction; all zero, nothing.
struct DeviceFlaws {
  /// 0: rigid. 1: as the arm's table says; where it says nothing, 140 Nm/rad for each Nm that the
  /// drive can give, 15000 at a shoulder, as harmonic drives of that size have [tuttle1992].
  /// Encoders sit at the motors then.
  double gear_softness = 0.0;
  double gear_spread = 0.2;          ///< relative, per joint
  double backlash_rad = 0.0;         ///< of an elastic gear, at the joint
  double torque_ripple_share = 0.0;  ///< twice in a turn of the motor, 100 to one of the joint
  /// Friction grows by this share under the full torque and shrinks by it as the gears warm up.
  double friction_drift_share = 0.0;
  double wrist_drift_n_per_s = 0.0;     ///< at most
  double wrist_hysteresis_share = 0.0;  ///< of the strongest it has felt
  double wrist_crosstalk_share = 0.0;   ///< at most, from each axis to each; on the own: its gain
};

/// Sensors and drives. The thesis names the card (16-bit DAC, Table 2-4) and the kind of wrist
/// sensor; the rest is typical of such devices.
struct PlantOptions {
  std::uint64_t seed = 1;
  double physics_hz = 4000.0;           ///< a multiple of 1 kHz
  double encoder_counts = 200'000.0;    ///< per turn of the joint; 0: exact
  double velocity_low_pass_hz = 100.0;  ///< of the differentiated encoder
  int dac_bits = 16;                    ///< over plus and minus the torque limit
  double wrist_low_pass_hz = 100.0;
  double wrist_noise_n = 0.05;  ///< standard deviation of a sample
  double wrist_noise_nm = 0.001;
  double friction_windup_rad = 0.3e-3;  ///< travel of a gear before it slips
  /// Currents that the drives measure and tell as torques, shares of their limits: errors of scale
  /// and offset at most, standard deviation of the noise.
  bool drives_tell = true;
  double current_scale_share = 0.03, current_offset_share = 0.005, current_noise_share = 0.005;
  double current_low_pass_hz = 300.0;
  int watchdog_ticks = 20;  ///< readings without a command that the drives bear; 0: any number
  DeviceFlaws flaws = {};
};

/// Who has the joints of an arm.
enum class Drive : std::uint8_t {
  commanded,  ///< whoever applied torques last
  damped,     ///< the drives themselves: nobody has commanded them for too long
  off,        ///< nobody: no power, and the brakes have not closed yet
  braked,
};
/// Name of a drive, as the configuration has it.
[[nodiscard]] constexpr const char* name_of(Drive drive) {
  constexpr std::array names = {"commanded", "damped", "off", "braked"};
  return names[static_cast<std::size_t>(drive)];
}

/// Ground truth of one arm.
struct ArmTruth {
  JointVector q_rad;
  JointVector dq_rad_per_s;
  Transform couch_from_tool = Transform::Identity();
  Vector3 velocity_in_couch = Vector3::Zero();  ///< velocity of the tool's origin
  ContactTruth contact;
  Drive drive = Drive::commanded;
};

/// What the robot truly does at one moment.
struct PlantTruth {
  double time_s = 0.0;
  double rail_m = 0.0;
  PerArm<ArmTruth> arms;
};

/// A two-armed robot in MuJoCo, optionally with a person. `read` advances one millisecond under the
/// last applied torques and then samples; the first `read` samples the start. When the commands
/// stop coming, the drives do what `robot::Robot` asks of them, and obey again unless they have
/// braked. No heap in `read` and `apply`.
class Plant final : public robot::Robot {
 public:
  /// Where it stands before the first millisecond.
  struct Start {
    PerArm<JointVector> q_rad;
    double rail_m = 0.0;
  };
  /// Two arms on a linear base. `arms` and `mount` are the true ones. `person` may be null and must
  /// outlive the plant.
  [[nodiscard]] static Result<std::unique_ptr<Plant>> make(const robot::RobotMount& mount,
                                                           const PerArm<robot::ArmTable>& arms,
                                                           const Start& start, BackContact* person,
                                                           const PlantOptions& options = {});
  /// Any robot; joints outside arms and linear base are held by drives.
  [[nodiscard]] static Result<std::unique_ptr<Plant>> make(const robot::RobotPlacement& placement,
                                                           const PerArm<robot::ArmTable>& arms,
                                                           const Start& start, BackContact* person,
                                                           const PlantOptions& options = {});
  ~Plant() override;
  Plant(const Plant&) = delete;
  Plant& operator=(const Plant&) = delete;

  /// The plant was made where it stands.
  [[nodiscard]] Result<void> stand_ready(const robot::ReadyPose&) override { return {}; }
  [[nodiscard]] std::optional<robot::RobotReading> read() noexcept override;
  void apply(const robot::RobotCommand& command) noexcept override;
  [[nodiscard]] const char* fault() const noexcept override;

  /// Force of a hand on the tool centre, above the wrist sensor, which does not feel it. Lasts
  /// until changed.
  void push(Arm arm, const Wrench& hand_in_base) noexcept;
  /// From the next millisecond on the arm has no power: no torque, and brakes after 50 ms.
  void cut_power(Arm arm) noexcept;
  /// From the next millisecond on the drives of both arms heed nobody: for good they do what they
  /// do without commands, as a stop of category 1 [iec60204], which brakes last.
  void emergency_stop() noexcept;

  /// State at the last `read`.
  [[nodiscard]] const PlantTruth& truth() const noexcept;

 private:
  struct World;
  explicit Plant(std::unique_ptr<World> world);
  std::unique_ptr<World> world_;
};

}  // namespace tuina::sim
