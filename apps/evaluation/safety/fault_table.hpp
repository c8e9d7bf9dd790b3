// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "tuina/sim/person/breath.hpp"
#include "tuina/sim/robot/faulty_robot.hpp"

namespace tuina::app {

/// What an arm is doing when something goes wrong.
enum class Stage : std::uint8_t { idle, travel, approach, contact, retract };
[[nodiscard]] constexpr const char* name_of(Stage stage) {
  constexpr std::array names = {"idle", "travel", "approach", "contact", "retract"};
  return names[static_cast<std::size_t>(stage)];
}

/// How a controller may fail: what it proposes to the guard.
enum class Madness : std::uint8_t {
  none,
  nan_torque,
  huge_torque,   ///< every drive at its end, inward
  inward_push,   ///< `size` N more into the body, declared by nothing
  oscillation,   ///< `size` N to and fro along the normal, `hz` times a second
  stale_repeat,  ///< the last proposal for ever
  killed,        ///< no proposal
  bad_tissue,    ///< the estimate that it is fed is no number
  joint_push,    ///< `size` Nm more in one joint, towards its end
};

/// Where a controller sends an arm that has no business there.
enum class Stray : std::uint8_t { none, other_arm, own_body, couch };

/// A person who moves along the normal of the skin, outward positive.
struct PersonMove {
  double outward_m = 0.0, m_per_s = 0.0, m_per_s2 = 0.0;
  double back_after_s = 0.0;  ///< and back again; 0: stays there
};

/// What goes wrong, from its onset on; times inside count from there.
struct Injection {
  std::optional<sim::TimedFault> robot = {};
  Madness madness = Madness::none;
  double size = 0.0, hz = 0.0;  ///< of the madness
  std::optional<PersonMove> person = {};
  sim::Breathing breathing = {};  ///< beside the usual; from the beginning on
  double hand_inward_n = 0.0, hand_aside_n = 0.0;
  bool power_lost = false;
  bool emergency_stop = false;  ///< the drives of both arms stop by themselves
  bool stop_ignored = false;    ///< somebody asks for a stop, and the controller goes on
  Stray stray = Stray::none;    ///< of the arm that works; `other_arm`: the other one comes to it
  double tool_kg = 0.0;         ///< heavier than the table says; from the beginning on
  double harder = 1.0;  ///< the tissue from 5 mm beside the place on, against that of the place
  bool bone_beside = false;
};

/// What a guarded arm owes when a fault comes.
enum class Duty : std::uint8_t {
  stop,    ///< it must act, and end where it presses nobody
  ride,    ///< it must go on
  either,  ///< it may do both
};

/// The promise of one class. Forces are TRUE contact forces, times count from the onset; the first
/// action on a person who comes to a tool in the air, or to one that leaves, from when they meet.
struct Promise {
  Duty duty = Duty::stop;
  std::optional<double> over_set_n = {};  ///< above the force that is set
  std::optional<double> highest_n = {};
  std::optional<double> act_ms = {};
  std::vector<std::string> causes = {};    ///< one of these is named; empty: any, but one
  std::optional<double> rmse_n = {};       ///< error of the force while it goes on
  std::optional<double> further_mm = {};   ///< way of the tool into the body
  std::optional<double> released_ms = {};  ///< contact is over
  std::optional<double> apart_mm = {};     ///< distance that arms, couch and robot's body keep
};

struct FaultClass {
  int number = 0;  ///< in the list of faults of docs/safety_campaign.md
  std::string name;
  Injection injection;
  Promise promise;
  std::vector<Stage> stages = {Stage::idle, Stage::travel, Stage::approach, Stage::contact,
                               Stage::retract};
  bool strokes = false;  ///< in contact the tool slides along the skin
  bool whole = false;    ///< the arm goes on to press, if nobody stops it
  double watched_s = 2.0;
};

/// In any class, and where nothing else is promised: no true force above this, ...
inline constexpr double never_n = 90.0;
/// ... and none above this for more than so long.
inline constexpr double seldom_n = 60.0, seldom_s = 0.1;
/// Two faults at once may reach as much as one.
inline constexpr double double_fault_n = 90.0;

/// The one table of all classes that a simulated arm can have. The numbers were written down before
/// any of it was run.
[[nodiscard]] const std::vector<FaultClass>& fault_classes();
[[nodiscard]] const FaultClass& fault_class(const std::string& name);

}  // namespace tuina::app
