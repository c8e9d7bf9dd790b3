// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "tuina/body/acupoints.hpp"
#include "tuina/motion/ready_plan.hpp"
#include "tuina/robot/robot.hpp"
#include "tuina/scanner/sweep.hpp"
#include "tuina/session/massage_step.hpp"

namespace tuina::session {

/// Stages of a session, in their order.
enum class Stage : std::uint8_t { scan, map, plan, massage };
/// Name of a stage, as pages and records have it.
[[nodiscard]] constexpr const char* name_of(Stage stage) noexcept {
  constexpr const char* names[] = {"scan", "map", "plan", "massage"};
  return names[static_cast<std::size_t>(stage)];
}

/// One millisecond of a massage as it was carried out. It has a fixed size and owns no heap. Of
/// what happens there is one of each kind in a millisecond; a second one comes in the next.
struct Tick {
  robot::RobotReading reading;
  safety::RobotVerdict verdict;
  PerArm<ArmView> view;
  std::size_t performed = 0;             ///< paths ended so far, in this plan
  double intensity = 1.0;                ///< share of the planned forces that is wished for now
  std::optional<LiveCommand> commanded;  ///< somebody asked for it now
  std::optional<Performed> ended;        ///< a path of this plan
  std::optional<Decision> decided;
  std::optional<Stop> stopped;
};

/// Whoever watches a session: a record, a progress bar, a page. Nothing that an observer does
/// reaches the session. `on_tick` is called within the millisecond, after the torques have left: it
/// must be short. One that is not is wrapped in a `Relay`.
class Observer {
 public:
  virtual ~Observer() = default;
  /// A stage has come so far, 0 to 1.
  virtual void on_progress(Stage, double /*share*/) noexcept {}
  /// A line of a scan that is still going on; rougher than what `on_scan` brings.
  virtual void on_profile(const scanner::LiveProfile&) {}
  /// @{
  /// A scan, or the map of it, is there.
  virtual void on_scan(const scanner::Scan&) {}
  virtual void on_map(const body::Mapping&) {}
  /// @}
  /// A plan is about to be carried out; it lives until the next one.
  virtual void on_plan(const motion::ReadyPlan&, const Transform& /*base_from_couch*/) {}
  /// @{
  /// A contact is over, or a millisecond. Called from the control loop: no waiting.
  virtual void on_performed(const Performed&) noexcept {}
  virtual void on_tick(const Tick&) noexcept {}
  /// @}

 protected:
  Observer() = default;
  Observer(const Observer&) = default;
  Observer& operator=(const Observer&) = default;
};

/// Many observers as one, told in their order. They must outlive it.
class Observers final : public Observer {
 public:
  /// They are told in this order.
  explicit Observers(std::vector<Observer*> all) : all_(std::move(all)) {}
  void on_progress(Stage stage, double share) noexcept override {
    for (Observer* one : all_) one->on_progress(stage, share);
  }
  void on_profile(const scanner::LiveProfile& profile) override {
    for (Observer* one : all_) one->on_profile(profile);
  }
  void on_scan(const scanner::Scan& scan) override {
    for (Observer* one : all_) one->on_scan(scan);
  }
  void on_map(const body::Mapping& map) override {
    for (Observer* one : all_) one->on_map(map);
  }
  void on_plan(const motion::ReadyPlan& plan, const Transform& base_from_couch) override {
    for (Observer* one : all_) one->on_plan(plan, base_from_couch);
  }
  void on_performed(const Performed& performed) noexcept override {
    for (Observer* one : all_) one->on_performed(performed);
  }
  void on_tick(const Tick& tick) noexcept override {
    for (Observer* one : all_) one->on_tick(tick);
  }

 private:
  std::vector<Observer*> all_;
};

}  // namespace tuina::session
