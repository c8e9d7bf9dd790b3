// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <memory>
#include <vector>

#include "tuina/core/random.hpp"
#include "tuina/sim/robot/plant.hpp"
#include "tuina/sim/robot/sensor_axis.hpp"

struct mjModel_;
struct mjData_;

namespace tuina::sim {

inline constexpr double tick_s = control_period_s;

struct FreeModel {
  void operator()(mjModel_* model) const;
};
struct FreeData {
  void operator()(mjData_* data) const;
};
using ModelPointer = std::unique_ptr<mjModel_, FreeModel>;
using DataPointer = std::unique_ptr<mjData_, FreeData>;

using Vector6 = Eigen::Matrix<double, 6, 1>;

/// Drives, gears and sensors of one arm.
struct ArmDevices {
  int joints = 0;
  // Index in qvel, and in qpos, since all joints before are hinges or slides.
  std::array<int, max_joints> dof = {};
  int site = -1;
  int tool_body = -1;
  double tool_mass_kg = 0.0;
  std::array<double, max_joints> torque_limit_nm = {}, coulomb_nm = {}, viscous = {};
  std::array<double, max_joints> windup_damping = {};

  std::array<double, max_joints> torque_nm = {};    // asked of the amplifiers
  std::array<double, max_joints> gravity_nm = {};   // held the arm when the last command came
  std::array<double, max_joints> friction_nm = {};  // Coulomb part
  std::array<double, max_joints> encoder_rad = {}, velocity_rad_per_s = {};
  // Elastic gears: the rotor, seen at the joint. A rigid gear has a stiffness of 0.
  std::array<double, max_joints> gear_nm_per_rad = {}, gear_damping = {}, rotor_inertia = {};
  std::array<double, max_joints> rotor_rad = {}, rotor_rad_per_s = {};
  // Of the motors: the torque that their current stands for, and how it is measured.
  std::array<double, max_joints> current_nm = {}, current_scale = {}, current_offset_nm = {};
  bool current_known = false;
  Vector3 last_velocity = Vector3::Zero();
  Vector6 felt = Vector6::Zero();     // in the tool frame, after the sensor's low-pass
  Vector6 sampled = Vector6::Zero();  // a millisecond ago
  std::array<SensorAxis, 6> wrist_axes = {};
  Eigen::Matrix<double, 6, 6> crosstalk = Eigen::Matrix<double, 6, 6>::Identity();

  Drive drive = Drive::commanded;
  bool powered = true, brake_wanted = false;
  bool stopped = false;  // by the emergency stop, for good
  bool caught = false;   // braked by the drives themselves, for good
  int damped_ticks = 0, unpowered_ticks = 0;
  std::array<double, max_joints> braked_at_rad = {};  // joint angles that the brakes hold
};

/// The shaft of a motor, seen at the joint: that of the joint itself if the gear is rigid.
struct Shaft {
  double rad, rad_per_s, inertia;
};

/// Physics, devices and ground truth. plant.cpp builds and steps it; plant_devices.cpp models the
/// sensors, plant_gears.cpp drives and gears, plant_brakes.cpp the brakes and what the drives do by
/// themselves.
struct Plant::World {
  PlantOptions options;
  Transform couch_from_base;
  BackContact* person = nullptr;
  ModelPointer model;
  DataPointer data;
  Random noise, current_noise;
  int substeps = 4;
  double step_s = 0.0;
  PerArm<ArmDevices> arms;
  PerArm<Wrench> hands;
  struct Held {
    int dof = 0;
    double q = 0.0;
    double effort_limit = 0.0;  ///< 0: unknown
  };
  std::vector<Held> held;
  int rail_dof = 0;
  double rail_wanted_m = 0.0, rail_now_m = 0.0, rail_speed = 0.0;
  double moving_kg = 0.0;
  std::uint64_t tick = 0;
  bool started = false;
  int unanswered = 0;  // readings since the last command
  static constexpr const char* ran_off =
      "its simulated motion has run off; are rotor_inertia_kg_m2, mass and friction of each link "
      "in "
      "its table those of a real arm?";
  const char* broken = nullptr;  ///< why it cannot be simulated any further
  PlantTruth truth;

  void sample_truth() noexcept;
  void touch(Arm arm) noexcept;
  void drive(ArmDevices& arm) noexcept;
  void soften_gears(ArmDevices& arm, const robot::ArmTable& table, Random& random);
  void spoil_wrist(ArmDevices& arm, Random& random);
  [[nodiscard]] Shaft shaft(const ArmDevices& arm, std::size_t joint) const noexcept;
  [[nodiscard]] double friction_of(ArmDevices& arm, std::size_t joint, double speed) noexcept;
  [[nodiscard]] double through_gear_nm(const ArmDevices& arm, std::size_t joint) const noexcept;
  void choose_drive(ArmDevices& arm) noexcept;
  [[nodiscard]] double motor_nm(ArmDevices& arm, std::size_t joint) const noexcept;
  [[nodiscard]] double brake_nm(ArmDevices& arm, std::size_t joint) const noexcept;
  [[nodiscard]] bool stands_still(const ArmDevices& arm) const noexcept;
  void drive_rail() noexcept;
  void hold(const Held& held) noexcept;
  void step() noexcept;
  void read_encoders(ArmDevices& arm) noexcept;
  [[nodiscard]] Wrench sample_wrist(ArmDevices& arm) noexcept;
  void spoil_currents();
  void flow(ArmDevices& arm, std::size_t joint, double motor_nm) noexcept;
  [[nodiscard]] JointVector measure_currents(const ArmDevices& arm) noexcept;
  void check_physics() noexcept;
};

}  // namespace tuina::sim
