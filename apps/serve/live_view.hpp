// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "tuina/robot/arm_model.hpp"
#include "tuina/robot/robot_model.hpp"
#include "tuina/session/observer.hpp"

namespace tuina::app {

/// What pages are shown of one session, kept as the texts and bytes that they ask for.
class LiveView final : public session::Observer {
 public:
  explicit LiveView(robot::RobotModel robot) : robot_(std::move(robot)) {}
  void on_progress(session::Stage stage, double share) noexcept override;
  void on_profile(const scanner::LiveProfile& profile) override;
  void on_scan(const scanner::Scan& scan) override;
  void on_map(const body::Mapping& map) override;
  void on_plan(const motion::ReadyPlan& plan, const Transform& base_from_couch) override;
  void on_tick(const session::Tick& tick) noexcept override;
  void show_plan(const motion::ReadyPlan& plan);

  struct Progress {
    session::Stage stage = session::Stage::scan;
    double share = 0.0;
    std::size_t cloud_points = 0;  ///< that were seen
    /// How often back, map and plan were made; 0: not yet.
    int backs = 0, plans = 0;
    std::size_t events = 0;  ///< of `events()`
    bool drives = false;     ///< the arms are driven, or were
  };
  [[nodiscard]] Progress progress() const;
  /// Places of the running scan, three float32 each: all of them, or an even share of so many that
  /// a page can draw them.
  [[nodiscard]] std::string cloud() const;
  /// `back_bytes`, `map_json` and `plan_json`; empty: not yet.
  [[nodiscard]] std::string back() const;
  [[nodiscard]] std::string map() const;
  [[nodiscard]] std::string plan() const;
  /// JSON array of what happened, oldest first: paths that ended, forces that the session changed,
  /// commands that it followed.
  [[nodiscard]] std::string events() const;
  /// JSON object of the newest millisecond and the forces since the last call; nothing when there
  /// is nothing new.
  [[nodiscard]] std::optional<std::string> take_frame();

 private:
  void keep(const session::Tick& tick);
  void keep_events(const session::Tick& tick);

  robot::RobotModel robot_;
  mutable std::mutex mutex_;
  Progress progress_;
  std::vector<Eigen::Vector3f> cloud_;
  std::size_t cloud_stride_ = 1;  ///< every so many-th point is kept
  scanner::Scan scan_;
  std::string back_, map_, plan_;
  std::vector<std::pair<std::string, Vector3>> paths_;  ///< of that plan: name, and where it begins
  Transform couch_from_base_ = Transform::Identity();
  /// Once the person's position is known.
  std::unique_ptr<const PerArm<robot::ArmModel>> arms_;
  std::vector<std::string> events_;  ///< JSON objects
  std::optional<session::Tick> newest_;
  /// Time, and of each arm the force asked for and the force felt, every 20 ms.
  std::vector<std::array<double, 5>> forces_;
};

}  // namespace tuina::app
