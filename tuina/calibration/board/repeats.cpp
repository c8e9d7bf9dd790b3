// SPDX-License-Identifier: Apache-2.0
#include "tuina/calibration/board/repeats.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

namespace tuina::calibration {
namespace {

/// Whether two poses show the board in one place: by the corners that both have at one yaw.
bool in_one_place(const std::vector<const View*>& one, const std::vector<const View*>& other) {
  double sum2_px2 = 0.0;
  int common = 0;
  for (const View* a : one) {
    for (const View* b : other) {
      if (std::abs(a->yaw_rad - b->yaw_rad) > same_yaw_rad) continue;
      std::map<int, Vector2> seen;
      for (std::size_t k = 0; k < a->corners_px.size(); ++k) seen[a->corner(k)] = a->corners_px[k];
      for (std::size_t k = 0; k < b->corners_px.size(); ++k) {
        const auto found = seen.find(b->corner(k));
        if (found == seen.end()) continue;
        sum2_px2 += (found->second - b->corners_px[k]).squaredNorm();
        ++common;
      }
    }
  }
  constexpr double same_px = 0.3;  // a hand holds no board as still from one pose to the next
  return common > 0 && sum2_px2 < common * same_px * same_px;
}

/// Of pictures of one pose at one yaw, one: the one with a line, where there is such.
void leave_out_twins(std::vector<View>& views) {
  std::ranges::stable_sort(views, [](const View& a, const View& b) {
    return std::pair(a.pose, a.line.empty()) < std::pair(b.pose, b.line.empty());
  });
  std::vector<View> kept;
  for (View& view : views) {
    const bool twin = std::any_of(kept.rbegin(), kept.rend(), [&](const View& before) {
      return before.pose == view.pose && std::abs(before.yaw_rad - view.yaw_rad) < same_yaw_rad;
    });
    if (!twin) kept.push_back(std::move(view));
  }
  std::ranges::sort(kept, {}, &View::frame);
  views = std::move(kept);
}

}  // namespace

std::vector<std::string> join_repeats(Views& views) {
  std::map<int, std::vector<const View*>> poses;
  for (const View& view : views.views) poses[view.pose].push_back(&view);
  std::vector<std::string> remarks;
  std::map<int, int> is;  // pose: the one that it repeats
  for (const auto& [pose, of_pose] : poses) {
    const auto same = std::ranges::find_if(poses, [&](const auto& before) {
      return before.first == pose ||
             (!is.contains(before.first) && in_one_place(before.second, of_pose));
    });
    if (same->first == pose) continue;
    is[pose] = same->first;
    remarks.push_back(
        fmt::format("Pose {} shows the board in the same place as pose {}, and counts "
                    "as that.",
                    pose, same->first));
  }
  if (is.empty()) return remarks;
  for (View& view : views.views)
    if (const auto repeats = is.find(view.pose); repeats != is.end()) view.pose = repeats->second;
  leave_out_twins(views.views);
  return remarks;
}

}  // namespace tuina::calibration
