// SPDX-License-Identifier: Apache-2.0
#include "apps/serve/shown_arm.hpp"

#include <cmath>
#include <nlohmann/json.hpp>

namespace tuina::app {

double rounded(double value, double per_unit) {
  return std::round(value * per_unit) / per_unit;
}

nlohmann::json shown_links(const robot::ArmModel& model, const JointVector& q_rad, double rail_m,
                           const Transform& couch_from_base) {
  constexpr double per_m = 1e3;
  const auto pose = model.kinematics(q_rad, rail_m);
  nlohmann::json links = nlohmann::json::array();
  for (int i = 0; i <= model.joints(); ++i) {
    const auto joint = static_cast<std::size_t>(i);
    const Vector3 at = couch_from_base * pose.origins_in_base[joint];
    const double radius_m =
        i < model.joints() ? model.table().links[joint].radius_m : model.table().tool_radius_m;
    links.push_back({rounded(at.x(), per_m), rounded(at.y(), per_m), rounded(at.z(), per_m),
                     rounded(radius_m, per_m)});
  }
  return links;
}

}  // namespace tuina::app
