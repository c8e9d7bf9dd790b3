// SPDX-License-Identifier: Apache-2.0
#include "tuina/massage/zones.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "tuina/core/units.hpp"

namespace tuina::massage {
namespace {

constexpr double spine_half_width_m = 15_mm;
constexpr double gv4_radius_m = 10_mm;
constexpr double bone_edge_m = 10_mm;  // an edge counts this far to either side
constexpr double kidney_inner_m = 40_mm;
constexpr double kidney_outer_m = 90_mm;
constexpr double ribs_from_cun = 3.5;  // muscles cover the angles of the ribs up to here
constexpr double neck_half_width_m = 60_mm;
constexpr double robot_sd_m = 2_mm;   // deviation of the tool, by the scanner's place
constexpr double once_in_2000 = 3.3;  // deviations to one side
constexpr double slack_m = 2.5_mm;    // a path guided along a border keeps this beside it

/// `uncertainty_m` holds the point in 95 % of cases in the two directions of the skin; in one
/// direction 95 % lie within 1.96/2.45 of it.
constexpr double across(double uncertainty_m) {
  return 0.8 * uncertainty_m;
}

double distance_m(const Place& place, const std::vector<Place>& line) {
  double nearest = 1e9;
  for (std::size_t i = 1; i < line.size(); ++i) {
    const Vector2 a(line[i - 1].left_m, line[i - 1].up_m);
    const Vector2 b(line[i].left_m, line[i].up_m);
    const Vector2 p(place.left_m, place.up_m);
    const double length2 = (b - a).squaredNorm();  // 0 where a corner was shown twice
    const double along = length2 > 0.0 ? std::clamp((p - a).dot(b - a) / length2, 0.0, 1.0) : 0.0;
    nearest = std::min(nearest, (p - a - along * (b - a)).norm());
  }
  return nearest;
}

/// Whether a ray from the place crosses the closed line an odd number of times.
bool is_within(const Place& place, const std::vector<Place>& line) {
  bool within = false;
  for (std::size_t i = 1; i < line.size(); ++i) {
    const Place &a = line[i - 1], &b = line[i];
    if ((a.up_m > place.up_m) == (b.up_m > place.up_m)) continue;
    const double crossing_m =
        a.left_m + (place.up_m - a.up_m) / (b.up_m - a.up_m) * (b.left_m - a.left_m);
    if (place.left_m < crossing_m) within = !within;
  }
  return within;
}

/// Largest uncertainty, in one direction, of the points whose names begin so.
double uncertainty_m(std::span<const Acupoint> acupoints, std::string_view prefix) {
  double largest = 0.0;
  for (const Acupoint& point : acupoints) {
    if (point.name.starts_with(prefix)) largest = std::max(largest, point.uncertainty_m);
  }
  return across(largest);
}

/// The landmarks of a scan on its chart, or places that stand in for those it lacks.
struct Bones {
  const BackChart& chart;
  std::span<const Landmark> landmarks;

