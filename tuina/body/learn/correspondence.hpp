// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tuina/body/learn/example.hpp"

namespace tuina::body {

/// Skin points and labels with correspondences on every labelled back, in a frame like `back`.
struct Template {
  Places skin;
  Places normals;
  Places labels;
  std::vector<std::vector<Eigen::Index>> neighbours;  ///< the nearest eight of each skin point
};
/// Extent of the template's skin: beyond all labels, or beyond the acupoints only, without
/// shoulders and arms.
enum class Reach : std::uint8_t { labels, acupoints };
/// Makes the template of one labelled back; `names` are the labels it gets.
[[nodiscard]] Template make_template(const Example& example, const std::vector<std::string>& names,
                                     Reach reach = Reach::labels);

/// Template made of a model's mean back.
[[nodiscard]] Template template_of(const ShapeModel& model);

/// Skin and labels of the template registered to another back, in couch: a spline through the
/// shared labels, then projection along the normals.
[[nodiscard]] Places correspond(const Template& standard, const Example& example,
                                const std::vector<std::string>& names);

}  // namespace tuina::body
