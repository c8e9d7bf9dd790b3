// SPDX-License-Identifier: Apache-2.0
#include "apps/simulated/truth_recorder.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace tuina::app {

namespace {

/// Skin vertices thinned to about 2000, for distances between arm and person good to 2 mm.
std::vector<Vector3> thinned_skin(const Mesh& skin_in_couch, const Transform& base_from_couch) {
  constexpr std::size_t enough = 2000;
  const std::size_t count = skin_in_couch.vertices.size();
  const std::size_t stride = std::max<std::size_t>(1, count / enough);
  std::vector<Vector3> places;
  for (std::size_t i = 0; i < count; i += stride)
    places.push_back(base_from_couch * skin_in_couch.vertices[i]);
  return places;
}

}  // namespace

void TruthRecorder::on_scan(const scanner::Scan& scan) {
  const Mesh& skin = world_.person().skin_in_couch;
  const Vector3 shift = world_.shift_in_couch();
  truth_.scan_error_m =
      shift.isZero() ? sim::compare_with_truth(scan.cloud_in_couch, skin).rms_error_m
                     : sim::compare_with_truth(scan.cloud_in_couch,
                                               sim::moved(world_.person(), shift).skin_in_couch)
                           .rms_error_m;
}

void TruthRecorder::on_map(const body::Mapping& map) {
  const sim::Person person = sim::moved(world_.person(), world_.shift_in_couch());
  truth_.acupoint_errors_m.clear();
  for (const Acupoint& acupoint : map.acupoints) {
    double error_m = std::numeric_limits<double>::quiet_NaN();
    for (const Acupoint& truth : person.acupoints) {
      if (truth.name == acupoint.name) error_m = (truth.at_in_couch - acupoint.at_in_couch).norm();
    }
    truth_.acupoint_errors_m.push_back(error_m);
  }
}

void TruthRecorder::on_plan(const motion::ReadyPlan& plan, const Transform& base_from_couch) {
  plan_ = &plan.plan;
  last_path_ = {.of = {-1, -1}};
  if (distances_) return;
  const sim::Person& person = world_.person();
  couch_from_base_ = base_from_couch.inverse();
  distances_.emplace(world_.robot_table(), world_.mount());
  const auto chart = massage::BackChart::from(person.acupoints, person.landmarks);
  if (chart) true_zones_ = massage::ZoneMap(*chart, person.acupoints, person.landmarks);
  skin_in_base_ = thinned_skin(person.skin_in_couch, world_.mount().base_from_couch);
}

void TruthRecorder::on_performed(const session::Performed& performed) noexcept {
  // A path whose tool never met the skin has nothing of the one before.
  truth_.touched.push_back(std::exchange(touched_[performed.arm], {}));
}

