// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tuina/body/learn/example.hpp"

namespace tuina::body {

/// Skin points and labels that are found again on every labelled back. In a frame like `back`.
struct Template {
  Places skin;
  Places normals;
  Places labels;
  std::vector<std::vector<Eigen::Index>> neighbours;  ///< of each skin point, the nearest eight
};
/// How far the template's skin goes: beyond all labels, or beyond the acupoints, which leaves
/// shoulders and arms out.
enum class Reach : std::uint8_t { labels, acupoints };
[[nodiscard]] Template make_template(const Example& example, const std::vector<std::string>& names,
                                     Reach reach = Reach::labels);

/// The mean back of a model as a template.
[[nodiscard]] Template template_of(const ShapeModel& model);

/// The template's skin and labels on another back, in couch: carried by the shared labels, then
/// laid onto the skin along its normals.
[[nodiscard]] Places correspond(const Template& standard, const Example& example,
                                const std::vector<std::string>& names);

}  // namespace tuina::body
