// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>

#include "tuina/core/geometry.hpp"

namespace tuina::robot {

/// What the arms keep away from besides each other.
enum class Surrounding : std::uint8_t { couch, body };
inline constexpr std::array both_surroundings = {Surrounding::couch, Surrounding::body};

/// A solid box: part of the chair or bed that the person is on, or of the robot's own body.
struct Obstacle {
  Surrounding kind = Surrounding::couch;
  Transform base_from_box = Transform::Identity();  ///< pose of its middle, linear base at zero
  Vector3 edges_m = Vector3::Zero();
  bool rides = false;  ///< moves with the linear base
};

/// How near something is to each kind of surrounding, m; infinite where there is nothing.
struct Clearances {
  std::array<double, 2> of = {std::numeric_limits<double>::infinity(),
                              std::numeric_limits<double>::infinity()};
  /// @{
  /// Distance of the arms to one kind of surroundings, m.
  [[nodiscard]] double& operator[](Surrounding kind) { return of[static_cast<std::size_t>(kind)]; }
  [[nodiscard]] double operator[](Surrounding kind) const {
    return of[static_cast<std::size_t>(kind)];
  }
  /// @}
  [[nodiscard]] double min_m() const noexcept { return std::min(of[0], of[1]); }
  /// Keeps the smaller of each distance.
  void take_least(const Clearances& other) noexcept {
    for (std::size_t i = 0; i < of.size(); ++i) of[i] = std::min(of[i], other.of[i]);
  }
};

}  // namespace tuina::robot
