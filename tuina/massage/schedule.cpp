// SPDX-License-Identifier: Apache-2.0
#include "tuina/massage/schedule.hpp"

#include <algorithm>
#include <limits>

namespace tuina::massage {
namespace {

bool can_join(const WaitingPath& one, const WaitingPath& other_path) {
  return one.together && other_path.together && one.part == other_path.part &&
         !(one.arm && other_path.arm && *one.arm == *other_path.arm) &&
         distance_between_m(one.path, other_path.path) >= closest_tools_m;
}

}  // namespace

double PlannedPath::ordered_n() const {
  double max_n = 0.0;
  for (const ContactPoint& point : path.points) max_n = std::max(max_n, point.force_n);
  return max_n;
}

double Transfers::retract_s() const {
  return standoff_m / retract_m_per_s + start_and_stop_s;
}
double Transfers::travel_s(double distance_m) const {
  return distance_m > 0.0 ? distance_m / travel_m_per_s + start_and_stop_s : 0.0;
}
double Transfers::approach_s() const {
  return (standoff_m - last_m) / approach_m_per_s + last_m / search_m_per_s + start_and_stop_s;
}

double distance_between_m(const ContactPath& one, const ContactPath& other_path) {
  constexpr std::size_t every = 10;  // tenth sample, at most 8 mm farther along
  double nearest = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < one.points.size(); i += every) {
    for (std::size_t k = 0; k < other_path.points.size(); k += every) {
      const Vector3 apart = one.points[i].at_in_couch - other_path.points[k].at_in_couch;
      nearest = std::min(nearest, apart.squaredNorm());
    }
  }
  return std::sqrt(nearest);
}

std::vector<PlannedPath> schedule(std::vector<WaitingPath> paths, const Transfers& transfers) {
  std::vector<PlannedPath> planned;
  std::vector<bool> done(paths.size(), false);
  PerArm<std::optional<Vector3>> last_place;
  PerArm<double> work_s;
  double free_s = 0.0;  // time at which all arms are off the skin
  int step = 0;
  for (std::size_t i = 0; i < paths.size(); ++i) {
    if (done[i]) continue;
    std::vector<std::size_t> members = {i};
    for (std::size_t k = i + 1; k < paths.size() && members.size() < 2; ++k) {
      if (!done[k] && can_join(paths[i], paths[k])) members.push_back(k);
    }
    PerArm<bool> taken;
    double max_duration_s = 0.0;
    const std::size_t first = planned.size();
    for (const std::size_t m : members) {
      WaitingPath& waiting = paths[m];
      const bool partner_takes_left =
          members.size() == 2 && !waiting.arm && paths[m == i ? members[1] : i].arm == Arm::left;
      const bool right_has_less_work =
          partner_takes_left || work_s[Arm::right] <= work_s[Arm::left];
      Arm arm = waiting.arm.value_or(right_has_less_work ? Arm::right : Arm::left);
      if (taken[arm]) arm = other(arm);
      taken[arm] = true;
      done[m] = true;
      const Vector3 from = waiting.path.points.front().at_in_couch;
      const double way_m = last_place[arm] ? (from - *last_place[arm]).norm() : 0.0;
      const double touch_s = transfers.travel_s(way_m) + transfers.approach_s();
      max_duration_s = std::max(max_duration_s, touch_s);
      work_s[arm] += waiting.path.duration_s();
      last_place[arm] = waiting.path.points.back().at_in_couch;
      planned.push_back({.path = std::move(waiting.path),
                         .arm = arm,
                         .step = step,
                         .start_s = 0.0,
                         .zone = waiting.zone,
                         .cap_n = waiting.cap_n,
                         .programme_n = waiting.programme_n,
                         .lowered_by = std::move(waiting.lowered_by)});
    }
    double end_s = 0.0;
    for (std::size_t p = first; p < planned.size(); ++p) {
      planned[p].start_s = free_s + max_duration_s;
      end_s = std::max(end_s, planned[p].end_s());
    }
    free_s = end_s + transfers.retract_s();
    ++step;
  }
  return planned;
}

}  // namespace tuina::massage
