// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "tuina/body/field_morphing.hpp"
#include "tuina/body/learn/body_source.hpp"
#include "tuina/body/learn/correspondence.hpp"
#include "tuina/body/learn/labelled_body.hpp"
#include "tuina/body/outline.hpp"
#include "tuina/body/shape_model.hpp"
#include "tuina/core/progress.hpp"

namespace tuina::body {

/// Standard model of the thesis: outline of one labelled back, and its marks on the same plane.
struct Standard {
  std::vector<FeatureLine> lines;
  std::vector<Vector2> marks;  ///< labels of the shape model, in the same order
  double radius95_m = 40e-3;   ///< 95 % radius of a mark carried to another person
};

/// Both models of one position of the body: of the thesis and of `surface`.
struct PositionAtlas {
  Standard standard;
  ShapeModel shape;
};

/// Models learned from labelled backs, one per position.
struct Atlas {
  std::string made;  ///< origin, for people
  std::vector<PositionAtlas> positions;

  /// Models of a position; null where the atlas has none. They live as long as the atlas.
  [[nodiscard]] const PositionAtlas* of(BodyPosture position) const;
};

/// Results of learning.
struct LearnReport {
  int bodies = 0;
  std::vector<std::string> skipped;  ///< bodies without a usable outline, with the cause
  int points = 0;                    ///< named labels
  int modes = 0;
  double leave_one_out_mm = 0.0;  ///< mean over the seven points; 0 with too few bodies
};

/// Learns from labelled bodies of one or both positions; deterministic. With a `prior`, a few
/// bodies adapt it; without one, a single body gives an atlas of itself. `report` may be null.
[[nodiscard]] Result<Atlas> learn_atlas(const std::vector<LabelledBody>& bodies, const Atlas* prior,
                                        const Progress& progress, LearnReport* report,
                                        Reach reach = Reach::labels);
/// The same of bodies that are read when they are needed: memory for one of them, some ten
/// kilobytes of each, and a file among the system's temporary ones with the registered backs,
/// ninety kilobytes of each.
[[nodiscard]] Result<Atlas> learn_atlas(const BodySource& bodies, const Atlas* prior,
                                        const Progress& progress, LearnReport* report,
                                        Reach reach = Reach::labels);

/// Raises each radius of `atlas` that is smaller than the one `other` has for that label.
void keep_radii_above(const Atlas& other, Atlas& atlas);

/// Serialises an atlas (format: docs/acupoints.md). Reading refuses a wrong version, length or
/// checksum.
[[nodiscard]] std::string to_bytes(const Atlas& atlas);
/// Reads an atlas from its bytes; `name` stands in the message of a refusal.
[[nodiscard]] Result<Atlas> parse_atlas(std::string_view content, std::string_view name);
/// Reads an atlas from a file; fails as parse_atlas() does, and where there is no such file.
[[nodiscard]] Result<Atlas> read_atlas(const std::filesystem::path& path);

/// Feature lines of an outline, [thesis] 5.3: shoulders, midline, neck, sides and trunk.
[[nodiscard]] std::vector<FeatureLine> feature_lines(const Outline& outline);

}  // namespace tuina::body
