// SPDX-License-Identifier: Apache-2.0
#include "tuina/motion/two_arm_schedule.hpp"

#include <algorithm>
#include <limits>

#include "tuina/control/arm_controller.hpp"
#include "tuina/core/parallel.hpp"
#include "tuina/core/units.hpp"
#include "tuina/massage/technique/contact_path.hpp"
#include "tuina/motion/startle.hpp"

namespace tuina::motion {
namespace {

using Planned = const massage::PlannedPath*;

}  // namespace

TwoArmSchedule::TwoArmSchedule(Stage stage)
    : min_arm_distance_m(std::numeric_limits<double>::infinity()),
      end_s(control::ArmController::Options{}.learn_s),
      stage_(std::move(stage)) {
  for (const Arm arm : both_arms) rest_[arm] = rest_at_ready(stage_, arm);
  min_arm_distance_m = apart_m(rest_[Arm::left].stay, rest_[Arm::right].stay);
  marks_.push_back(mark());
}

double TwoArmSchedule::apart_m(const JointPath& left, const JointPath& right) const {
  return distance_between_m(stage_.models, {.of = {&left, &right}});
}

double TwoArmSchedule::apart_m(Arm arm, const JointPath& its, const JointPath& of_other) const {
  return arm == Arm::left ? apart_m(its, of_other) : apart_m(of_other, its);
}

void TwoArmSchedule::add_job(Arm arm, int path, const std::vector<control::ToolPose>& way,
                             const JointVector& posture_rad) {
  jobs[arm].push_back({.path = path,
                       .step = job_step_,
                       .waypoints_in_base = way,
                       .posture_rad = posture_rad,
                       .from_rad = rest_[arm].parked ? rest_[arm].q_rad : JointVector()});
}

void TwoArmSchedule::add_transfer(Arm arm, const ArmMove& move) {
  add_job(arm, -1, move.waypoints_in_base, move.posture_rad);
  clear.take_least(move.clear);
  ++job_step_;
  end_s += move.transfer_s;
  rest_[arm] = move.above;
}

/// The path with no more force than a person who starts up against an arm of this mass bears.
massage::PlannedPath TwoArmSchedule::bearable(const massage::PlannedPath& planned, double mass_kg) {
  massage::PlannedPath path = planned;
  const double planned_n = planned.ordered_n();
  // What control gives over an order meets a person who starts up as well.
  const double over_n = row_of(path.path.technique).overshoot_n;
  const double wanted_n = std::max(planned_n, path.cap_n) + over_n;
  const double max_n = max_pressing_n(mass_kg, path.zone, wanted_n) - over_n;
  path.cap_n = std::min(path.cap_n, max_n);
  if (planned_n <= max_n) return path;
  for (ContactPoint& point : path.path.points) point.force_n = std::min(point.force_n, max_n);
  lowered_n += planned_n - max_n;
  path.lowered_by = sentence("by_mass", "an arm that is felt as {:.1f} kg", mass_kg);
  Sentence note = sentence(
      "note_arm_too_heavy",
      "{}: {:.1f} N instead of {:.1f} N: the arm is felt as {:.1f} kg there, too heavy for a "
      "person who starts up",
      path.path.name, max_n, planned_n, mass_kg);
  if (std::find(notes.begin(), notes.end(), note) == notes.end()) notes.push_back(std::move(note));
  return path;
}

/// Adds the contacts of one step; an arm that has transferred already starts above its path.
void TwoArmSchedule::add_contacts(const Moves& moves, const PerArm<Planned>& planned) {
  const massage::Transfers transfers{.standoff_m = stage_.standoff_m};
  double transfer_s = 0.0, off_s = 0.0;
  for (const Arm arm : both_arms) {
    if (moves[arm] == nullptr) continue;
    const ArmMove& move = *moves[arm];
    clear.take_least(move.clear);
    const bool transferred = rest_[arm].q_rad == move.above.q_rad;
    if (!transferred) transfer_s = std::max(transfer_s, move.transfer_s);
    const std::vector<control::ToolPose> way =
        transferred ? std::vector{move.waypoints_in_base.back()} : move.waypoints_in_base;
    const int path = planned[arm] == nullptr ? -1 : static_cast<int>(paths.size());
    add_job(arm, path, way, move.posture_rad);
    if (planned[arm] != nullptr) {
      paths.push_back(bearable(*planned[arm], move.mass_kg));
      paths.back().step = path_step_;
    }
    rest_[arm] = move.after;
  }
  for (massage::PlannedPath& path : paths) {
    if (path.step != path_step_) continue;
    path.start_s = end_s + transfer_s + transfers.approach_s();
    off_s = std::max(off_s, path.end_s() + transfers.retract_s());
  }
  end_s = std::max(end_s + transfer_s, off_s);
  ++job_step_;
  ++path_step_;
  marks_.push_back(mark());
}

void TwoArmSchedule::leave_out(const massage::PlannedPath& planned, double apart_m) {
  ++left_out;
  notes.push_back(sentence("note_arms_too_close",
                           "{} is left out: the arms would come within {:.0f} mm",
                           planned.path.name, to_mm(std::max(apart_m, 0.0))));
}

Result<ArmMove> TwoArmSchedule::plan_move(Arm arm, const massage::PlannedPath& planned) const {
  auto move = move_to_path(stage_, arm, rest_[arm], planned.path, static_cast<int>(paths.size()));
  if (!move) return move;
  const double min_n = std::min(planned.ordered_n(), massage::kept_force_n) +
                       row_of(planned.path.technique).overshoot_n;
  if (max_pressing_n(move->mass_kg, planned.zone, min_n) < min_n)
    return fail(Fault::not_found,
                "the arm is felt as {:.1f} kg there, too heavy for a person who starts up",
                move->mass_kg);
  return move;
}

/// True where the arm would come to stand elsewhere than rehearsed, and would less from home. A
/// wrist that strays from contact to contact ends up turned over, and finds no way back.
bool TwoArmSchedule::strays_less_from_home(Arm arm, const massage::PlannedPath& planned,
                                           const ArmMove& move) const {
  if (move.stray_m == 0.0 || rest_[arm].parked) return false;
  const auto from_home =
      move_to_path(stage_, arm, rest_at_ready(stage_, arm), planned.path, move.path);
  return from_home && from_home->stray_m < move.stray_m;
}

/// Adds both paths where they can run at once.
TwoArmSchedule::Pair TwoArmSchedule::plan_pair(const PerArm<Planned>& both) {
  // The arms are planned in parallel; which failed is told afterwards.
  PerArm<Result<ArmMove>> move;
  for_each_in_parallel(both_arms.size(), [&](std::size_t i) {
    const Arm arm = both_arms[i];
    move[arm] = plan_move(arm, *both[arm]);
  });
  if (!move[Arm::left] || !move[Arm::right]) return Pair::out_of_reach;
  const ArmMove &left = *move[Arm::left], &right = *move[Arm::right];
  if (strays_less_from_home(Arm::left, *both[Arm::left], left) ||
      strays_less_from_home(Arm::right, *both[Arm::right], right)) {
    finish();
    return plan_pair(both);
  }
  const Moves moves{.of = {&left, &right}};
  const double contacts_m = apart_m(left.contact, right.contact);
  if (contacts_m < wanted_arm_distance_m) return Pair::too_close;
  const double all_m =
      std::min({contacts_m, apart_m(left.transfer, right.transfer),
                apart_m(left.transfer, right.contact), apart_m(left.contact, right.transfer)});
  if (all_m >= wanted_arm_distance_m) {
    min_arm_distance_m = std::min(min_arm_distance_m, all_m);
    add_contacts(moves, both);
    return Pair::together;
  }
  for (const Arm first : both_arms) {
    const Arm second = other(first);
    const double apart =
        std::min({contacts_m, apart_m(first, move[first]->transfer, rest_[second].stay),
                  apart_m(second, move[second]->transfer, move[first]->above.stay)});
    if (apart < wanted_arm_distance_m) continue;
    min_arm_distance_m = std::min(min_arm_distance_m, apart);
    add_transfer(first, *move[first]);
    add_transfer(second, *move[second]);
    add_contacts(moves, both);
    return Pair::together;
  }
  return Pair::too_close;
}

/// One arm works. The other stays where it is, over its next place, moves out of the way first, or
/// travels there meanwhile.
void TwoArmSchedule::plan_single(Arm arm, const massage::PlannedPath& planned) {
  const Arm idle = other(arm);
  auto move = plan_move(arm, planned);
  const bool both_parked = rest_[arm].parked && rest_[idle].parked;
  if (!move && !both_parked) {
    // The path may be reachable from home.
    finish();
    return plan_single(arm, planned);
  }
  if (!move) {
    ++left_out;
    notes.push_back(sentence("note_out_of_reach", "{} is left out: {}", planned.path.name,
                             move.error().message));
    return;
  }
  if (strays_less_from_home(arm, planned, *move)) {
    finish();
    return plan_single(arm, planned);
  }
  const auto beside_m = [&](const JointPath& of_idle) {
    return std::min(apart_m(arm, move->transfer, of_idle), apart_m(arm, move->contact, of_idle));
  };
  double apart = beside_m(rest_[idle].stay);
  PerArm<Planned> paths_of;
  paths_of[arm] = &planned;
  Moves moves;
  moves[arm] = &*move;
  ArmMove home;
  if (!rest_[idle].parked && apart < wanted_arm_distance_m) {
    home = move_home(stage_, idle, rest_[idle]);
    moves[idle] = &home;
    apart = beside_m(home.transfer);
    if (apart < wanted_arm_distance_m) {
      const double first_m = apart_m(idle, home.transfer, rest_[arm].stay);
      if (first_m >= wanted_arm_distance_m) {
        min_arm_distance_m = std::min(min_arm_distance_m, first_m);
        add_transfer(idle, home);
        moves[idle] = nullptr;
        apart = beside_m(rest_[idle].stay);
      }
    }
  }
  if (apart < wanted_arm_distance_m && !both_parked) {
    finish();
    return plan_single(arm, planned);
  }
  if (apart < closest_arm_distance_m) {
    leave_out(planned, apart);
    return;
  }
  min_arm_distance_m = std::min(min_arm_distance_m, apart);
  add_contacts(moves, paths_of);
}

void TwoArmSchedule::add_step(PerArm<Planned> planned) {
  const bool both = planned[Arm::left] != nullptr && planned[Arm::right] != nullptr;
  if (both) {
    const Pair pair = plan_pair(planned);
    if (pair == Pair::together) return;
    // What is out of reach is left out below, which says so.
    if (pair == Pair::too_close)
      notes.push_back(sentence("note_one_after_the_other",
                               "{} and {} run one after the other: the arms would come within "
                               "{:.0f} mm of each other",
                               planned[Arm::left]->path.name, planned[Arm::right]->path.name,
                               to_mm(wanted_arm_distance_m)));
  }
  for (const Arm arm : both_arms) {
    if (planned[arm] != nullptr) plan_single(arm, *planned[arm]);
  }
}

}  // namespace tuina::motion
