// SPDX-License-Identifier: Apache-2.0
#include "apps/serve/live_view.hpp"

#include <chrono>
#include <nlohmann/json.hpp>

#include "apps/serve/shown_arm.hpp"
#include "apps/serve/shown_back.hpp"
#include "apps/serve/shown_sentence.hpp"
#include "tuina/session/run.hpp"
#include "tuina/session/steering.hpp"
#include "tuina/tissue/tangent_model.hpp"

namespace tuina::app {
namespace {

using nlohmann::json;

constexpr std::uint64_t force_every_ticks = 20;
// Pages that take nothing for twenty seconds get the rest.
constexpr std::size_t max_forces = 1000;
// A page draws so many without a graphics card; of more, every second one is kept, every fourth...
constexpr std::size_t max_cloud_points = 1 << 16;

}  // namespace

void LiveView::on_progress(session::Stage stage, double share) noexcept {
  const std::lock_guard lock(mutex_);
  progress_.stage = stage;
  progress_.share = share;
}

void LiveView::on_profile(const scanner::LiveProfile& profile) {
  const std::lock_guard lock(mutex_);
  if (progress_.share == 0.0 && profile.number == 0) {
    cloud_.clear();
    cloud_stride_ = 1;
    progress_.cloud_points = 0;
  }
  for (const Vector3& point : profile.points_in_couch) {
    if (progress_.cloud_points++ % cloud_stride_ != 0) continue;
    cloud_.emplace_back(point.cast<float>());
    if (cloud_.size() < max_cloud_points) continue;
    std::size_t kept = 0;
    for (std::size_t i = 0; i < cloud_.size(); i += 2) cloud_[kept++] = cloud_[i];
    cloud_.resize(kept);
    cloud_stride_ *= 2;
  }
}

void LiveView::on_scan(const scanner::Scan& scan) {
  scan_ = scan;
}

void LiveView::on_map(const body::Mapping& map) {
  std::string back = back_bytes(scan_.cloud_in_couch, map.acupoints, map.landmarks);
  const robot::RobotPlacement placement =
      robot::place_robot(robot_, map.position, session::head_at_plus_y(map.acupoints));
  const std::lock_guard lock(mutex_);
  arms_ =
      std::make_unique<PerArm<robot::ArmModel>>(robot::both_models(placement.arm, placement.mount));
  back_ = std::move(back);
  map_ = map_json(map.position, map.acupoints);
  ++progress_.backs;
}

void LiveView::show_plan(const motion::ReadyPlan& plan) {
  std::string text = plan_json(plan.plan);
  const std::lock_guard lock(mutex_);
  paths_.clear();
  for (const massage::PlannedPath& path : plan.plan.paths)
    paths_.emplace_back(path.path.name, path.path.points.front().at_in_couch);
  if (text == plan_) return;
  plan_ = std::move(text);
  ++progress_.plans;
}

void LiveView::on_plan(const motion::ReadyPlan& plan, const Transform& base_from_couch) {
  show_plan(plan);
  const std::lock_guard lock(mutex_);
  couch_from_base_ = base_from_couch.inverse();
}

// The mutex is held.
void LiveView::keep_events(const session::Tick& tick) {
  const double time_s = rounded(tick.reading.time_s, 10.0);
  // Of the plan of now: after a new scan another one counts its paths anew.
  const auto of_path = [&](const char* what, int path) {
    json event{{"what", what}, {"path", path}};
    if (path < 0 || path >= static_cast<int>(paths_.size())) return event;
    const auto& [name, at] = paths_[static_cast<std::size_t>(path)];
    event["name"] = name;
    event["at_m"] = {rounded(at.x(), 1e4), rounded(at.y(), 1e4), rounded(at.z(), 1e4)};
    return event;
  };
  const auto keep = [&](json event) {
    event["time_s"] = time_s;
    events_.push_back(event.dump());
  };
  if (tick.commanded) {
    const std::chrono::duration<double> clock_s =
        std::chrono::steady_clock::now().time_since_epoch();
    keep({{"what", "command"}, {"name", name_of(*tick.commanded)}, {"clock_s", clock_s.count()}});
  }
  if (tick.decided) {
    json decision = of_path("decision", tick.decided->path);
    decision["reason"] = shown_sentence({.words = tick.decided->reason, .key = tick.decided->key});
    decision["from_n"] = rounded(tick.decided->from_n, 10.0);
    decision["to_n"] = rounded(tick.decided->to_n, 10.0);
    keep(std::move(decision));
  }
  if (tick.stopped)
    keep({{"what", "stop"}, {"reason", shown_sentence(session::explain(*tick.stopped))}});
  if (!tick.ended) return;
  json ended = of_path("ended", tick.ended->path);
  ended["whole"] = tick.ended->whole;
  if (tick.ended->felt) {
    const double stiffness_n_per_m =
        tissue::stiffness_at_force(tick.ended->felt->tissue, session::reference_force_n);
    ended["stiffness_n_per_mm"] = rounded(stiffness_n_per_m * 1e-3, 100.0);
  }
  keep(std::move(ended));
}

void LiveView::on_tick(const session::Tick& tick) noexcept {
  try {
    keep(tick);
  } catch (const std::exception&) {
    // The page misses a millisecond; the session goes on.
  }
}

void LiveView::keep(const session::Tick& tick) {
  const std::lock_guard lock(mutex_);
  keep_events(tick);
  progress_.drives = true;
  newest_ = tick;
  if (tick.reading.tick % force_every_ticks != 0 || forces_.size() == max_forces) return;
  const session::ArmView &left = tick.view[Arm::left], &right = tick.view[Arm::right];
  forces_.push_back(
      {tick.reading.time_s, left.target_n, left.measured_n, right.target_n, right.measured_n});
}

LiveView::Progress LiveView::progress() const {
  const std::lock_guard lock(mutex_);
  Progress progress = progress_;
  progress.events = events_.size();
  return progress;
}

std::string LiveView::cloud() const {
  const std::lock_guard lock(mutex_);
  return {reinterpret_cast<const char*>(cloud_.data()), cloud_.size() * sizeof cloud_[0]};
}

std::string LiveView::back() const {
  const std::lock_guard lock(mutex_);
  return back_;
}

std::string LiveView::map() const {
  const std::lock_guard lock(mutex_);
  return map_;
}

std::string LiveView::plan() const {
  const std::lock_guard lock(mutex_);
  return plan_;
}

std::string LiveView::events() const {
  const std::lock_guard lock(mutex_);
  return fmt::format("[{}]", fmt::join(events_, ","));
}

std::optional<std::string> LiveView::take_frame() {
  const std::lock_guard lock(mutex_);
  if (!newest_) return std::nullopt;
  json arms = json::array();
  for (const Arm arm : both_arms) {
    const session::ArmView& view = newest_->view[arm];
    const robot::RobotReading& reading = newest_->reading;
    json links = json::array();
    if (arms_)
      links = shown_links((*arms_)[arm], reading.arms[arm].q_rad, reading.rail_m, couch_from_base_);
    arms.push_back({{"phase", session::name_of(view.phase)},
                    {"path", view.path},
                    {"probing", view.probing},
                    {"target_n", rounded(view.target_n, 100.0)},
                    {"felt_n", rounded(view.measured_n, 100.0)},
                    {"links", links}});
  }
  json forces = json::array();
  for (const auto& row : forces_) {
    json numbers = json::array();
    for (const double value : row) numbers.push_back(rounded(value, 100.0));
    forces.push_back(std::move(numbers));
  }
  std::string text = json{
      {"channel", "live"},
      {"time_s", rounded(newest_->reading.time_s, 1e3)},
      {"performed", newest_->performed},
      {"intensity", rounded(newest_->intensity, 1e3)},
      {"arms", arms},
      {"forces", forces}}.dump();
  newest_.reset();
  forces_.clear();
  return text;
}

}  // namespace tuina::app
