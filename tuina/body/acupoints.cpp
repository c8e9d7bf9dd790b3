// SPDX-License-Identifier: Apache-2.0
#include "tuina/body/acupoints.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <utility>
#include <vector>

#include "tuina/body/correction.hpp"
#include "tuina/body/lumbar_hollow.hpp"
#include "tuina/body/palpation.hpp"
#include "tuina/core/units.hpp"

namespace tuina::body {
namespace {

// Minimum coverage of the atlas' back; tuned on phantoms cut in pieces.
constexpr double enough_seen = 0.66;
constexpr double worst_residual_m = 14_mm;
// Largest turn about the vertical at which a fit is believed: 15 degrees are allowed on the couch,
// and people sit turned by up to 16 degrees themselves.
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

// Strangeness (`LabelEstimate`) from which the modes do not tell how long the trunk is, since the
// atlas knows too few such shapes: adolescents who stand were laid 45 mm too low at GV4.
constexpr double min_strangeness = 2.0;
// Sitting flattens the loins: of 92 people of docs/bodies.md who sit one is more than 50 mm hollow,
// and where they are less hollow, the deepest place is anywhere from L4 to T12.
constexpr double depth_of_sitting_m = 50_mm, depth_of_standing_m = 55_mm;
// The hollow of who stands is deepest at L4 or the disc above it [roussouly2005].
constexpr double hollow_error_m = 15_mm;
// An arm or a bag hides some of the back and holds the ruler off the rest.
constexpr double min_covered = 0.9;
constexpr double max_hollow_sigmas = 3.0;  // farther off it is another hollow
constexpr std::array<std::string_view, 9> midline = {"C7", "T3",  "T7", "T9",       "T12",
                                                     "L2", "GV4", "L4", "sacrum_S2"};
constexpr std::size_t of_c7 = 0, of_gv4 = 6, of_l4 = 7;

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

/// Columns of these labels among all of them; empty where one is missing.
std::vector<Eigen::Index> columns_of(const ShapeModel& shape,
                                     std::span<const std::string_view> names) {
  std::vector<Eigen::Index> columns;
  for (const std::string_view name : names) {
    const auto found = std::find(shape.labels.begin(), shape.labels.end(), name);
    if (found == shape.labels.end()) return {};
    columns.push_back(found - shape.labels.begin());
  }
  return columns;
}

/// Along the spine the modes say little of a strange back. There the hollow of the loins of a
/// person who stands is a measurement of how long the trunk is: it is deepest at L4, and GV4 lies
/// above it by the share of the way to C7 that the mean of the atlas has. The points near GV4
/// follow. The radii stay, and reach as far as their points have moved.
void follow_hollow(LabelEstimate& estimate, const ShapeModel& shape, const BackSurface& back) {
  if (shape.position != BodyPosture::sitting || estimate.strangeness < min_strangeness) return;
  const auto columns = columns_of(shape, midline);
  if (columns.empty() || estimate.fit.coverage < min_covered) return;
  const Matrix3 axes = estimate.fit.couch_from_model.linear();
  const Places places = estimate.at_in_couch(Eigen::all, columns);
  const auto hollow = find_lumbar_hollow(back, places, axes);
  if (!hollow || hollow->depth_m <= depth_of_sitting_m) return;
  const double stands = std::min(
      1.0, (hollow->depth_m - depth_of_sitting_m) / (depth_of_standing_m - depth_of_sitting_m));
  const double error_m = hollow_error_m / stands;

  const auto in_mean = [&](std::size_t i) {
    return shape.mean(2, shape.skin_points() + columns[i]);
  };
  const double share = (in_mean(of_gv4) - in_mean(of_l4)) / (in_mean(of_c7) - in_mean(of_l4));
  const Vector3 expected = (1.0 - share) * hollow->at_in_couch + share * places.col(of_c7);
  const Vector3 up = axes.col(2);
  const Eigen::MatrixXd covariance =
      joint_covariance(estimate.at_in_couch, axes, estimate.radius95_m);
  const Eigen::Index gv4 = 3 * columns[of_gv4];
  const Eigen::VectorXd seen = covariance.middleCols<3>(gv4) * up;
  const double spread_m2 = up.dot(seen.segment<3>(gv4)) + error_m * error_m;
  const double surprise_m = up.dot(expected - places.col(of_gv4));
  if (std::abs(surprise_m) > max_hollow_sigmas * std::sqrt(spread_m2)) return;
  const Eigen::VectorXd moved = seen * (surprise_m / spread_m2);
  const Eigen::Map<const Places> by(moved.data(), 3, estimate.at_in_couch.cols());
  estimate.at_in_couch += by;
  estimate.radius95_m = estimate.radius95_m.cwiseMax(by.colwise().norm().transpose());
}

/// The back turned half round about the line of sight.
BackSurface upside_down(const BackSurface& back) {
  PointCloud cloud = back.points();
  Vector3 low = cloud.points.front(), high = low;
  for (const Vector3& p : cloud.points) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  const double angle = heading(cloud, back.position());
  const Eigen::AngleAxisd half(pi, Vector3(-std::sin(angle), std::cos(angle), 0.0));
  const Vector3 middle = 0.5 * (low + high);
  for (Vector3& p : cloud.points) p = middle + half * (p - middle);
  for (Vector3& n : cloud.normals) n = half * n;
  return {std::move(cloud), back.position(), back.spacing_m()};
}

/// Refuses the scan of a sitting person in which z points down. A few such backs look like a
/// strange one that sits upright, so a strange one is turned to see how it fits then. Who lies is
/// tried with the head at either end anyway.
Result<void> check_upright(const LabelEstimate& estimate, const BackSurface& back,
                           const ShapeModel& shape) {
  if (back.position() != BodyPosture::sitting || estimate.strangeness <= 1.0) return {};
  const ShapeFit& upright = estimate.fit;
  const ShapeFit turned = fit_shape(shape, upside_down(back));
  // Of 80 people of docs/bodies.md one fits upside down with less bent modes, nobody with a smaller
  // misfit, too.
  const bool better = turned.outlier_score() < upright.outlier_score() &&
                      turned.residual_m < upright.residual_m && turned.coverage >= min_covered;
  if (!better) return {};
  return fail(Fault::bad_input,
              "the back is upside down: turned by 180 degrees it fits the atlas to {:.1f} mm "
              "and is less unusual ({:.1f}, {:.1f} as it is); z has to point up",
              to_mm(turned.residual_m), turned.outlier_score(), upright.outlier_score());
}

Result<void> fit(Mapping& mapping, const BackSurface& back, const ShapeModel& shape) {
  LabelEstimate estimate = estimate_labels(shape, back);
  if (auto upright = check_upright(estimate, back, shape); !upright) return upright;
  follow_hollow(estimate, shape, back);
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
    const bool known_better = fitted.error().fault == Fault::not_found && !outline &&
                              outline.error().fault == Fault::bad_input;
    return tl::unexpected(known_better ? outline.error() : fitted.error());
  }
  return mapping;
}

}  // namespace tuina::body
