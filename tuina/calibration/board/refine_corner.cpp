// SPDX-License-Identifier: Apache-2.0
#include "tuina/calibration/board/refine_corner.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "tuina/core/decompositions.hpp"

namespace tuina::calibration {

// cornerSubPix interpolates gradients between pixels, which shifts corners by 0.02 px depending on
// the fraction of the pixel. The same condition (each gradient is perpendicular to the direction of
// the corner) at whole pixels avoids that error.
std::optional<Vector2> refine_corner(ImageView image, Vector2 corner, int window,
                                     const std::function<bool(int x, int y)>& counts) {
  const double reach = 0.6 * window;
  for (int step = 0; step < 20; ++step) {
    const auto x0 = static_cast<int>(std::lround(corner.x()));
    const auto y0 = static_cast<int>(std::lround(corner.y()));
    if (x0 - window < 1 || y0 - window < 1 || x0 + window > image.width - 2 ||
        y0 + window > image.height - 2) {
      return std::nullopt;
    }
    Eigen::Matrix2d sums = Eigen::Matrix2d::Zero();
    Vector2 moments = Vector2::Zero();
    for (int y = y0 - window; y <= y0 + window; ++y) {
      const std::uint8_t* row = image.row(y);
      for (int x = x0 - window; x <= x0 + window; ++x) {
        if (counts && !counts(x, y)) continue;
        const Vector2 slope(row[x + 1] - row[x - 1], image.row(y + 1)[x] - image.row(y - 1)[x]);
        const Vector2 at(x, y);
        const double weight = std::exp(-0.5 * (at - corner).squaredNorm() / (reach * reach));
        sums += weight * slope * slope.transpose();
        moments += weight * slope * slope.dot(at);
      }
    }
    const Vector2 next = solve_symmetric(sums, moments);
    if (!((next - corner).norm() < std::max(1.0, 0.5 * window))) return std::nullopt;
    const bool settled = (next - corner).norm() < 1e-5;
    corner = next;
    if (settled) break;
  }
  return corner;
}

}  // namespace tuina::calibration
