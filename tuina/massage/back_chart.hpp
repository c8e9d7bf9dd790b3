// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cmath>
#include <span>
#include <string_view>
#include <vector>

#include "tuina/core/acupoint.hpp"
#include "tuina/core/result.hpp"

namespace tuina::massage {

/// A place on the map of a back: metres to the person's left of the spine, and metres up along it
/// (towards the head) from GV4.
struct Place {
  double left_m = 0.0;
  double up_m = 0.0;
};

/// The same for anybody: beside the spine in cun, outward, and up it as a share of the way from GV4
/// to C7.
struct RelativePlace {
  double aside_cun = 0.0;
  double up_share = 0.0;
};

/// Levels of the spine with a name, from the head down.
enum class Level : std::uint8_t { C7, T3, T7, T9, T12, L2, L4, S2 };
inline constexpr std::array<const char*, 8> level_names = {"C7",  "T3", "T7", "T9",
                                                           "T12", "L2", "L4", "sacrum_S2"};

/// Person-centred coordinates, spanned by the person's own points, so a back that is turned,
/// leaning or bent on the couch has the same map. What the landmarks do not say comes from the
/// seven acupoints, which are always there.
class BackChart {
 public:
  /// Needs the seven acupoints; takes spinous processes, scapulae and outline from the landmarks
  /// where they are. Fails when a point is missing or the points cannot be those of a back.
  [[nodiscard]] static Result<BackChart> from(std::span<const Acupoint> acupoints,
                                              std::span<const Landmark> landmarks);

  /// Where a place of the couch is on the map; its height over the map is left out.
  [[nodiscard]] Place place_of(const Vector3& in_couch) const;
  /// On the plane of the map, not on the skin; `lift` brings it there.
  [[nodiscard]] Vector3 in_couch(const Place& place) const;

  /// On the person's left side for a positive `side`, on the right one for a negative.
  [[nodiscard]] Place place_at(const RelativePlace& relative, double side) const {
    return {(side > 0.0 ? 1.0 : -1.0) * relative.aside_cun * cun_m_,
            relative.up_share * up_of(Level::C7)};
  }
  /// Inverse of `place_at` without the side: cun beside the spine, and share of the way to C7.
  [[nodiscard]] RelativePlace relative(const Place& place) const {
    return {std::abs(place.left_m) / cun_m_, place.up_m / up_of(Level::C7)};
  }

  /// Height of a level over the map's origin, m.
  [[nodiscard]] double up_of(Level level) const {
    return level_up_m_[static_cast<std::size_t>(level)];
  }
  /// A third of the mean distance from the spine to BL47 and BL50, which lie 3 cun beside it.
  [[nodiscard]] double cun_m() const { return cun_m_; }
  /// @{
  /// Axes of the map in couch, unit: to the person's left, towards the head, out of the back.
  [[nodiscard]] const Vector3& left() const { return left_; }
  [[nodiscard]] const Vector3& up() const { return up_; }
  [[nodiscard]] const Vector3& out() const { return out_; }
  /// @}

 private:
  [[nodiscard]] Place flat(const Vector3& in_couch) const;
  [[nodiscard]] double midline_left_m(double up_m) const;

  Vector3 origin_, left_, up_, out_;
  double cun_m_ = 0.025;
  std::array<double, level_names.size()> level_up_m_ = {};
  std::vector<Place> midline_;  // from low to high, left_m as seen from GV4
};

}  // namespace tuina::massage
