// SPDX-License-Identifier: Apache-2.0
#include "apps/simulated/truth_recorder.hpp"

#include <algorithm>
#include <cmath>

#include "tuina/robot/clearance.hpp"

namespace tuina::app {

void Witness::watch(double time_s, const PerArm<session::ArmView>& view,
                    const sim::PlantTruth& truth, const Vector3& moved_in_base) {
  constexpr int rows_every_ticks = 5;
  const bool row = ticks_++ % rows_every_ticks == 0;
  if (row) {
    const auto pose = [&](Arm arm) {
      return models_[arm].kinematics(truth.arms[arm].q_rad, truth.rail_m);
    };
    const PerArm<robot::ArmModel::Kinematics> poses = {.of = {pose(Arm::left), pose(Arm::right)}};
    const double apart_m = robot::distance_between_m(models_[Arm::left], poses[Arm::left],
                                                     models_[Arm::right], poses[Arm::right]);
    min_arm_distance_m_ = std::min(min_arm_distance_m_, apart_m);
    robot::Clearances clear;
    for (const Arm arm : both_arms) {
      clear.take_least(robot::clearances(models_[arm], poses[arm], truth.rail_m, obstacles_));
    }
    clear_.take_least(clear);
    constexpr double distances_every_s = 0.1;
    if (distances_.empty() || time_s - distances_.back().time_s >= distances_every_s - 1e-6)
      distances_.push_back({.time_s = time_s,
                            .apart_m = apart_m,
                            .to_person_m = to_person_m(poses, moved_in_base),
                            .to_couch_m = clear[robot::Surrounding::couch],
                            .to_body_m = clear[robot::Surrounding::body]});
  }
  for (const Arm arm : both_arms) {
    const session::ArmView& seen = view[arm];
    const sim::ContactTruth& contact = truth.arms[arm].contact;
    const bool in_contact = seen.phase == session::ArmPhase::contact;
    std::optional<Technique> technique;
    if (in_contact) technique = plan_->paths[static_cast<std::size_t>(seen.path)].path.technique;
    if (in_contact && seen.target_n > 0.0) count(time_s, arm, seen, contact, *technique);
    if (in_contact) {
      if (!touching_[arm]) touched_[arm] = {};
      feel(touched_[arm], contact, row);
    }
    touching_[arm] = in_contact;
    if (row) {
      trace_.push_back({.time_s = time_s,
                        .arm = arm,
                        .technique = technique,
                        .target_n = seen.target_n,
                        .true_force_n = contact.force_n,
                        .measured_force_n = seen.measured_n,
                        .depth_m = contact.depth_m,
                        .tool_in_couch = couch_from_base_ * seen.tool_in_base});
    }
  }
}

void Witness::tell(SessionResult& result) {
  result.min_arm_distance_m = min_arm_distance_m_;
  result.clear = clear_;
  result.distances = std::move(distances_);
  result.force = all_.errors();
  for (const auto& [technique, sum] : by_technique_) result.techniques[technique] = sum.errors();
  result.trace = std::move(trace_);
}

void Witness::count(double time_s, Arm arm, const session::ArmView& seen,
                    const sim::ContactTruth& contact, Technique technique) {
  session::ForceErrorSum& sum = by_technique_[technique];
  if (seen.path != last_path_[arm]) sum.begin(), all_.begin();
  last_path_[arm] = seen.path;
  sum.add(time_s, seen.target_n, contact.force_n);
  all_.add(time_s, seen.target_n, contact.force_n);
}

double Witness::to_person_m(const PerArm<robot::ArmModel::Kinematics>& poses,
                            const Vector3& moved_in_base) const {
  double min_m = std::numeric_limits<double>::infinity();
  for (const Arm arm : both_arms) {
    const auto& origins = poses[arm].origins_in_base;
    for (int i = 0; i + 1 < models_[arm].joints(); ++i) {
      const auto link = static_cast<std::size_t>(i);
      const Vector3 from = origins[link] - moved_in_base;
      const Vector3 along = origins[link + 1] - origins[link];
      const double length2 = std::max(along.squaredNorm(), 1e-12);
      double nearest2 = std::numeric_limits<double>::infinity();
      for (const Vector3& skin : skin_in_base_) {
        const Vector3 to = skin - from;
        const double share = std::clamp(to.dot(along) / length2, 0.0, 1.0);
        nearest2 = std::min(nearest2, (to - share * along).squaredNorm());
      }
      min_m = std::min(min_m, std::sqrt(nearest2) - models_[arm].table().links[link].radius_m);
    }
  }
  return min_m;
}

void Witness::feel(Touched& touched, const sim::ContactTruth& contact, bool row) const {
  if (contact.force_n > touched.peak_n) {
    touched.peak_n = contact.force_n;
    touched.tissue = contact.tissue;
    touched.at_in_couch = contact.at_in_couch;
  }
  if (!row || contact.force_n <= 0.0) return;
  const massage::Zone zone = true_zones_.at(contact.at_in_couch);
  if (contact.force_n == touched.peak_n) touched.zone = zone;
  const massage::ZoneRule& rule = massage::rule_of(zone);
  if (contact.force_n - rule.cap_n > touched.over_cap_n) {
    touched.over_cap_n = contact.force_n - rule.cap_n;
    touched.over_cap_zone = zone;
  }
  touched.over_trip_n = std::max(touched.over_trip_n, contact.force_n - rule.trip_n);
}

std::vector<Vector3> some_skin(const Mesh& skin_in_couch, const Transform& base_from_couch) {
  constexpr std::size_t enough = 2000;
  const std::size_t count = skin_in_couch.vertices.size();
  const std::size_t stride = std::max<std::size_t>(1, count / enough);
  std::vector<Vector3> places;
  for (std::size_t i = 0; i < count; i += stride)
    places.push_back(base_from_couch * skin_in_couch.vertices[i]);
  return places;
}

}  // namespace tuina::app