void TruthRecorder::on_tick(const session::Tick& tick) noexcept {
  constexpr int rows_every_ticks = 5;
  const sim::PlantTruth& truth = world_.truth();
  const double time_s = tick.reading.time_s;
  const bool row = ticks_++ % rows_every_ticks == 0;
  if (row) measure_distances(time_s, truth);
  for (const Arm arm : both_arms) {
    const session::ArmView& seen = tick.view[arm];
    const sim::ContactTruth& contact = truth.arms[arm].contact;
    const bool in_contact = seen.phase == session::ArmPhase::contact;
    std::optional<Technique> technique;
    if (in_contact) technique = plan_->paths[static_cast<std::size_t>(seen.path)].path.technique;
    if (in_contact && seen.target_n > 0.0) count(time_s, arm, seen, contact, *technique);
    if (in_contact && !touching_[arm]) give_up(arm);
    if (in_contact) touched_[arm].held.add(seen.target_n, contact.force_n);
    if (contact.force_n > 0.0) feel(in_contact ? touched_[arm] : truth_.unplanned, contact);
    touching_[arm] = in_contact;
    presses_.add(time_s, arm, seen, contact, *plan_);
    if (row) {
      truth_.trace.push_back({.time_s = time_s,
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

SessionTruth TruthRecorder::finish() {
  for (const Arm arm : both_arms) give_up(arm);
  for (Touched& touched : truth_.touched) {
    if (touched.peak_n > 0.0)
      touched.tissue =
          world_.contact().first_loading(touched.tissue, touched.at_in_couch, touched.peak_n);
  }
  if (distances_) {
    truth_.min_arm_distance_m = distances_->min_apart_m();
    truth_.clear = distances_->clear();
    truth_.distances = distances_->take();
  }
  truth_.force = all_.errors();
  truth_.presses = presses_.take();
  for (const auto& [technique, sum] : by_technique_) truth_.techniques[technique] = sum.errors();
  return std::move(truth_);
}

void TruthRecorder::measure_distances(double time_s, const sim::PlantTruth& truth) {
  const ArmDistances::Poses poses = distances_->poses(
      {.of = {truth.arms[Arm::left].q_rad, truth.arms[Arm::right].q_rad}}, truth.rail_m);
  telemetry::ArmDistance* row = distances_->add(time_s, poses, truth.rail_m);
  if (row == nullptr) return;
  const Vector3 moved_in_base = world_.mount().base_from_couch.linear() * world_.shift_in_couch();
  row->to_person_m = to_person_m(poses, moved_in_base);
}

void TruthRecorder::count(double time_s, Arm arm, const session::ArmView& seen,
                          const sim::ContactTruth& contact, Technique technique) {
  session::ForceErrorSum& sum = by_technique_[technique];
  if (seen.path != last_path_[arm]) sum.begin(), all_.begin();
  last_path_[arm] = seen.path;
  sum.add(time_s, seen.target_n, contact.force_n);
  all_.add(time_s, seen.target_n, contact.force_n);
}

double TruthRecorder::to_person_m(const PerArm<robot::ArmModel::Kinematics>& poses,
                                  const Vector3& moved_in_base) const {
  double min_m = std::numeric_limits<double>::infinity();
  for (const Arm arm : both_arms) {
    const auto& origins = poses[arm].origins_in_base;
    for (int i = 0; i + 1 < distances_->models()[arm].joints(); ++i) {
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
      min_m = std::min(
          min_m, std::sqrt(nearest2) - distances_->models()[arm].table().links[link].radius_m);
    }
  }
  return min_m;
}

void TruthRecorder::give_up(Arm arm) {
  const Touched left = std::exchange(touched_[arm], {});
  Touched& all = truth_.unplanned;
  all.over_trip_n = std::max(all.over_trip_n, left.over_trip_n);
  if (left.over_cap_n > all.over_cap_n) {
    all.over_cap_n = left.over_cap_n;
    all.over_cap_zone = left.over_cap_zone;
  }
  if (left.peak_n <= all.peak_n) return;
  all.peak_n = left.peak_n;
  all.tissue = left.tissue;
  all.at_in_couch = left.at_in_couch;
  all.zone = left.zone;
}

void TruthRecorder::feel(Touched& touched, const sim::ContactTruth& contact) const {
  const massage::Zone zone =
      true_zones_ ? true_zones_->at(contact.at_in_couch) : massage::Zone::muscle;
  if (contact.force_n > touched.peak_n) {
    touched.peak_n = contact.force_n;
    touched.tissue = contact.tissue;
    touched.at_in_couch = contact.at_in_couch;
    touched.zone = zone;
  }
  if (!true_zones_) return;
  const massage::ZoneRule& rule = massage::rule_of(zone);
  if (contact.force_n - rule.cap_n > touched.over_cap_n) {
    touched.over_cap_n = contact.force_n - rule.cap_n;
    touched.over_cap_zone = zone;
  }
  touched.over_trip_n = std::max(touched.over_trip_n, contact.force_n - rule.trip_n);
}

}  // namespace tuina::app
