// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "tuina/body/field_morphing.hpp"
#include "tuina/body/learn/correspondence.hpp"
#include "tuina/body/learn/labelled_body.hpp"
#include "tuina/body/outline.hpp"
#include "tuina/body/shape_model.hpp"
#include "tuina/core/progress.hpp"

namespace tuina::body {

/// The standard model of the thesis: the outline of one labelled back and its marks on the same
/// plane.
struct Standard {
  std::vector<FeatureLine> lines;
  std::vector<Vector2> marks;  ///< of the labels of the shape model, in their order
  double radius95_m = 40e-3;   ///< of a mark carried to another person
};

struct PositionAtlas {
  Standard standard;
  ShapeModel shape;
};

/// The labelled backs that points are brought over from: one model for each position it knows.
struct Atlas {
  std::string made;  ///< how, for people
  std::vector<PositionAtlas> positions;

  [[nodiscard]] const PositionAtlas* of(Position position) const;
};

/// What learning found out about itself.
struct LearnReport {
  int bodies = 0;
  std::vector<std::string> skipped;  ///< bodies without a usable outline, with the cause
  int points = 0;                    ///< labels with a name
  int modes = 0;
  double leave_one_out_mm = 0.0;  ///< mean over the seven points; 0 when too few bodies
};

/// Learns from labelled bodies of one or both positions; deterministic. With a `prior`, a few
/// bodies adapt it; without, one body gives an atlas of one. `report` may be null.
[[nodiscard]] Result<Atlas> learn_atlas(const std::vector<LabelledBody>& bodies, const Atlas* prior,
                                        const Progress& progress, LearnReport* report,
                                        Reach reach = Reach::labels);

/// The file: docs/acupoints.md. A wrong version, length or checksum is refused.
[[nodiscard]] std::string to_bytes(const Atlas& atlas);
[[nodiscard]] Result<Atlas> parse_atlas(std::string_view content, std::string_view name);
[[nodiscard]] Result<Atlas> read_atlas(const std::filesystem::path& path);

/// The feature lines of an outline, [thesis] 5.3: shoulders, midline, neck, the sides and the
/// trunk.
[[nodiscard]] std::vector<FeatureLine> feature_lines(const Outline& outline);

}  // namespace tuina::body
