// SPDX-License-Identifier: Apache-2.0
#include "tuina/body/baselines.hpp"

#include "tuina/body/fit_shape.hpp"

namespace tuina::body {
namespace {

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
  const auto fit = fit_shape(shape, back, {.modes = 0});
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

}  // namespace tuina::body
