// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "tuina/control/tool_motion.hpp"
#include "tuina/core/arm.hpp"
#include "tuina/core/contact.hpp"

namespace tuina::app {

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

}  // namespace tuina::app
