// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "tuina/body/atlas.hpp"

namespace tuina::body {

enum class Method : std::uint8_t { field_morphing, surface };
[[nodiscard]] constexpr const char* name_of(Method method) {
  return method == Method::field_morphing ? "field_morphing" : "surface";
}
[[nodiscard]] std::optional<Method> parse_method(std::string_view name);

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
};

/// Locates the atlas' acupoints on this person. `field_morphing` is the method of [thesis] 5.2-5.4
/// with one standard back; `surface` fits the learned shape model to the scan. `board_normal`:
/// normal of the projection plane for `field_morphing`, measured on a board (board_plane.hpp).
/// Fails with the cause when the scan does not show a back that the atlas covers.
[[nodiscard]] Result<Mapping> locate_acupoints(const BackSurface& back, const Atlas& atlas,
                                               Method method = Method::surface,
                                               const std::optional<Vector3>& board_normal = {});

}  // namespace tuina::body
