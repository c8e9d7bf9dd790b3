// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <string_view>
#include <utility>

#include "tuina/sim/person/phantom.hpp"

namespace tuina::sim {

/// Trunk sections: at these heights between sacrum (S2, 0) and neck (C7, 1), the distance of the
/// skin from a point 0.18 in front of the spine, in these directions from straight back (0) to the
/// side (90 degrees).
inline constexpr std::array<double, 22> section_heights = {
    -.36, -.30, -.24, -.18, -.12, -.06, 0.0, .08, .16, .24, .32,
    .40,  .48,  .55,  .62,  .69,  .76,  .82, .88, .93, .97, 1.01};
inline constexpr std::array<double, 9> section_angles_deg = {0, 6, 12, 20, 30, 42, 55, 72, 90};
inline constexpr double axis_depth = 0.18;

/// Measures besides the sections, in the order of the table. Heights (z) and distances from the
/// midline (x) are in the trunk frame: S2 at the origin, z towards C7, x to the left, y out of the
/// back.
enum Measure : std::size_t {
  height_l4,
  height_l2,
  height_t12,
  height_t9,
  height_t7,
  height_t3,
  depth_l4,
  depth_l2,
  depth_t12,
  depth_t9,
  depth_t7,
  depth_t3,
  psis_x,
  psis_z,
  scapula_root_x,
  scapula_root_z,
  scapula_spine_mid_x,
  scapula_spine_mid_z,
  inferior_angle_x,
  inferior_angle_z,
  acromial_angle_x,
  acromial_angle_y,
  acromial_angle_z,
  axillary_fold_x,
  axillary_fold_y,
  axillary_fold_z,
  acromion_x,
  acromion_y,
  acromion_z,
  waist_x,
  waist_y,
  waist_z,
  gv2_z,
  three_cun,
  trunk_length,
  measure_count
};

inline constexpr std::size_t section_numbers = section_heights.size() * section_angles_deg.size();
inline constexpr std::size_t table_rows = measure_count + section_numbers;

/// Text of models/phantom.csv, which is built in: proportions of the phantoms and their spread, in
/// lengths C7-S2. Means of sitting men of BMI 22, offsets for women, per 10 of BMI, prone, and
/// prone with the arms up, and loadings of twelve principal components, of 160 synthetic people
/// made with MakeHuman (CC0 1.0), half of each sex, BMI 16 to 34, half sitting and half prone.
/// Distances between landmarks, heights of the spinous processes, and depth of the back at 22
/// heights in 9 directions, left and right averaged. docs/bodies.md compares them with
/// anthropometry.
[[nodiscard]] std::string_view phantom_csv();

/// Proportions of one person in lengths C7-S2; `trunk_length` is C7-S2 over the height.
struct Proportions {
  std::array<double, measure_count> of = {};
  std::array<std::array<double, section_angles_deg.size()>, section_heights.size()> section = {};
};
[[nodiscard]] Proportions proportions_of(const PhantomShape& shape, BodyPosture position);

}  // namespace tuina::sim
