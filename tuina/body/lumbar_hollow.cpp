// SPDX-License-Identifier: Apache-2.0
#include "tuina/body/lumbar_hollow.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "tuina/core/units.hpp"

namespace tuina::body {
namespace {

using Eigen::Index;

constexpr double half_width_m = 15_mm;  // of the strip of skin over the spine
constexpr double step_m = 6_mm;         // between places of the profile
constexpr double max_gap_m = 30_mm;     // a profile with a larger hole is followed no further
constexpr double min_depth_m = 20_mm;   // a flatter back has no clear deepest place
constexpr double below_sacrum = 0.35;   // of the spine's length: buttocks
constexpr double hollow_from = -0.1,
                 hollow_to = 0.45;  // where loins are, from sacrum (0) to C7 (1)

/// A place of the profile: height towards the head, and how far the skin is out.
struct Step {
  double up_m;
  double out_m;
};

/// Left of the spine at a height, from places sorted by height; beyond the ends, as at them.
double left_of(const Places& line, double up_m) {
  if (up_m <= line(2, 0)) return line(0, 0);
  for (Index i = 1; i < line.cols(); ++i) {
    if (up_m > line(2, i)) continue;
    const double part = (up_m - line(2, i - 1)) / (line(2, i) - line(2, i - 1));
    return line(0, i - 1) + part * (line(0, i) - line(0, i - 1));
  }
  return line(0, line.cols() - 1);
}

/// Mean of the skin over the spine at every height, smoothed, as far as it hangs together.
std::vector<Step> profile_of(const BackSurface& back, const Places& line, const Matrix3& axes) {
  const double spine_m = line(2, line.cols() - 1) - line(2, 0);
  const double from_m = line(2, 0) - below_sacrum * spine_m;
  const auto count = static_cast<std::size_t>((line(2, line.cols() - 1) - from_m) / step_m);
  std::vector<double> sum(count, 0.0);
  std::vector<int> points(count, 0);
  for (const Vector3& point : back.points().points) {
    const Vector3 at = axes.transpose() * point;
    const double row = (at.z() - from_m) / step_m;
    if (row < 0.0 || row >= static_cast<double>(count)) continue;
    if (std::abs(at.x() - left_of(line, at.z())) > half_width_m) continue;
    sum[static_cast<std::size_t>(row)] += at.y();
    ++points[static_cast<std::size_t>(row)];
  }
  std::vector<Step> raw;
  for (std::size_t i = count; i-- > 0;) {  // from the neck down
    if (points[i] == 0) continue;
    const double up_m = from_m + (static_cast<double>(i) + 0.5) * step_m;
    if (!raw.empty() && raw.back().up_m - up_m > max_gap_m) break;
    raw.push_back({up_m, sum[i] / points[i]});
  }
  std::vector<Step> smooth = raw;
  for (std::size_t i = 2; i + 2 < raw.size(); ++i) {
    smooth[i].out_m = 0.0;
    for (std::size_t k = i - 2; k <= i + 2; ++k) smooth[i].out_m += 0.2 * raw[k].out_m;
  }
  return smooth;
}

/// The convex outside of the profile, which a ruler laid on the back would touch.
std::vector<Step> touched_by_ruler(const std::vector<Step>& profile) {
  std::vector<Step> hull;
  for (const Step& next : profile) {
    while (hull.size() >= 2) {
      const Step& a = hull[hull.size() - 2];
      const Step& b = hull.back();
      const double turn =
          (b.up_m - a.up_m) * (next.out_m - a.out_m) - (b.out_m - a.out_m) * (next.up_m - a.up_m);
      if (turn > 0.0) break;
      hull.pop_back();
    }
    hull.push_back(next);
  }
  return hull;
}

}  // namespace

std::optional<LumbarHollow> find_lumbar_hollow(const BackSurface& back,
                                               const Places& midline_in_couch,
                                               const Matrix3& axes_in_couch) {
  Places line = axes_in_couch.transpose() * midline_in_couch;
  std::vector<Vector3> sorted;
  for (Index i = 0; i < line.cols(); ++i) sorted.emplace_back(line.col(i));
  std::sort(sorted.begin(), sorted.end(),
            [](const Vector3& a, const Vector3& b) { return a.z() < b.z(); });
  if (sorted.size() < 2) return std::nullopt;
  for (Index i = 0; i < line.cols(); ++i) line.col(i) = sorted[static_cast<std::size_t>(i)];
  const double sacrum_m = line(2, 0);
  const double spine_m = line(2, line.cols() - 1) - sacrum_m;

  const std::vector<Step> profile = profile_of(back, line, axes_in_couch);
  const std::vector<Step> ruler = touched_by_ruler(profile);
  std::optional<LumbarHollow> deepest;
  for (std::size_t i = 0, k = 0; i < profile.size(); ++i) {
    const Step& at = profile[i];
    while (k + 1 < ruler.size() && ruler[k + 1].up_m > at.up_m) ++k;
    const double share = (at.up_m - sacrum_m) / spine_m;
    if (k + 1 >= ruler.size() || share < hollow_from || share > hollow_to) continue;
    const double part = (ruler[k].up_m - at.up_m) / (ruler[k].up_m - ruler[k + 1].up_m);
    const double under_m = ruler[k].out_m + part * (ruler[k + 1].out_m - ruler[k].out_m) - at.out_m;
    if (under_m < min_depth_m || (deepest && under_m <= deepest->depth_m)) continue;
    deepest = LumbarHollow{
        .at_in_couch = axes_in_couch * Vector3(left_of(line, at.up_m), at.out_m, at.up_m),
        .depth_m = under_m};
  }
  return deepest;
}

}  // namespace tuina::body
