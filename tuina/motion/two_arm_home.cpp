// SPDX-License-Identifier: Apache-2.0
// How both arms come home, and what is left out where they cannot.
#include <algorithm>

#include "tuina/core/units.hpp"
#include "tuina/motion/two_arm_schedule.hpp"

namespace tuina::motion {

TwoArmSchedule::WayHome TwoArmSchedule::way_home(const PerArm<ArmRest>& rest) const {
  WayHome way;
  for (const Arm arm : both_arms) way.moves[arm] = move_home(stage_, arm, rest[arm]);
  const auto first_m = [&](Arm arm) {
    return std::min(apart_m(arm, way.moves[arm].transfer, rest[other(arm)].stay),
                    apart_m(other(arm), way.moves[other(arm)].transfer, way.moves[arm].after.stay));
  };
  const double at_once_m = apart_m(way.moves[Arm::left].transfer, way.moves[Arm::right].transfer);
  const double left_m = first_m(Arm::left), right_m = first_m(Arm::right);
  way.at_once = at_once_m >= wanted_arm_distance_m || at_once_m >= std::max(left_m, right_m);
  way.first = left_m >= right_m ? Arm::left : Arm::right;
  way.apart_m = way.at_once ? at_once_m : std::max(left_m, right_m);
  return way;
}

/// The first way round that keeps the wanted distance, or else the one that keeps most. An arm that
/// goes straight home takes its home posture at once, and that may turn it into the other one.
std::optional<TwoArmSchedule::WayRound> TwoArmSchedule::way_round() const {
  const Vector3 up =
      stage_.back.get().position() == BodyPosture::sitting ? Vector3::UnitY() : Vector3::UnitZ();
  const Vector3 left = stage_.base_from_couch.linear().transpose() * Vector3::UnitY();
  std::optional<WayRound> best;
  for (const double far_m : {100_mm, 200_mm}) {
    for (const Arm arm : both_arms) {
      if (rest_[arm].parked) continue;
      const Vector3 outward = arm == Arm::left ? left : Vector3(-left);
      for (const Vector3& towards : {outward, up, Vector3(outward + up)}) {
        WayRound round{.arm = arm, .aside = move_aside(stage_, arm, rest_[arm], far_m * towards)};
        round.apart_m = apart_m(arm, round.aside.transfer, rest_[other(arm)].stay);
        if (!gets_there(round.aside) || round.apart_m < closest_arm_distance_m) continue;
        PerArm<ArmRest> rest = rest_;
        rest[arm] = round.aside.after;
        round.home = way_home(rest);
        round.apart_m = std::min(round.apart_m, round.home.apart_m);
        if (!comes_home(stage_, arm, round.home.moves[arm]) ||
            round.apart_m < closest_arm_distance_m) {
          continue;
        }
        if (best && round.apart_m <= best->apart_m) continue;
        best = std::move(round);
        if (best->apart_m >= wanted_arm_distance_m) return best;
      }
    }
  }
  return best;
}

void TwoArmSchedule::go_home(const WayHome& way) {
  min_arm_distance_m = std::min(min_arm_distance_m, way.apart_m);
  if (!way.at_once) {
    for (const Arm arm : {way.first, other(way.first)}) {
      if (!rest_[arm].parked) add_transfer(arm, way.moves[arm]);
    }
    return;
  }
  double max_duration_s = 0.0;
  for (const Arm arm : both_arms) {
    if (rest_[arm].parked) continue;
    const ArmMove& home = way.moves[arm];
    add_job(arm, -1, home.waypoints_in_base, home.posture_rad);
    clear.take_least(home.clear);
    max_duration_s = std::max(max_duration_s, home.transfer_s);
    rest_[arm] = home.after;
  }
  end_s += max_duration_s;
  ++job_step_;
}

TwoArmSchedule::Mark TwoArmSchedule::mark() const {
  return {.rest = rest_,
          .jobs = {.of = {jobs[Arm::left].size(), jobs[Arm::right].size()}},
          .paths = paths.size(),
          .min_arm_distance_m = min_arm_distance_m,
          .clear = clear,
          .end_s = end_s,
          .lowered_n = lowered_n,
          .job_step = job_step_,
          .path_step = path_step_};
}

/// Takes the last contacts back, with all that was planned since the ones before them.
void TwoArmSchedule::leave_last_out(double apart_m) {
  marks_.pop_back();
  const Mark& before = marks_.back();
  for (std::size_t i = before.paths; i < paths.size(); ++i) leave_out(paths[i], apart_m);
  paths.erase(paths.begin() + static_cast<std::ptrdiff_t>(before.paths), paths.end());
  for (const Arm arm : both_arms) jobs[arm].resize(before.jobs[arm]);
  rest_ = before.rest;
  min_arm_distance_m = before.min_arm_distance_m;
  clear = before.clear;
  end_s = before.end_s;
  lowered_n = before.lowered_n;
  job_step_ = before.job_step;
  path_step_ = before.path_step;
}

void TwoArmSchedule::finish() {
  WayHome way = way_home(rest_);
  while (way.apart_m < closest_arm_distance_m && marks_.size() > 1) {
    if (std::optional<WayRound> round = way_round()) {
      min_arm_distance_m = std::min(min_arm_distance_m, round->apart_m);
      add_transfer(round->arm, round->aside);
      way = std::move(round->home);
      break;
    }
    leave_last_out(way.apart_m);
    way = way_home(rest_);
  }
  go_home(way);
  marks_ = {mark()};
}

}  // namespace tuina::motion
