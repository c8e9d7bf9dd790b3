// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "tuina/control/tool_motion.hpp"
#include "tuina/core/arm.hpp"
#include "tuina/core/contact.hpp"
#include "tuina/motion/ready_plan.hpp"
#include "tuina/robot/robot_model.hpp"
#include "tuina/sim/world.hpp"

namespace tuina::app {

/// What a simulated masseur shows to an arm.
struct TeachOrder {
  std::string person = "phantom:medium";
  std::string robot = "thesis";  ///< a shipped robot or the file of its table
  BodyPosture position = BodyPosture::sitting;
  Technique technique = Technique::stroke;  ///< shown as the first of `relax` on that side
  Arm arm = Arm::left;
  std::string device = {};  ///< a device file; empty: the arm is simulated in this program
};

/// Where a hand has the tool at a time, and how hard it presses; smooth from leg to leg.
class HandMotion {
 public:
  struct Now {
    control::ToolPose tip;
    Vector3 velocity = Vector3::Zero();
    double press_n = 0.0;  ///< 0 in the air
  };

  explicit HandMotion(const control::ToolPose& from) : last_(from) {}

  /// Through the air in a straight line, at rest at both ends.
  void go(const control::ToolPose& to, double speed_m_per_s);
  /// Along a path on the skin, which must outlive this.
  void press(const ContactPath& path, const Transform& base_from_couch);

  [[nodiscard]] double duration_s() const { return end_s_; }
  [[nodiscard]] Now at(double time_s) const;

 private:
  struct Leg {
    double begin_s, end_s;
    control::ToolPose from = {}, to = {};
    const ContactPath* path = nullptr;
  };
  [[nodiscard]] control::ToolPose pose(const ContactPoint& point) const;
  [[nodiscard]] Now along(const ContactPath& path, double path_s) const;

  std::vector<Leg> legs_;
  Transform base_from_couch_ = Transform::Identity();
  control::ToolPose last_;
  double end_s_ = 0.0;
};

/// The push of a hand that wants the tool somewhere: a spring and a damper across, and on the skin
/// the force it feels there brought to the one it wants, within a second.
class Hand {
 public:
  /// Once per millisecond; everything in `base`.
  [[nodiscard]] Wrench push(const HandMotion::Now& wanted, const Transform& base_from_tool,
                            const Vector3& velocity, double felt_n, double radius_m);

 private:
  double leaning_n_ = 0.0;
  Vector3 last_axis_ = Vector3::Zero();
};

/// The hand that shows what is ordered, to an arm that lets itself be led from `learning_s` on.
class TeachingHand {
 public:
  static constexpr double learning_s = 3.5;  ///< the arm learns its friction before it is led

  [[nodiscard]] static Result<TeachingHand> make(const TeachOrder& order, const sim::Person& person,
                                                 const robot::RobotPlacement& placement);

  /// Where the arms stand before, and what the hand follows.
  [[nodiscard]] const motion::ReadyPlan& plan() const { return *plan_; }
  /// When all is shown, from the robot's first millisecond on.
  [[nodiscard]] double end_s() const { return learning_s + wanted_.duration_s() + 0.5; }
  /// Pushes the arm of a world in this millisecond, not before `learning_s`; what it pushes with.
  Wrench lead(sim::World& world, double time_s);

 private:
  TeachingHand(Arm arm, std::unique_ptr<const motion::ReadyPlan> plan, HandMotion wanted)
      : arm_(arm), plan_(std::move(plan)), wanted_(std::move(wanted)) {}

  Arm arm_;
  std::unique_ptr<const motion::ReadyPlan> plan_;  // `wanted_` looks at it
  HandMotion wanted_;
  Hand hand_;
};

}  // namespace tuina::app
