// SPDX-License-Identifier: Apache-2.0
#include "tuina/baselines/acupoint_baselines.hpp"

#include <map>
#include <string>

#include "tuina/body/fit_shape.hpp"

namespace tuina::baselines {

using namespace body;
namespace {

// Hollows below spinous processes, as shares of the way from C7 down to S2: means of adults
// (docs/bodies.md).
constexpr double below_t9 = 0.46;
constexpr double below_t12 = 0.64;
constexpr double below_l2 = 0.76;

Result<const PositionAtlas*> model_for(const BackSurface& back, const Atlas& atlas) {
  const PositionAtlas* known = atlas.of(back.position());
  if (known == nullptr) {
    return fail(Fault::not_found, "the person is {}, a position that the atlas does not know",
                name_of(back.position()));
  }
  return known;
}

void add(Mapping& mapping, const ShapeModel& shape, std::size_t label, const SurfacePoint& skin) {
  if (static_cast<int>(label) < shape.acupoints) {
    mapping.acupoints.push_back({shape.labels[label], skin.at_in_couch, skin.normal_in_couch, 0.0});
  } else {
    mapping.landmarks.push_back({shape.labels[label], skin.at_in_couch});
  }
}

}  // namespace

Result<Mapping> rigid_icp(const BackSurface& back, const Atlas& atlas) {
  const auto known = model_for(back, atlas);
  if (!known) return tl::unexpected(known.error());
  const ShapeModel& shape = (*known)->shape;
  // It begins where the whole fit ends: which end of the bed the head is at, a rigid back tells
  // badly.
  const auto whole = fit_shape(shape, back);
  const auto fit = fit_shape(shape, back, {.modes = 0, .begin = whole.couch_from_model});
  Mapping mapping;
  mapping.position = back.position();
  for (std::size_t i = 0; i < shape.labels.size(); ++i) {
    add(mapping, shape, i, back.nearest(fit.labels_in_couch.col(static_cast<Eigen::Index>(i))));
  }
  return mapping;
}

Result<Mapping> scale_axes(const BackSurface& back, const Atlas& atlas) {
  const auto known = model_for(back, atlas);
  if (!known) return tl::unexpected(known.error());
  const auto outline = find_outline(back);
  if (!outline) return tl::unexpected(outline.error());
  const Standard& standard = (*known)->standard;
  const auto lines = feature_lines(*outline);
  const auto length = [](const FeatureLine& line) { return (line.q - line.p).norm(); };
  const double wide = length(lines[0]) / length(standard.lines[0]);
  const double tall = length(lines[1]) / length(standard.lines[1]);
  const Transform couch_from_back = outline->back_from_couch.inverse();
  Mapping mapping;
  mapping.position = back.position();
  for (std::size_t i = 0; i < standard.marks.size(); ++i) {
    const Vector2 from_neck = standard.marks[i] - standard.lines[1].p;
    const Vector2 at = lines[1].p + Vector2(wide * from_neck.x(), tall * from_neck.y());
    const auto hit = back.along(couch_from_back * Vector3(at.x(), 0.6, at.y()),
                                -couch_from_back.linear().col(1));
    add(mapping, (*known)->shape, i,
        hit ? *hit : back.nearest(couch_from_back * Vector3(at.x(), 0.0, at.y())));
  }
  return mapping;
}

Result<Mapping> cun_rule(const BackSurface& back, const Atlas& atlas) {
  const auto found = locate_acupoints(back, atlas);
  if (!found) return tl::unexpected(found.error());
  std::map<std::string, Vector3> at;
  for (const Landmark& landmark : found->landmarks) at[landmark.name] = landmark.at_in_couch;
  for (const char* name :
       {"C7", "sacrum_S2", "scapula_root_L", "scapula_root_R", "scapula_spine_mid_L",
        "scapula_spine_mid_R", "scapula_inferior_angle_L", "scapula_inferior_angle_R"}) {
    if (!at.contains(name)) return fail(Fault::bad_input, "the atlas has no landmark {}", name);
  }
  const Vector3 across = at["scapula_root_L"] - at["scapula_root_R"];
  Mapping mapping;
  mapping.position = back.position();
  mapping.arms = found->arms;
  const auto put = [&](const char* name, const Vector3& place) {
    const SurfacePoint skin = back.nearest(place);
    mapping.acupoints.push_back({name, skin.at_in_couch, skin.normal_in_couch, 0.0});
  };
  // Three cun lie between the midline and the medial border of the scapula; half of `across` is
  // three.
  const auto level = [&](double share, double side) {
    return Vector3(at["C7"] + share * (at["sacrum_S2"] - at["C7"]) + 0.5 * side * across);
  };
  const auto tianzong = [&](const std::string& side) {
    const Vector3& spine = at["scapula_spine_mid" + side];
    return Vector3(spine + (at["scapula_inferior_angle" + side] - spine) / 3.0);
  };
  put("SI11_L", tianzong("_L"));
  put("SI11_R", tianzong("_R"));
  put("BL47_L", level(below_t9, 1.0));
  put("BL47_R", level(below_t9, -1.0));
  put("BL50_L", level(below_t12, 1.0));
  put("BL50_R", level(below_t12, -1.0));
  put("GV4", level(below_l2, 0.0));
  return mapping;
}

}  // namespace tuina::baselines
