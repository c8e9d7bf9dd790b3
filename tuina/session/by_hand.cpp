// SPDX-License-Identifier: Apache-2.0
#include "tuina/session/by_hand.hpp"

#include <Eigen/Geometry>
#include <cmath>

#include "tuina/core/units.hpp"

namespace tuina::session {
namespace {

// Two scans of one back locate a point within some millimetres of each other.
constexpr double max_misfit_m = 15_mm;

}  // namespace

Result<ByHand> carried(const ByHand& said, std::span<const Acupoint> then,
                       std::span<const Acupoint> now) {
  if (said.no_go.empty() && said.fixed.empty()) return said;
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
  const Transform motion(Eigen::umeyama(from, to, false));
  const double misfit_m = std::sqrt((motion * from - to).colwise().squaredNorm().mean());
  if (!(misfit_m <= max_misfit_m)) {
    return fail(Fault::bad_input,
                "the person moved otherwise than as a whole ({:.0f} mm; {:.0f} mm are borne), so "
                "the places that were ruled out or fixed by hand are not known any more",
                to_mm(misfit_m), to_mm(max_misfit_m));
  }
  ByHand moved = said;
  for (massage::NoGo& place : moved.no_go) {
    for (Vector3& corner : place.corners_in_couch) corner = motion * corner;
  }
  for (body::PalpatedPoint& point : moved.fixed) point.at_in_couch = motion * point.at_in_couch;
  return moved;
}

}  // namespace tuina::session
