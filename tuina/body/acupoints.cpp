// SPDX-License-Identifier: Apache-2.0
#include "tuina/body/acupoints.hpp"

#include <algorithm>
#include <cmath>

#include "tuina/body/correction.hpp"
#include "tuina/body/palpation.hpp"
#include "tuina/core/units.hpp"

namespace tuina::body {
namespace {

// Minimum coverage of the atlas' back; tuned on phantoms cut in pieces.
constexpr double enough_seen = 0.66;
constexpr double worst_residual_m = 14_mm;
// 15 allowed on the couch, and people sit turned by up to 16 themselves.
constexpr double max_turn_rad = 35_deg;
// Limits of ShapeFit's outlier score. With the shipped atlas, laser scans of 93 people of another
// modeller reach 1.5, their halves 1.7 or more. An atlas with shoulders and arms loses more of them
// in every scan: its own people reach 2.5 when left out, unusual people 1.3 times that, halves 2.8
// or more.
constexpr double unusual_anyway = 1.6;
constexpr double beyond_known = 1.3;
constexpr double max_outlier_score = 2.7;

// A rival solution this far away is another place on the person, or the head at the other end.
constexpr double max_doubt_m = 150_mm;

double unusual_allowed(const ShapeModel& shape) {
  return std::clamp(beyond_known * shape.max_outlier_score, unusual_anyway, max_outlier_score);
}

void add(Mapping& mapping, const ShapeModel& shape, std::size_t label, const SurfacePoint& skin,
         double radius_m) {
  if (static_cast<int>(label) < shape.acupoints) {
    mapping.acupoints.push_back({.name = shape.labels[label],
                                 .at_in_couch = skin.at_in_couch,
                                 .normal_in_couch = skin.normal_in_couch,
                                 .uncertainty_m = radius_m});
  } else {
    mapping.landmarks.push_back({shape.labels[label], skin.at_in_couch});
  }
}

/// [thesis] 5.4: warps the mark on the plane of the back, then projects it onto the skin. The
/// candidates of (5.7) are a single one here: the point whose warp is the mark.
void morph(Mapping& mapping, const BackSurface& back, const Outline& outline,
           const PositionAtlas& atlas) {
  const auto lines = feature_lines(outline);
  const Transform couch_from_back = outline.back_from_couch.inverse();
  const Vector3 out = couch_from_back.linear().col(1);
  for (std::size_t i = 0; i < atlas.shape.labels.size(); ++i) {
    const Vector2 at = carry(atlas.standard.marks[i], lines, atlas.standard.lines);
    const Vector3 above = couch_from_back * Vector3(at.x(), 0.6, at.y());
    const auto hit = back.along(above, -out);
    const SurfacePoint skin =
        hit ? *hit : back.nearest(couch_from_back * Vector3(at.x(), 0.0, at.y()));
    add(mapping, atlas.shape, i, skin, atlas.standard.radius95_m);
  }
}

Result<void> check_turn(double turned_rad) {
  if (std::abs(turned_rad) <= max_turn_rad) return {};
  return fail(Fault::not_found,
              "the person is turned by {:.0f} degrees, the atlas knows up to {:.0f}",
              to_deg(std::abs(turned_rad)), to_deg(max_turn_rad));
}

/// Rotation of a fitted person about the vertical; lying, from the nearer end of the bed.
double turn_of(const ShapeFit& fit, BodyPosture position) {
  const Vector3 along = fit.couch_from_model.linear().col(position == BodyPosture::sitting ? 1 : 2);
  const double angle = std::atan2(-along.x(), along.y());
  return position == BodyPosture::sitting ? angle : std::remainder(angle, pi);
}

Result<void> fit(Mapping& mapping, const BackSurface& back, const ShapeModel& shape) {
  const LabelEstimate estimate = estimate_labels(shape, back);
  mapping.coverage = estimate.fit.coverage;
  mapping.rms_residual_m = estimate.fit.residual_m;
  mapping.mahalanobis2_per_mode = estimate.fit.mahalanobis2_per_mode();
  if (estimate.fit.coverage < enough_seen) {
    const double turned_rad = std::abs(heading(back.points(), back.position()));
    return fail(
        Fault::not_found, "less than a back{}: the scan shows {:.0f} % of it, {:.0f} needed",
        turned_rad > max_turn_rad ? fmt::format(", or turned by {:.0f} degrees", to_deg(turned_rad))
                                  : "",
        100.0 * estimate.fit.coverage, 100.0 * enough_seen);
  }
  if (estimate.fit.residual_m > worst_residual_m) {
    return fail(Fault::not_found,
                "this does not look like a back: {:.0f} mm from the nearest back that the atlas "
                "knows, {:.0f} allowed",
                to_mm(estimate.fit.residual_m), to_mm(worst_residual_m));
  }
  const double unusual = estimate.fit.outlier_score();
  if (unusual > unusual_allowed(shape)) {
    return fail(
        Fault::not_found,
        "no whole back that the atlas knows: {:.0f} % of it is seen, and its shape would be "
        "{:.1f} times as unusual as people usually are; together {:.1f}, {:.1f} allowed",
        100.0 * estimate.fit.coverage, estimate.fit.mahalanobis2_per_mode(), unusual,
        unusual_allowed(shape));
  }
  if (const double doubt_m = estimate.fit.label_doubt_m.maxCoeff(); doubt_m > max_doubt_m) {
    return fail(
        Fault::not_found,
        "the back could lie in two places that are {:.0f} mm apart, {:.0f} allowed: the scan "
        "fits the atlas almost as well in both",
        to_mm(doubt_m), to_mm(max_doubt_m));
  }
  if (auto turned = check_turn(turn_of(estimate.fit, back.position())); !turned) return turned;
  Eigen::VectorXd radius95(static_cast<Eigen::Index>(shape.labels.size()));
  for (std::size_t i = 0; i < shape.labels.size(); ++i) {
    const auto column = static_cast<Eigen::Index>(i);
    const SurfacePoint skin = on_skin(back, estimate.at_in_couch.col(column));
    radius95[column] = std::hypot(estimate.radius95_m[column], skin.distance_m);
    add(mapping, shape, i, skin, radius95[column]);
  }
  mapping.covariance_m2 =
      joint_covariance(estimate.at_in_couch, estimate.fit.couch_from_model.linear(), radius95);
  return {};
}

}  // namespace

SurfacePoint on_skin(const BackSurface& back, const Vector3& place_in_couch) {
  SurfacePoint skin = back.nearest(place_in_couch);
  if (skin.distance_m > 15_mm) {
    skin.at_in_couch = place_in_couch;
  } else {
    skin.distance_m = 0.0;
  }
  return skin;
}

std::optional<Method> parse_method(std::string_view name) {
  for (const Method method : {Method::field_morphing, Method::surface}) {
    if (name == name_of(method)) return method;
  }
  return std::nullopt;
}

Result<Mapping> locate_acupoints(const BackSurface& back, const Atlas& atlas, Method method,
                                 const std::optional<Vector3>& board_normal) {
  const PositionAtlas* known = atlas.of(back.position());
  if (known == nullptr) {
    return fail(Fault::not_found, "the person is {}, a position that the atlas does not know",
                name_of(back.position()));
  }
  const auto outline = find_outline(back, board_normal);
  Mapping mapping;
  mapping.method = method;
  mapping.position = back.position();
  mapping.arms = outline ? outline->arms : Arms::unknown;
  if (method == Method::field_morphing) {
    if (const auto turned = check_turn(heading(back.points(), back.position())); !turned) {
      return tl::unexpected(turned.error());
    }
    if (!outline) return tl::unexpected(outline.error());
    morph(mapping, back, *outline, *known);
    return mapping;
  }
  if (const auto fitted = fit(mapping, back, known->shape); !fitted) {
    // A mirrored scan also fits badly; the outline names that cause.
    const bool known_better = !outline && outline.error().fault == Fault::bad_input;
    return tl::unexpected(known_better ? outline.error() : fitted.error());
  }
  return mapping;
}

}  // namespace tuina::body
