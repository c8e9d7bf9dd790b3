// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "apps/evaluation/contact/networked_arms.hpp"
#include "apps/evaluation/contact/patch_path.hpp"
#include "tuina/control/arm_controller.hpp"
#include "tuina/core/progress.hpp"
#include "tuina/core/result.hpp"
#include "tuina/massage/technique/press.hpp"
#include "tuina/safety/guard.hpp"
#include "tuina/session/config.hpp"
#include "tuina/session/force_errors.hpp"
#include "tuina/sim/robot/back_contact.hpp"
#include "tuina/sim/robot/plant.hpp"
#include "tuina/sim/robot/position_plant.hpp"
#include "tuina/tissue/press_record.hpp"

namespace tuina::app {

/// One arm of a simulated robot behind a sitting person, from a standoff over a patch of skin
/// through one technique and away again. What the controller believes is wrong in the ways a
/// session's beliefs are.
struct ContactExperiment {
  std::string robot = "thesis";           ///< a shipped robot or the file of its table
  TangentTissue tissue = {9.786, 185.4};  ///< true; hard muscle of [thesis] chapter 6
  double force_n = 30.0;
  Technique technique = Technique::press;
  massage::PressWindow window = {};  ///< timing of one press
  control::ArmController::Options controller = {};
  double surface_error_m = 0.0;   ///< the true skin lies this much deeper than believed
  double surface_tilt_rad = 0.0;  ///< the believed normal leans this much, along the path
  double torso_n_per_m = 35'000.0;
  double bend_radius_m = 0.3;  ///< bend of the back
  double believed_bend_radius_m = std::numeric_limits<double>::infinity();
  bool stroke_across = false;  ///< over the bend instead of along it
  RubShape rub_shape = RubShape::circle;
  double tap_hz = 3.0;
  double friction_scale = 1.0;  ///< scale of the joint friction
  sim::Breathing breathing = {0.0, 0.25};
  double skin_friction = 0.1;   ///< Coulomb coefficient
  sim::LivingBack living = {};  ///< what the back does beyond the tangent law
  double duration_s = 10.0;     ///< duration of the technique
  double tissue_error = 0.3;    ///< alpha and beta believed wrong by this share, signs by the seed
  double mass_error = 0.1;      ///< every link heavier or lighter by up to this share
  double mass_scale = 1.0;      ///< all links heavier than believed, on top
  double friction_error = 0.2;
  double tool_weight_error = 0.0;       ///< share
  bool steer = true;                    ///< a converged estimate replaces the believed tissue
  std::vector<sim::Shift> shifts = {};  ///< times count from the start of the technique
  sim::PlantOptions devices = {};       ///< sensors and drives; their seed is the one below
  int late_ticks = 0;                   ///< torques reach the drives so many milliseconds late
  std::optional<Network> network = {};  ///< the arms are at the other end of armlink
  /// The arms take places and no torques; their lag is known to a fifth.
  std::optional<sim::PositionLoop> position = {};
  bool late_gains = true;  ///< gains that suit that lag, not those of an arm that takes torques
  /// Wraps the robot, for instance to give it faults: it is called with the simulated one behind
  /// its network or delay, and what it returns is driven by the controller, with `position` through
  /// arms that take places.
  std::function<robot::Robot&(robot::Robot&)> seen_as = {};
  std::uint64_t seed = 1;
};

struct ContactSample {
  double time_s, target_n, true_force_n, measured_force_n, depth_m, tool_speed_m_per_s;
};

struct ContactStop {
  double time_s;
  std::string cause;
};

struct ContactOutcome {
  std::vector<ContactSample> trace;      ///< 1 kHz, the whole run
  std::vector<tissue::TimedPress> felt;  ///< samples that the estimator was given
  session::ForceErrors force;
  TissueEstimate estimate;
  TangentTissue tissue;            ///< first loading of the true tissue where the force was highest
  double highest_n = 0.0;          ///< true force anywhere in the run
  double max_speed_m_per_s = 0.0;  ///< largest tool speed during the technique
  double ripple_n = 0.0;         ///< RMS of the true force above 2 Hz while the target stands still
  double second_impact_n = 0.0;  ///< true force after contact was lost for the first time
  std::vector<ContactStop> stops;
  bool stopped = false;
};

/// Puts an experiment into the simulated world of a config. Unless that world is ideal, a torso of
/// finite stiffness gets the stiffness of the config, and a person without breath its breathing;
/// a person with breath keeps depth and rate.
void live_in(const session::Config& config, ContactExperiment& experiment);

[[nodiscard]] Result<ContactOutcome> run_contact(const ContactExperiment& experiment,
                                                 const Progress& progress = {});

}  // namespace tuina::app
