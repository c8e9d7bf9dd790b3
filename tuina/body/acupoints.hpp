// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "tuina/body/atlas.hpp"

namespace tuina::body {

/// How an atlas is brought onto a back.
enum class Method : std::uint8_t { field_morphing, surface };
/// Name of a method, as options and files have it.
[[nodiscard]] constexpr const char* name_of(Method method) {
  return method == Method::field_morphing ? "field_morphing" : "surface";
}
/// Method of a name; nothing for any other word.
[[nodiscard]] std::optional<Method> parse_method(std::string_view name);

/// A point of a person that somebody has felt for and shown: an acupoint or a landmark.
struct PalpatedPoint {
  std::string name;
  Vector3 at_in_couch = Vector3::Zero();
  double error_m = 3e-3;  ///< standard deviation in each direction of the skin
};

/// Acupoints of one person, located on their back.
struct Mapping {
  Method method = Method::surface;
  BodyPosture position = BodyPosture::sitting;
  Arms arms = Arms::unknown;
  std::vector<Acupoint> acupoints;  ///< the seven first
  std::vector<Landmark> landmarks;
  double coverage = 1.0;        ///< share of the atlas' back that the scan shows
  double rms_residual_m = 0.0;  ///< RMS distance of the scan from the fitted back; `surface` only
  double mahalanobis2_per_mode =
      0.0;  ///< about 1 or less for backs like those learned from; `surface` only
  /// Joint covariance of acupoints, then landmarks, x, y, z of each in couch; `surface` only.
  Eigen::MatrixXd covariance_m2;
  std::vector<PalpatedPoint> fixed;  ///< points that fix_points (palpation.hpp) has brought in
};

/// Locates the atlas' acupoints on this person. `field_morphing` is the method of [thesis] 5.2-5.4
/// with one standard back; `surface` fits the learned shape model to the scan. `board_normal`:
/// normal of the projection plane for `field_morphing`, measured on a board (board_plane.hpp).
/// Fails with the cause when the scan does not show a back that the atlas covers.
[[nodiscard]] Result<Mapping> locate_acupoints(const BackSurface& back, const Atlas& atlas,
                                               Method method = Method::surface,
                                               const std::optional<Vector3>& board_normal = {});

/// Projection of a point onto the skin, with distance 0. In a hole of the scan, whose rim is more
/// than 15 mm away, the place itself is better: it is returned with its distance from the rim.
[[nodiscard]] SurfacePoint on_skin(const BackSurface& back, const Vector3& place_in_couch);

}  // namespace tuina::body
