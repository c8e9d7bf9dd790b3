// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>

#include "tuina/core/result.hpp"
#include "tuina/robot/robot.hpp"
#include "tuina/robot/robot_model.hpp"
#include "tuina/scanner/camera.hpp"
#include "tuina/scanner/turntable.hpp"
#include "tuina/sim/person/person.hpp"
#include "tuina/sim/robot/plant.hpp"
#include "tuina/sim/scanner/laser_scanner.hpp"

namespace tuina::sim {

/// What a simulated session may be told of its world, beside the person and the robot.
struct WorldOptions {
  double torso_n_per_m = 35e3;
  double skin_friction = 0.1;  ///< Coulomb coefficient
  LivingBack living = {};
  Breathing breathing = {0.0, 0.25};
  double tissue_change_share = 0.0;  ///< of alpha, against what the seed draws
  double shift_m = 0.0;              ///< the person moves by so much out of the back, once
  double shift_at_s = 0.0;
  double room_light_dn = 10.0;
  ScanFlaws scan_flaws = {};
  TableErrors arm_errors = {};  ///< of the true arms against their table
  PlantOptions devices = {};    ///< sensors and drives; their seed is the world's
  /// Milliseconds of the robot in one of the clock; nothing: as fast as they are computed.
  std::optional<double> pace = {};
};

/// The world of a session without hardware: a person with tissue and breath, a two-armed robot and
/// a laser line scanner before them, each with the errors that the seed draws. The session sees it
/// through the interfaces of devices; the truth is for observers of the simulation only.
class World {
 public:
  /// Fails where the person or the robot cannot be simulated.
  [[nodiscard]] static Result<std::unique_ptr<World>> make(const Person& person,
                                                           const robot::RobotPlacement& robot,
                                                           const WorldOptions& options,
                                                           std::uint64_t seed);
  ~World();
  World(const World&) = delete;
  World& operator=(const World&) = delete;

  /// @{
  /// The devices, as a session is given them.
  [[nodiscard]] scanner::Camera& camera();
  [[nodiscard]] scanner::Turntable& turntable();
  [[nodiscard]] robot::Robot& robot();
  /// @}

  /// @{
  /// What a careful user has measured before the session: the scanner's calibration, and where the
  /// couch is from the robot (2 mm and 0.3 degrees off).
  [[nodiscard]] scanner::ScannerCalibration believed_calibration() const;
  [[nodiscard]] Transform believed_base_from_couch() const;
  /// @}

  /// @{
  /// The truth.
  [[nodiscard]] const Person& person() const;
  [[nodiscard]] const robot::RobotMount& mount() const;
  /// @}
  [[nodiscard]] const robot::ArmTable& robot_table() const;  ///< as believed
  /// How far the person has moved from where the session began, as of now.
  [[nodiscard]] Vector3 shift_in_couch() const;
  /// The robot's true state and contacts; only after it stands ready.
  [[nodiscard]] const PlantTruth& truth() const;
  /// The truth of a robot that is simulated in another process: told here, read from `truth`.
  void tell_truth(const PlantTruth& truth);
  /// The robot itself, for hands that lead it; only after it stands ready.
  [[nodiscard]] Plant& plant();
  /// @{
  /// The person's back under the tools.
  [[nodiscard]] BackContact& contact();
  [[nodiscard]] const BackContact& contact() const;
  /// @}

 private:
  struct Parts;
  explicit World(std::unique_ptr<Parts> parts);
  std::unique_ptr<Parts> parts_;
};

/// Skin, acupoints and landmarks of a person, moved.
[[nodiscard]] Person moved(Person person, const Vector3& by_in_couch);

}  // namespace tuina::sim
