// SPDX-License-Identifier: Apache-2.0
#include "tuina/massage/back_chart.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "tuina/core/io/text_lines.hpp"
#include "tuina/core/units.hpp"

namespace tuina::massage {
namespace {

/// The spine in units of one thoracic vertebra, from C7 down. A thoracic column of about 28 cm over
/// twelve vertebrae and a lumbar one of about 18 cm over five make a lumbar vertebra 1.5 units.
constexpr std::array<double, level_names.size()> level_unit = {0.0,  3.0,  7.0,  9.0,
                                                               12.0, 15.0, 18.0, 21.0};

using Knots = std::vector<std::pair<double, double>>;

/// Straight lines through known values, extended with the slope of the ends.
double interpolate(const Knots& known, double x) {
  auto above = std::upper_bound(known.begin(), known.end(), x,
                                [](double v, const auto& entry) { return v < entry.first; });
  above = std::clamp(above, known.begin() + 1, known.end() - 1);
  const auto& [x0, y0] = *(above - 1);
  const auto& [x1, y1] = *above;
  return y0 + (y1 - y0) * (x - x0) / (x1 - x0);
}

}  // namespace

Result<BackChart> BackChart::from(std::span<const Acupoint> acupoints,
                                  std::span<const Landmark> landmarks) {
  std::vector<std::string> missing;
  std::array<Vector3, seven_acupoints.size()> seven;
  for (std::size_t i = 0; i < seven.size(); ++i) {
    const auto found = std::find_if(acupoints.begin(), acupoints.end(), [&](const Acupoint& a) {
      return a.name == seven_acupoints[i];
    });
    if (found == acupoints.end()) {
      missing.emplace_back(seven_acupoints[i]);
    } else {
      seven[i] = found->at_in_couch;
    }
  }
  if (!missing.empty()) {
    return fail(Fault::bad_input, "the acupoints lack {}; all seven of the thesis are needed",
                listed(missing));
  }
  const auto& [si11_l, si11_r, bl47_l, bl47_r, bl50_l, bl50_r, gv4] = seven;
  const auto spine_landmark = [&](std::size_t level) {
    return std::find_if(landmarks.begin(), landmarks.end(),
                        [&](const Landmark& l) { return l.name == level_names[level]; });
  };

  BackChart chart;
  chart.origin_ = gv4;
  const Vector3 t9 = 0.5 * (bl47_l + bl47_r);
  const Vector3 t12 = 0.5 * (bl50_l + bl50_r);
  const Vector3 shoulders = 0.5 * (si11_l + si11_r);
  const Vector3 leftward = (si11_l - si11_r) + (bl47_l - bl47_r) + (bl50_l - bl50_r);
  chart.up_ = (shoulders - gv4).normalized();
  chart.left_ = (leftward - leftward.dot(chart.up_) * chart.up_).normalized();
  chart.out_ = chart.up_.cross(chart.left_);

  const double height_m = (shoulders - gv4).norm();
  const std::array<double, 3> widths_m = {(si11_l - si11_r).dot(chart.left_),
                                          (bl47_l - bl47_r).dot(chart.left_),
                                          (bl50_l - bl50_r).dot(chart.left_)};
  const auto [narrowest, widest] = std::minmax_element(widths_m.begin(), widths_m.end());
  // Of adults between 1.45 m and 2.05 m; wide enough for any, tight enough for mixed-up names or
  // units.
  if (!(height_m > 120_mm && height_m < 500_mm && *narrowest > 80_mm && *widest < 400_mm)) {
    return fail(
        Fault::bad_input,
        "the acupoints are not those of a back: SI11 lies {:.0f} mm above GV4 (120 to 500), "
        "the left points {:.0f} to {:.0f} mm to the left of the right ones (80 to 400)",
        to_mm(height_m), to_mm(*narrowest), to_mm(*widest));
  }

  // Spinous processes where they are known; else the middles between the paired points.
  Knots known;
  for (std::size_t i = 0; i < level_names.size(); ++i) {
    if (const auto landmark = spine_landmark(i); landmark != landmarks.end()) {
      known.emplace_back(level_unit[i], chart.flat(landmark->at_in_couch).up_m);
      chart.midline_.push_back(chart.flat(landmark->at_in_couch));
    }
  }
  if (known.size() < 2) {
    chart.midline_ = {{0.0, 0.0}, chart.flat(t12), chart.flat(t9), chart.flat(shoulders)};
    // The paired points lie level with the hollow below their vertebra, and so does GV4.
    known = {{9.5, chart.flat(t9).up_m}, {12.5, chart.flat(t12).up_m}, {15.5, 0.0}};
  }
  std::sort(chart.midline_.begin(), chart.midline_.end(),
            [](const Place& a, const Place& b) { return a.up_m < b.up_m; });
  for (std::size_t i = 1; i < chart.midline_.size(); ++i) {
    if (!(chart.midline_[i].up_m - chart.midline_[i - 1].up_m > 5_mm)) {
      return fail(Fault::bad_input,
                  "two levels of the spine lie at one height, {:.0f} mm above GV4",
                  to_mm(chart.midline_[i].up_m));
    }
  }
  for (std::size_t i = 0; i < level_names.size(); ++i) {
    chart.level_up_m_[i] = interpolate(known, level_unit[i]);
    if (i > 0 && !(chart.level_up_m_[i] < chart.level_up_m_[i - 1])) {
      return fail(Fault::bad_input, "the spine runs back: {} lies above {}", level_names[i],
                  level_names[i - 1]);
    }
  }
  chart.cun_m_ = (chart.place_of(bl47_l).left_m - chart.place_of(bl47_r).left_m +
                  chart.place_of(bl50_l).left_m - chart.place_of(bl50_r).left_m) /
                 12.0;
  return chart;
}

Place BackChart::flat(const Vector3& in_couch) const {
  const Vector3 offset = in_couch - origin_;
  return {offset.dot(left_), offset.dot(up_)};
}

double BackChart::midline_left_m(double up_m) const {
  auto above = std::upper_bound(midline_.begin(), midline_.end(), up_m,
                                [](double up, const Place& node) { return up < node.up_m; });
  above = std::clamp(above, midline_.begin() + 1, midline_.end() - 1);
  const Place& low = *(above - 1);
  return low.left_m + (above->left_m - low.left_m) * (up_m - low.up_m) / (above->up_m - low.up_m);
}

Place BackChart::place_of(const Vector3& in_couch) const {
  const Place place = flat(in_couch);
  return {place.left_m - midline_left_m(place.up_m), place.up_m};
}

Vector3 BackChart::in_couch(const Place& place) const {
  return origin_ + (place.left_m + midline_left_m(place.up_m)) * left_ + place.up_m * up_;
}

}  // namespace tuina::massage
