// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <map>
#include <optional>

#include "apps/simulated/arm_distances.hpp"
#include "apps/simulated/simulated_session.hpp"
#include "tuina/session/observer.hpp"

namespace tuina::app {

/// Writes down what a session with devices felt: forces by the wrist sensors, distances by the
/// encoders. What only a simulation knows stays unknown: errors of scan and acupoints are not a
/// number, and no place has a true tissue.
class FeltRecorder final : public session::Observer {
 public:
  FeltRecorder(const robot::ArmTable& table, const robot::RobotMount& mount)
      : distances_(table, mount) {
    felt_.scan_error_m = unknown;
  }

  void on_map(const body::Mapping& map) override {
    felt_.acupoint_errors_m.assign(map.acupoints.size(), unknown);
  }
  void on_plan(const motion::ReadyPlan& plan, const Transform& base_from_couch) override;
  void on_performed(const session::Performed& performed) noexcept override {
    felt_.touched.push_back(touched_[performed.arm]);
  }
  void on_tick(const session::Tick& tick) noexcept override;

  /// All of it; once.
  [[nodiscard]] SessionTruth finish();

 private:
  static constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
  void count(double time_s, Arm arm, const session::ArmView& seen, Technique technique);

  ArmDistances distances_;
  SessionTruth felt_;
  const massage::Plan* plan_ = nullptr;
  Transform couch_from_base_ = Transform::Identity();
  session::ForceErrorSum all_;
  std::map<Technique, session::ForceErrorSum> by_technique_;
  long ticks_ = 0;
  PerArm<int> last_path_{.of = {-1, -1}};
  PerArm<bool> touching_ = {};
  PerArm<Touched> touched_;
};

}  // namespace tuina::app
