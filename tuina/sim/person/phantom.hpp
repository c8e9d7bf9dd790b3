// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>

#include "tuina/sim/person/person.hpp"

namespace tuina::sim {

/// Parameters of a phantom. Scores are in standard deviations of models/phantom.csv; all zero is
/// the mean person of that sex and body mass index, sitting or lying straight.
struct PhantomShape {
  bool woman = false;
  double height_m = 1.66;
  double bmi = 22.0;
  bool arms_up = false;                 ///< prone only
  std::array<double, 12> build = {};    ///< scores of the principal components of build
  std::array<double, 13> posture = {};  ///< scores of lean, bend, yaw, ...: phantom_pose.hpp
  std::uint64_t seed = 0;               ///< for the name only
};

/// Draws a person: sex, height, weight within the type, build and posture.
[[nodiscard]] PhantomShape draw_phantom(BodyType type, std::uint64_t seed);
/// Draws the weight too.
[[nodiscard]] PhantomShape draw_phantom(std::uint64_t seed);

/// Back of a phantom as an open surface seen from behind, with at least 20 000 triangles, landmarks
/// and acupoints by the rules of docs/bodies.md. Deterministic.
[[nodiscard]] Person make_phantom(const PhantomShape& shape, BodyPosture position);

}  // namespace tuina::sim
