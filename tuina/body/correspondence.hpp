// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tuina/body/example.hpp"

namespace tuina::body {

/// Skin points and labels that are found again on every labelled back. In a frame like `back`.
struct Template {
  Places skin;
  Places normals;
  Places labels;
  std::vector<std::vector<Eigen::Index>> neighbours;  ///< of each skin point, the nearest eight
};
[[nodiscard]] Template make_template(const Example& example, const std::vector<std::string>& names);
[[nodiscard]] Template template_of(const ShapeModel& prior);

/// The template's skin and labels on another back, in couch: carried by the shared labels, then
/// laid onto the skin along its normals.
[[nodiscard]] Places correspond(const Template& standard, const Example& example,
                                const std::vector<std::string>& names);

}  // namespace tuina::body