  [[nodiscard]] Place place(const std::string& name, const Place& otherwise) const {
    const auto found = std::find_if(landmarks.begin(), landmarks.end(),
                                    [&](const Landmark& l) { return l.name == name; });
    return found == landmarks.end() ? otherwise : chart.place_of(found->at_in_couch);
  }
  [[nodiscard]] Place half_width(const std::string& name, const Place& otherwise) const {
    const Place left = place(name + "_L", otherwise);
    const Place right = place(name + "_R", {-otherwise.left_m, otherwise.up_m});
    return {0.5 * (left.left_m - right.left_m), 0.5 * (left.up_m + right.up_m)};
  }
};

}  // namespace

ZoneMap::ZoneMap(const BackChart& chart, std::span<const Acupoint> acupoints,
                 std::span<const Landmark> landmarks, std::span<const NoGo> no_go)
    : chart_(chart) {
  for (const NoGo& entry : no_go) {
    if (entry.corners_in_couch.empty()) continue;
    std::vector<Place>& corners = no_go_.emplace_back();
    for (const Vector3& corner : entry.corners_in_couch) {
      corners.push_back(chart_.place_of(corner));
    }
    corners.push_back(corners.front());
  }
  for (const Acupoint& point : acupoints) {
    if (point.name == "GV4") gv4_ = chart_.place_of(point.at_in_couch);
  }
  midline_uncertainty_m_ = uncertainty_m(acupoints, "GV4");
  midline_sd_m_ = std::hypot(midline_uncertainty_m_ / 1.96, robot_sd_m);
  shoulder_uncertainty_m_ = uncertainty_m(acupoints, "SI11");
  loin_uncertainty_m_ = uncertainty_m(acupoints, "BL50");
  // A palpated BL50 tells of T12, and little of what lies below.
  lumbar_uncertainty_m_ = std::max(loin_uncertainty_m_, uncertainty_m(acupoints, "GV3"));
  sacral_uncertainty_m_ = uncertainty_m(acupoints, "GV2");
  draw_edges(landmarks);
  draw_outline(landmarks, uncertainty_m(acupoints, "BL47"));
}

void ZoneMap::draw_edges(std::span<const Landmark> landmarks) {
  // Where a scan says nothing of a bone the rules of [who2008] do: the medial border of the scapula
  // is 3 cun beside the spine from T3 to T7, the iliac crest is level with L4.
  const Bones bones{chart_, landmarks};
  const double cun = chart_.cun_m();
  for (const std::size_t i : {std::size_t{0}, std::size_t{1}}) {
    const double side = i == 0 ? 1.0 : -1.0;
    const std::string end = i == 0 ? "_L" : "_R";
    const Place root =
        bones.place("scapula_root" + end, {side * 3.0 * cun, chart_.up_of(Level::T3)});
    scapula_border_[i] = {root, bones.place("scapula_inferior_angle" + end,
                                            {side * 3.5 * cun, chart_.up_of(Level::T7)})};
    scapula_spine_[i] = {
        root, bones.place("scapula_spine_mid" + end, {side * 5.0 * cun, chart_.up_of(Level::T3)}),
        bones.place("acromial_angle" + end,
                    {side * 7.0 * cun, chart_.up_of(Level::T3) - 0.5 * cun})};
    const double crest_up = chart_.up_of(Level::L4);
    iliac_crest_[i] = {bones.place("psis" + end, {side * 1.5 * cun, chart_.up_of(Level::S2)}),
                       {side * 3.0 * cun, crest_up - cun},
                       {side * 5.0 * cun, crest_up}};
  }
}

void ZoneMap::draw_outline(std::span<const Landmark> landmarks, double middle_uncertainty_m) {
  const Bones bones{chart_, landmarks};
  const double cun = chart_.cun_m();
  const double fold_up = 0.5 * (chart_.up_of(Level::T7) + chart_.up_of(Level::T9));
  outline_ = {bones.half_width("waist", {5.0 * cun, chart_.up_of(Level::L4)}),
              bones.half_width("axillary_fold", {6.0 * cun, fold_up}),
              bones.half_width("acromial_angle", {7.0 * cun, chart_.up_of(Level::T3)})};
  // Nothing near a flank warns that it is one; each height is known as well as the points there.
  const std::array<double, 3> known_to_m = {std::max(loin_uncertainty_m_, midline_uncertainty_m_),
                                            middle_uncertainty_m, shoulder_uncertainty_m_};
  for (std::size_t i = 0; i < outline_.size(); ++i)
    outline_[i].left_m -= once_in_2000 / 1.96 * known_to_m[i];
  std::sort(outline_.begin(), outline_.end(),
            [](const Place& a, const Place& b) { return a.up_m < b.up_m; });
}

double ZoneMap::half_width_m(double up_m) const {
  if (up_m <= outline_.front().up_m) return outline_.front().left_m;
  for (std::size_t i = 1; i < outline_.size(); ++i) {
    if (up_m > outline_[i].up_m) continue;
    const Place& low = outline_[i - 1];
    const double share = (up_m - low.up_m) / std::max(outline_[i].up_m - low.up_m, 1e-6);
    return low.left_m + share * (outline_[i].left_m - low.left_m);
  }
  return outline_.back().left_m;
}

Zone ZoneMap::at(const Place& place) const {
  const double beside_m = std::abs(place.left_m);
  const double up_m = place.up_m;
  const std::size_t side = place.left_m >= 0.0 ? 0 : 1;
  for (const std::vector<Place>& corners : no_go_) {
    if (is_within(place, corners) || distance_m(place, corners) < contact_radius_m) {
      return Zone::no_go;
    }
  }

  const double c7_m = chart_.up_of(Level::C7);
  const double neck_from_m = c7_m - 10_mm - shoulder_uncertainty_m_;
  if (up_m > c7_m + 30_mm || (up_m > neck_from_m && beside_m < neck_half_width_m)) {
    return Zone::neck;
  }
  if (beside_m > half_width_m(up_m) || up_m < chart_.up_of(Level::S2) + sacral_uncertainty_m_)
    return Zone::outside;

  if (std::hypot(place.left_m - gv4_.left_m, up_m - gv4_.up_m) < gv4_radius_m) return Zone::gv4;
  const double spine_m = spine_half_width_m + midline_uncertainty_m_;
  if (beside_m < spine_m) return Zone::spine;
  if (beside_m < spine_m + contact_radius_m) return Zone::spine_margin;

  const double edge_m = bone_edge_m + shoulder_uncertainty_m_;
  if (distance_m(place, scapula_border_[side]) < edge_m ||
      distance_m(place, scapula_spine_[side]) < edge_m) {
    return Zone::scapula_edge;
  }
  if (distance_m(place, iliac_crest_[side]) < bone_edge_m + loin_uncertainty_m_) {
    return Zone::iliac_crest;
  }
  const double t12_m = chart_.up_of(Level::T12);
  const double l3_m = 0.5 * (chart_.up_of(Level::L2) + chart_.up_of(Level::L4));
  // Ribs begin 3.5 cun beside the spine; the kidneys may lie as far out as that on a broad back.
  const double ribs_m = std::max(kidney_outer_m, ribs_from_cun * chart_.cun_m());
  const double below_scapula_m = scapula_border_[side].back().up_m;
  if (up_m < below_scapula_m && up_m > t12_m - loin_uncertainty_m_ &&
      beside_m > ribs_m - loin_uncertainty_m_) {
    return Zone::ribs;
  }
  if (up_m < t12_m + loin_uncertainty_m_ && up_m > l3_m - lumbar_uncertainty_m_ &&
      beside_m > kidney_inner_m - loin_uncertainty_m_ && beside_m < ribs_m + loin_uncertainty_m_) {
    return Zone::kidney;
  }
  return Zone::muscle;
}

Zone ZoneMap::in_lane(const Vector3& in_couch, Technique technique) const {
  constexpr double step_m = 2_mm;
  const Place place = chart_.place_of(in_couch);
  const Zone own = at(place);
  if (cap_n(own, technique) <= 0.0) return own;
  double width_m = 0.0;
  Zone beside = own;
  for (const double side : {-1.0, 1.0}) {
    for (double off_m = step_m; off_m <= min_lane_m; off_m += step_m) {
      const Zone there = at(Place{place.left_m + side * off_m, place.up_m});
      if (cap_n(there, technique) <= 0.0) {
        beside = there;
        break;
      }
      width_m += step_m;
    }
  }
  return width_m < min_lane_m ? beside : own;
}

bool ZoneMap::perhaps_spine(const Vector3& in_couch) const {
  const Place place = chart_.place_of(in_couch);
  const double deviations = once_in_2000 * midline_sd_m_;
  const double off_gv4_m = std::hypot(place.left_m - gv4_.left_m, place.up_m - gv4_.up_m);
  const bool surely_gv4 = off_gv4_m + deviations < gv4_radius_m;
  return std::abs(place.left_m) < spine_half_width_m + deviations && !surely_gv4;
}

Vector3 ZoneMap::around_denied(const Vector3& in_couch, double side_m) const {
  const Place place = chart_.place_of(in_couch);
  const double low_m = chart_.up_of(Level::S2) + sacral_uncertainty_m_ + slack_m;
  const double high_m = chart_.up_of(Level::C7) - 10_mm - shoulder_uncertainty_m_ - slack_m;
  const double up_m = std::clamp(place.up_m, low_m, high_m);
  const double inner_m = spine_half_width_m + midline_uncertainty_m_ + slack_m;
  const double outer_m = std::max(inner_m, half_width_m(up_m) - slack_m);
  const double side = side_m >= 0.0 ? 1.0 : -1.0;
  const double left_m = side * std::clamp(side * place.left_m, inner_m, outer_m);
  return in_couch + (left_m - place.left_m) * chart_.left() + (up_m - place.up_m) * chart_.up();
}

}  // namespace tuina::massage
