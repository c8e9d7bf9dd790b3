// SPDX-License-Identifier: Apache-2.0
#include "tuina/motion/configuration_choice.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "tuina/motion/rollout.hpp"
#include "tuina/motion/startle.hpp"
#include "tuina/robot/elbow_turn.hpp"

namespace tuina::motion {
namespace {

const robot::PostureOptions outward{.elbow_outward_m = 250_mm, .press_depth_m = press_depth_m};

struct Candidate {
  JointVector q_rad;
  double cost_m = 0.0;
};

/// Static cost of a configuration (m).
double static_cost_m(const robot::ArmModel& model, Arm arm, double rail_m, const JointVector& q_rad,
                     const robot::ArmModel::Kinematics& pose, const JointVector& arrival_rad) {
  constexpr double roomy_rad = 10_deg, tight_m_per_rad = 0.5, unlike_m_per_rad = 5e-3;
  const double tight_rad = roomy_rad - robot::limit_room_rad(model.table(), q_rad);
  const double unlike_rad = (q_rad - arrival_rad).cwiseAbs().maxCoeff();
  const double mass_kg = max_apparent_mass_kg(model, rail_m, {.q_rad = {q_rad}, .poses = {pose}});
  return std::max(inward_m(model, arm, pose), -own_side_m) + dexterity_cost_m(pose) +
         mass_cost_m(mass_kg) + tight_m_per_rad * std::max(0.0, tight_rad) +
         unlike_m_per_rad * unlike_rad;
}

}  // namespace

double dexterity_cost_m(const robot::ArmModel::Kinematics& pose) noexcept {
  constexpr double nimble_m_per_rad = 0.09, counts_rad = 3.0;
  return counts_rad * std::max(0.0, nimble_m_per_rad - robot::dexterity(pose));
}

ConfigurationChoice choose_configurations(const robot::ArmModel& model, Arm arm, double rail_m,
                                          std::span<const robot::ContactGoal> goals,
                                          const JointVector& ready_rad,
                                          const JointVector& arrival_rad) {
  constexpr double alike_rad = 0.2;
  const auto elbow = model.elbow();
  ConfigurationChoice choice{.min_cost_m = -own_side_m};
  std::vector<Candidate> all;
  const std::array places = {goals.front(), goals[goals.size() / 2], goals.back()};
  for (const robot::ContactGoal& place : places) {
    double best_m = std::numeric_limits<double>::infinity();
    for (const JointVector* start : {&ready_rad, &arrival_rad}) {
      const auto there = robot::find_posture(model, rail_m, place, *start, outward);
      if (there.reach != robot::Reach::reached) continue;
      for (const JointVector& q_rad : robot::turn_elbow(model, rail_m, there.q_rad)) {
        const auto pose = model.kinematics(q_rad, rail_m);
        const Vector3 over_skin = pose.origins_in_base[elbow] - place.at_in_base;
        if (over_skin.dot(place.normal_in_base) < outward.elbow_clearance_m) continue;
        all.push_back({q_rad, static_cost_m(model, arm, rail_m, q_rad, pose, arrival_rad)});
        best_m = std::min(best_m, all.back().cost_m);
      }
    }
    if (std::isfinite(best_m)) choice.min_cost_m = std::max(choice.min_cost_m, best_m);
  }
  std::stable_sort(all.begin(), all.end(),
                   [](const Candidate& a, const Candidate& b) { return a.cost_m < b.cost_m; });
  for (const Candidate& one : all) {
    const auto alike = [&](const JointVector& other_rad) {
      return (other_rad - one.q_rad).cwiseAbs().maxCoeff() < alike_rad;
    };
    if (std::none_of(choice.configurations_rad.begin(), choice.configurations_rad.end(), alike))
      choice.configurations_rad.push_back(one.q_rad);
  }
  return choice;
}

}  // namespace tuina::motion
