// SPDX-License-Identifier: Apache-2.0
#include "tuina/session/earlier/by_hand.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "tuina/core/decompositions.hpp"
#include "tuina/core/units.hpp"

namespace tuina::session {
namespace {

bool the_same(std::span<const Acupoint> then, std::span<const Acupoint> now) {
  return std::equal(then.begin(), then.end(), now.begin(), now.end(),
                    [](const Acupoint& one, const Acupoint& other) {
                      return one.name == other.name && one.at_in_couch == other.at_in_couch;
                    });
}

}  // namespace

ByHand joined(ByHand said, const ByHand& more) {
  said.no_go.insert(said.no_go.end(), more.no_go.begin(), more.no_go.end());
  for (const body::PalpatedPoint& point : more.fixed) {
    std::erase_if(said.fixed, [&](const auto& before) { return before.name == point.name; });
    said.fixed.push_back(point);
  }
  return said;
}

Result<FittedMotion> fit_motion(std::span<const Acupoint> then, std::span<const Acupoint> now) {
  std::vector<std::pair<Vector3, Vector3>> pairs;
  for (const Acupoint& before : then) {
    for (const Acupoint& after : now) {
      if (after.name == before.name) pairs.emplace_back(before.at_in_couch, after.at_in_couch);
    }
  }
  if (pairs.size() < 3)
    return fail(Fault::bad_input, "{} acupoints are in both scans; 3 are needed", pairs.size());
  Eigen::Matrix3Xd from(3, pairs.size()), to(3, pairs.size());
  for (Eigen::Index i = 0; i < from.cols(); ++i) {
    from.col(i) = pairs[static_cast<std::size_t>(i)].first;
    to.col(i) = pairs[static_cast<std::size_t>(i)].second;
  }
  const Transform motion = rigid_motion(from, to);
  return FittedMotion{motion, std::sqrt((motion * from - to).colwise().squaredNorm().mean())};
}

Result<ByHand> carried(const Said& said, std::span<const Acupoint> now, double max_misfit_m) {
  if (said.empty() || said.lay.empty() || the_same(said.lay, now)) return said.by_hand;
  const auto fitted = fit_motion(said.lay, now);
  if (!fitted) return tl::unexpected(fitted.error());
  const auto& [motion, misfit_m] = *fitted;
  if (!(misfit_m <= max_misfit_m)) {
    return fail(Fault::bad_input,
                "another person, or one who is bent: the acupoints lie otherwise to each other "
                "than when places were ruled out or put right by hand ({:.1f} mm; {:.0f} mm are "
                "borne)",
                to_mm(misfit_m), to_mm(max_misfit_m));
  }
  ByHand moved = said.by_hand;
  for (massage::NoGo& place : moved.no_go) {
    for (Vector3& corner : place.corners_in_couch) corner = motion * corner;
  }
  for (body::PalpatedPoint& point : moved.fixed) point.at_in_couch = motion * point.at_in_couch;
  return moved;
}

}  // namespace tuina::session
