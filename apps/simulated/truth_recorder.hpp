// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <optional>
#include <vector>

#include "apps/simulated/arm_distances.hpp"
#include "apps/simulated/simulated_session.hpp"
#include "tuina/session/observer.hpp"
#include "tuina/sim/world.hpp"

namespace tuina::app {

/// Writes down, beside what a session does, what only the simulation knows.
class TruthRecorder final : public session::Observer {
 public:
  /// `world` must outlive it.
  explicit TruthRecorder(const sim::World& world) : world_(world) {}

  void on_scan(const scanner::Scan& scan) override;
  void on_map(const body::Mapping& map) override;
  void on_plan(const motion::ReadyPlan& plan, const Transform& base_from_couch) override;
  void on_performed(const session::Performed& performed) noexcept override;
  void on_tick(const session::Tick& tick) noexcept override;

  /// All of it; once.
  [[nodiscard]] SessionTruth finish();

 private:
  void count(double time_s, Arm arm, const session::ArmView& seen, const sim::ContactTruth& contact,
             Technique technique);
  /// From the nearer arm to the skin; the last link is left out, because its tool is to touch.
  [[nodiscard]] double to_person_m(const PerArm<robot::ArmModel::Kinematics>& poses,
                                   const Vector3& moved_in_base) const;
  /// What a path that was not performed to its end has touched.
  void give_up(Arm arm);
  void feel(Touched& touched, const sim::ContactTruth& contact) const;

  void measure_distances(double time_s, const sim::PlantTruth& truth);
  const sim::World& world_;
  SessionTruth truth_;
  const massage::Plan* plan_ = nullptr;
  Transform couch_from_base_ =
      Transform::Identity();  ///< inverse of the pose that the session believes
  std::optional<ArmDistances> distances_;
  std::optional<massage::ZoneMap> true_zones_;
  std::vector<Vector3> skin_in_base_;
  session::ForceErrorSum all_;
  std::map<Technique, session::ForceErrorSum> by_technique_;
  long ticks_ = 0;
  PerArm<int> last_path_{.of = {-1, -1}};
  GivenPresses presses_;
  PerArm<bool> touching_ = {};
  PerArm<Touched> touched_;
};

}  // namespace tuina::app
