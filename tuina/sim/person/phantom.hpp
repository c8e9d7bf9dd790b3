// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>

#include "tuina/sim/person/person.hpp"

namespace tuina::sim {

/// Who a phantom is. Scores are in standard deviations of the table in phantom_table.cpp; all zero
/// is the mean person of that sex and body mass index, sitting or lying straight.
struct PhantomShape {
  bool woman = false;
  double height_m = 1.66;
  double bmi = 22.0;
  bool arms_up = false;                 ///< prone only
  std::array<double, 12> build = {};    ///< scores of the ways in which bodies of one weight differ
  std::array<double, 13> posture = {};  ///< scores of lean, bend, yaw, ...: phantom_pose.hpp
  std::uint64_t seed = 0;               ///< for the name only
};

/// A person of the project's own: the seed draws sex, height, weight within the type, build and
/// posture.
[[nodiscard]] PhantomShape draw_phantom(BodyType type, std::uint64_t seed);
/// The same with the weight drawn too.
[[nodiscard]] PhantomShape draw_phantom(std::uint64_t seed);

/// The back of that person as an open surface seen from behind, at least 20 000 triangles, with
/// landmarks and acupoints placed by the rules of docs/bodies.md. Never fails; the same shape gives
/// the same person bit for bit.
[[nodiscard]] Person make_phantom(const PhantomShape& shape, Position position);

}  // namespace tuina::sim
