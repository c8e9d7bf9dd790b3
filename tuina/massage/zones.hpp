// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "tuina/core/technique.hpp"
#include "tuina/massage/back_chart.hpp"
#include "tuina/massage/no_go.hpp"

namespace tuina::massage {

/// Regions of a back by what lies under the skin, from the least to the most restricted.
enum class Zone : std::uint8_t {
  muscle,        ///< Muscle beside the spine, around the shoulder blade, the loin.
  kidney,        ///< T12 to L3, from 40 mm beside the spine to 90 mm or 3.5 cun, the larger
  ribs,          ///< Ribs beside the muscle, below the shoulder blade, above T12.
  scapula_edge,  ///< Medial border and spine of the shoulder blade.
  iliac_crest,   ///< Rim of the pelvis.
  spine_margin,  ///< Band beside the spine from which the tool's rim may reach it.
  gv4,           ///< The one place on the spine that may be pressed.
  spine,         ///< Spinous processes.
  neck,          ///< Neck and head.
  outside,       ///< Arms, flanks, below the sacrum: beyond the outline of the back.
  no_go,         ///< Ruled out by the therapist, with the tool's radius around it.
};

/// Radius of the skin under the sphere tool, [thesis] 5.5.
inline constexpr double contact_radius_m = 0.017;

/// Least width of a lane between two denied zones that a tool slides along: the guard's map of the
/// back shows no narrower one.
inline constexpr double min_lane_m = 0.012;

/// The forces and techniques that a zone bears. These are compiled ceilings, starting values that a
/// therapist must confirm; nothing that is read from a file can raise them.
struct ZoneRule {
  const char* name;
  double cap_n;           ///< Largest true force that is meant to be felt; 0: not to be touched.
  double trip_n;          ///< Largest true force before the arm has to give way.
  bool sliding;           ///< Techniques that slide are allowed.
  bool tapping;           ///< Techniques that strike are allowed.
  double max_duration_s;  ///< Longest contact at one place.
};
inline constexpr std::array<ZoneRule, 11> zone_rules = {{
    {"muscle", 45.0, 60.0, true, true, 60.0},
    {"kidney", 20.0, 30.0, true, false, 60.0},
    {"ribs", 15.0, 25.0, true, false, 60.0},
    {"scapula_edge", 15.0, 25.0, true, false, 60.0},
    {"iliac_crest", 15.0, 25.0, true, false, 60.0},
    {"spine_margin", 15.0, 25.0, true, false, 60.0},
    {"GV4", 10.0, 15.0, false, false, 10.0},
    {"spine", 0.0, 10.0, false, false, 0.0},
    {"neck", 0.0, 10.0, false, false, 0.0},
    {"outside", 0.0, 10.0, false, false, 0.0},
    {"no_go", 0.0, 10.0, false, false, 0.0},
}};
/// Cap, trip and techniques of a zone.
[[nodiscard]] constexpr const ZoneRule& rule_of(Zone zone) {
  return zone_rules[static_cast<std::size_t>(zone)];
}
/// Name of a zone, as plans and reports have it.
[[nodiscard]] constexpr const char* name_of(Zone zone) {
  return rule_of(zone).name;
}
/// Newtons that a technique may ask for in a zone, so that the true force keeps to its cap; 0 where
/// it is denied.
[[nodiscard]] constexpr double cap_n(Zone zone, Technique technique) {
  const ZoneRule& rule = rule_of(zone);
  const TechniqueRow& row = row_of(technique);
  const bool denied =
      rule.cap_n <= 0.0 || (row.strikes && !rule.tapping) || (row.slides && !rule.sliding);
  return denied ? 0.0 : rule.cap_n - row.overshoot_n;
}
/// Newtons that a technique may ask for where the spine cannot be ruled out: a spinous process may
/// feel 10 N.
[[nodiscard]] constexpr double perhaps_spine_n(Technique technique) {
  return rule_of(Zone::spine).trip_n - row_of(technique).overshoot_n;
}

/// Which zone a place of one person's back is in. Every border stands on the careful side by the
/// uncertainty of the points it comes from.
class ZoneMap {
 public:
  /// The zones of one person, from their map, and what somebody has ruled out.
  ZoneMap(const BackChart& chart, std::span<const Acupoint> acupoints,
          std::span<const Landmark> landmarks, std::span<const NoGo> no_go = {});

  /// @{
  /// The zone that a place lies in.
  [[nodiscard]] Zone at(const Vector3& in_couch) const { return at(chart_.place_of(in_couch)); }
  [[nodiscard]] Zone at(const Place& place) const;
  /// @}

  /// The zone that decides where a sliding technique may go: the place's own, or a denied one
  /// beside it that leaves a lane across the back narrower than `min_lane_m`.
  [[nodiscard]] Zone in_lane(const Vector3& in_couch, Technique technique) const;

  /// Whether a tool sent here may really come down on a spinous process, once in 2000 times or
  /// more: the borders of the zones hold in 19 of 20 only.
  [[nodiscard]] bool perhaps_spine(const Vector3& in_couch) const;

  /// Moves a guide point of a sliding path in the plane of the map to where it is neither spine,
  /// neck nor outside, on the side of the spine where `side_m` is (positive: the person's left).
  [[nodiscard]] Vector3 around_denied(const Vector3& in_couch, double side_m) const;

 private:
  void draw_edges(std::span<const Landmark> landmarks);
  void draw_outline(std::span<const Landmark> landmarks, double middle_uncertainty_m);
  [[nodiscard]] double half_width_m(double up_m) const;

  BackChart chart_;
  Place gv4_;
  double midline_uncertainty_m_ = 0.0;
  double midline_sd_m_ = 0.0;  ///< Deviation of tool from midline, the robot's own error included.
  double shoulder_uncertainty_m_ = 0.0;
  double loin_uncertainty_m_ = 0.0;
  double lumbar_uncertainty_m_ = 0.0;
  double sacral_uncertainty_m_ = 0.0;
  std::array<std::vector<Place>, 2> scapula_border_, scapula_spine_, iliac_crest_;  // left, right
  std::vector<std::vector<Place>> no_go_;  // corners of each
  std::vector<Place> outline_;             // half width of sure back over height, from low to high
};

}  // namespace tuina::massage
