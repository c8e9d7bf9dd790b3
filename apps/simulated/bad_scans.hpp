// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "tuina/body/acupoints.hpp"
#include "tuina/body/learn/labelled_body.hpp"

namespace tuina::app {

/// Something that spoils a scan: a thing on the back, a part out of view, a posture or size that no
/// phantom of the atlas has. `spoil` changes the skin that is seen (`scan_in_couch`, which must
/// have points) and, where the body itself is changed, its true points with it.
struct BadScan {
  const char* name;
  void (*spoil)(body::LabelledBody& person);
};

[[nodiscard]] std::span<const BadScan> bad_scans();

/// A person whose skin was sampled every 5 mm and then spoilt.
[[nodiscard]] body::LabelledBody spoilt(body::LabelledBody person, const BadScan& bad);

/// @{
/// The same person with the spine bent to the left from the sacrum up, and with the shoulders
/// twisted against the pelvis: skin, scan, points and landmarks; normals keep.
void bend(body::LabelledBody& person, double angle_rad);
void twist(body::LabelledBody& person, double angle_rad);
/// @}

/// How far a found point is from the true one, along the true skin: what lies on a point raises it,
/// but does not move its place on the back.
[[nodiscard]] double place_error_m(const Acupoint& found, const Acupoint& truth);

/// Whether it is more than 15 mm and more than the stated radius.
[[nodiscard]] bool wrong_and_sure(const Acupoint& found, const Acupoint& truth);

}  // namespace tuina::app
