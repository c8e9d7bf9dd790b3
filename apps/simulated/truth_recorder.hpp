// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <map>
#include <vector>

#include "apps/simulated/simulated_session.hpp"
#include "tuina/robot/arm_model.hpp"
#include "tuina/session/massage_step.hpp"
#include "tuina/sim/robot/plant.hpp"

namespace tuina::app {

/// Watches the massage from outside: what the session does, beside what only the simulation knows.
class Witness {
 public:
  Witness(const PerArm<robot::ArmModel>& models, const std::vector<robot::Obstacle>& obstacles,
          const Transform& couch_from_base, massage::ZoneMap true_zones,
          std::vector<Vector3> skin_in_base)
      : models_(models),
        obstacles_(obstacles),
        couch_from_base_(couch_from_base),
        true_zones_(std::move(true_zones)),
        skin_in_base_(std::move(skin_in_base)) {}

  /// From now on the arms carry out this plan.
  void follow(const massage::Plan& plan) {
    plan_ = &plan;
    last_path_ = {.of = {-1, -1}};
  }

  /// `moved_in_base`: how far the person has gone from where the session began.
  void watch(double time_s, const PerArm<session::ArmView>& view, const sim::PlantTruth& truth,
             const Vector3& moved_in_base);
  /// In the present contact of an arm, or its last one.
  [[nodiscard]] const Touched& touched(Arm arm) const { return touched_[arm]; }

  void tell(SessionResult& result);

 private:
  void count(double time_s, Arm arm, const session::ArmView& seen, const sim::ContactTruth& contact,
             Technique technique);
  /// From the nearer arm to the skin; the last link is left out, because its tool is to touch.
  [[nodiscard]] double to_person_m(const PerArm<robot::ArmModel::Kinematics>& poses,
                                   const Vector3& moved_in_base) const;
  void feel(Touched& touched, const sim::ContactTruth& contact, bool row) const;

  const massage::Plan* plan_ = nullptr;
  const PerArm<robot::ArmModel>& models_;
  const std::vector<robot::Obstacle>& obstacles_;
  robot::Clearances clear_;
  Transform couch_from_base_;
  massage::ZoneMap true_zones_;
  std::vector<Vector3> skin_in_base_;
  double min_arm_distance_m_ = std::numeric_limits<double>::infinity();
  std::vector<telemetry::ArmDistance> distances_;
  std::vector<telemetry::TraceRow> trace_;
  session::ForceErrorSum all_;
  std::map<Technique, session::ForceErrorSum> by_technique_;
  long ticks_ = 0;
  PerArm<int> last_path_{.of = {-1, -1}};
  PerArm<bool> touching_ = {};
  PerArm<Touched> touched_;
};

/// Some places of the skin, close enough together to tell how near an arm comes to within a
/// millimetre or two.
[[nodiscard]] std::vector<Vector3> some_skin(const Mesh& skin_in_couch,
                                             const Transform& base_from_couch);

}  // namespace tuina::app
