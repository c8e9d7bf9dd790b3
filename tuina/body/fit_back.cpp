// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>

#include "tuina/body/back_surface.hpp"
#include "tuina/body/thin_skin.hpp"
#include "tuina/body/voxels.hpp"
#include "tuina/core/units.hpp"

namespace tuina::body {
namespace {

constexpr int enough_points = 2000;
constexpr double couch_m = 25_mm;     // z = 0 holds to 10 mm, a depth camera adds 3 mm of noise
constexpr double gap_m = 30_mm;       // larger gaps separate components
constexpr double max_cloud_m = 12.0;  // a room; a person in centimetres spans 60 and more
// The seven points span 0.27 m of a person of 1.66 m. Of 28 people of docs/bodies.md who lie, cut
// across the spine, those of whom 0.54 m are left are found as well as whole ones; of 0.42 to 0.50
// m one in 23 is laid 44 mm off along the spine with 20 mm said.
constexpr double min_lying_m = 0.50;
constexpr double max_top_m = 0.45;         // extent of what is level with the highest place
constexpr double min_rms_length_m = 0.20;  // 0.7 m of a person, whose long axis then is the spine
constexpr double sitting_height_m = 0.50;  // below the shoulders of the smallest sitting person

double quantile(std::vector<double> values, double fraction) {
  const auto at = values.begin() +
                  static_cast<std::ptrdiff_t>(fraction * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

double quantile_along(const std::vector<Vector3>& points, int axis, double fraction) {
  std::vector<double> values;
  values.reserve(points.size());
  for (const Vector3& p : points) values.push_back(p[axis]);
  return quantile(std::move(values), fraction);
}

Result<void> check_units(const std::vector<Vector3>& points) {
  double widest = 0.0;
  for (int axis = 0; axis < 3; ++axis) {
    widest =
        std::max(widest, quantile_along(points, axis, 0.95) - quantile_along(points, axis, 0.05));
  }
  if (widest > max_cloud_m) {
    return fail(Fault::bad_input,
                "the cloud spans {:.0f} m, a person at most 2: is it in {} instead of metres?",
                widest, widest > 200.0 ? "millimetres" : "centimetres");
  }
  if (widest < 0.1) {
    return fail(Fault::not_found,
                "no person found: the cloud spans {:.0f} mm, a back 400 mm or more", to_mm(widest));
  }
  return {};
}

/// Frame of the cloud itself, so that thinning finds the same cubes after a shift or a turn about
/// the vertical: centroid and principal axis seen from above. Cubes look alike after a quarter
/// turn, so the signs of the axes do not matter.
Transform own_frame(const std::vector<Vector3>& points) {
  Vector3 centre = Vector3::Zero();
  for (const Vector3& p : points) centre += p / static_cast<double>(points.size());
  centre.z() = 0.0;
  double xx = 0.0, xy = 0.0;
  for (const Vector3& p : points) {
    const Vector3 d = p - centre;
    xx += d.x() * d.x() - d.y() * d.y();
    xy += 2.0 * d.x() * d.y();
  }
  Transform own_from_couch = Transform::Identity();
  own_from_couch.rotate(Eigen::AngleAxisd(-0.5 * std::atan2(xy, xx), Vector3::UnitZ()));
  own_from_couch.translate(-centre);
  return own_from_couch;
}

/// Removes flying pixels, which are connected in very dense clouds: points in voxels much emptier
/// than the median. The median is one of the skin: where a laser stood still, points of hundreds of
/// frames lie in one spot, and there they count as few.
void drop_strays(std::vector<Vector3>& above) {
  constexpr std::size_t dense = 250'000;
  constexpr int hardly = 500;  // density ratio to the voxel of the median point
  if (above.size() < dense) return;
  const Voxels voxels = gather(above, gap_m);
  std::vector<int> counts;
  for (const Vector3& spot : gather(above, 3_mm).mean)
    counts.push_back(voxels.count[static_cast<std::size_t>(voxels.around(spot))]);
  const auto median = counts.begin() + static_cast<std::ptrdiff_t>(counts.size() / 2);
  std::nth_element(counts.begin(), median, counts.end());
  const int few = *median / hardly;
  std::erase_if(above, [&](const Vector3& p) {
    const int voxel = voxels.around(p);
    return voxels.count[static_cast<std::size_t>(voxel)] <= few;
  });
}

/// Largest connected component above the couch, with others beside it: the sweep may lose the skin
/// between head and shoulders or behind a fold.
Result<std::vector<Vector3>> find_person(const std::vector<Vector3>& above) {
  const Voxels voxels = gather(above, gap_m);
  const Components parts = connect(voxels);
  std::vector<Vector3> low(parts.points.size(),
                           Vector3::Constant(std::numeric_limits<double>::max()));
  std::vector<Vector3> high(parts.points.size(),
                            Vector3::Constant(std::numeric_limits<double>::lowest()));
  std::vector<int> cells(parts.points.size());
  for (std::size_t i = 0; i < voxels.size(); ++i) {
    const auto part = static_cast<std::size_t>(parts.of_voxel[i]);
    low[part] = low[part].cwiseMin(voxels.mean[i]);
    high[part] = high[part].cwiseMax(voxels.mean[i]);
    ++cells[part];
  }
  // Points are denser near the scanner, so size is counted in cells.
  const auto largest =
      static_cast<std::size_t>(std::max_element(cells.begin(), cells.end()) - cells.begin());
  std::vector<bool> kept(parts.points.size(), false);
  for (std::size_t part = 0; part < kept.size(); ++part) {
    const double apart = (low[part] - high[largest]).cwiseMax(low[largest] - high[part]).maxCoeff();
    if (part != largest && cells[part] > 0.4 * cells[largest] &&
        (high[part] - low[part]).maxCoeff() > 0.35) {
      // Two people are beside each other. If the couch lies above the person, the cloud is mirrored
      // along the line of sight.
      const Vector3 shared = high[part].cwiseMin(high[largest]) - low[part].cwiseMax(low[largest]);
      const Vector3 own = (high[part] - low[part]).cwiseMin(high[largest] - low[largest]);
      if (shared.x() > 0.7 * own.x() && shared.y() > 0.7 * own.y()) {
        return fail(Fault::bad_input,
                    "two large things of {} and {} patches of 3 cm lie over each other: the cloud "
                    "is mirrored along the line of sight",
                    cells[largest], cells[part]);
      }
      return fail(Fault::bad_input,
                  "two people or a second large thing on the couch: {} and {} patches of 3 cm that "
                  "do not hang together",
                  cells[largest], cells[part]);
    }
    kept[part] = part == largest || (apart < gap_m && cells[part] >= 12);
  }
  std::vector<Vector3> person;
  for (const Vector3& p : above) {
    const int voxel = voxels.around(p);
    if (kept[static_cast<std::size_t>(parts.of_voxel[static_cast<std::size_t>(voxel)])])
      person.push_back(p);
  }
  return person;
}

Result<BodyPosture> recognise(const std::vector<Vector3>& person,
                              std::optional<BodyPosture> wanted) {
  const double top = quantile_along(person, 2, 0.98);
  const BodyPosture seen = top > sitting_height_m ? BodyPosture::sitting : BodyPosture::prone;
  if (wanted && *wanted != seen) {
    return fail(
        Fault::bad_input,
        "the person is said to be {}, but reaches {:.0f} mm above the couch; {} is {} {:.0f} mm",
        name_of(*wanted), to_mm(top), *wanted == BodyPosture::sitting ? "sitting" : "lying",
        *wanted == BodyPosture::sitting ? "above" : "below", to_mm(sitting_height_m));
  }
  return seen;
}

/// A lying person is over 0.50 m long and has a round top. Points in their own frame, the long axis
/// along x or y.
Result<void> check_lying(const std::vector<Vector3>& person) {
  double longest = 0.0;
  for (int axis = 0; axis < 2; ++axis) {
    longest = std::max(longest,
                       quantile_along(person, axis, 0.995) - quantile_along(person, axis, 0.005));
  }
  if (longest < min_lying_m) {
    return fail(Fault::not_found, "less than a back: {:.0f} mm of a lying person, {:.0f} needed",
                to_mm(longest), to_mm(min_lying_m));
  }
  // A bed is wide and flat; of a person only a narrow ridge is within a few millimetres of the top.
  const double top = quantile_along(person, 2, 0.995);
  std::vector<Vector3> layer;
  std::copy_if(person.begin(), person.end(), std::back_inserter(layer),
               [&](const Vector3& p) { return p.z() > top - 8_mm; });
  double narrow = std::numeric_limits<double>::max();
  for (int axis = 0; axis < 2; ++axis)
    narrow =
        std::min(narrow, quantile_along(layer, axis, 0.95) - quantile_along(layer, axis, 0.05));
  if (narrow > max_top_m) {
    return fail(Fault::bad_input,
                "the top is flat over {:.0f} mm, {:.0f} allowed: the cloud is mirrored along the "
                "line of sight and the couch hangs over the person",
                to_mm(narrow), to_mm(max_top_m));
  }
  return {};
}

/// Orients normals towards the scanner, whose direction turns with the person.
void turn_normals_out(PointCloud& cloud, BodyPosture position) {
  Vector3 eye = Vector3::Zero();
  for (const Vector3& p : cloud.points) eye += p / static_cast<double>(cloud.size());
  const Vector3 out = position == BodyPosture::prone ? Vector3::UnitZ() : Vector3::UnitY();
  eye += 1.5 * (Eigen::AngleAxisd(heading(cloud, position), Vector3::UnitZ()) * out);
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    if (cloud.normals[i].dot(eye - cloud.points[i]) < 0.0) cloud.normals[i] = -cloud.normals[i];
  }
}

/// Spacing of neighbouring points, from the number of points per occupied area.
double spacing_of(const std::vector<Vector3>& points) {
  constexpr double cube_m = 30_mm;
  const Voxels voxels = gather(points, cube_m);
  const double area = static_cast<double>(voxels.size()) * cube_m * cube_m /
                      1.5;  // a tilted plane meets more cubes
  return std::sqrt(area / static_cast<double>(points.size()));
}

}  // namespace

double heading(const PointCloud& back_in_couch, BodyPosture position) {
  if (position == BodyPosture::prone) {
    // Principal axis seen from above; a lying person is long.
    const Transform own_from_couch = own_frame(back_in_couch.points);
    const double axis = std::atan2(-own_from_couch(0, 1),
                                   own_from_couch(0, 0));  // angle of the long axis against x
    const double turned = std::remainder(-axis - 0.5 * pi, pi);
    // Half a metre of a person with raised arms is wider than long: the bed says what is along.
    double square = 0.0;
    for (const Vector3& p : back_in_couch.points)
      square += std::pow((own_from_couch * p).x(), 2) / static_cast<double>(back_in_couch.size());
    const bool is_long = std::sqrt(square) > min_rms_length_m;
    return is_long || std::abs(turned) < 0.25 * pi ? turned
                                                   : turned - std::copysign(0.5 * pi, turned);
  }
  // Viewing direction of the skin: the mean horizontal normal, weighted by its agreement with that
  // direction, iterated to a fixed point.
  double angle = 0.0;
  for (int round = 0; round < 60; ++round) {
    const Vector2 out(-std::sin(angle), std::cos(angle));
    Vector2 sum = Vector2::Zero();
    for (const Vector3& n : back_in_couch.normals) {
      const double towards = out.dot(n.head<2>());
      sum += towards * std::abs(towards) * std::abs(towards) * n.head<2>();
    }
    const double next = std::atan2(-sum.x(), sum.y());
    if (std::abs(std::remainder(next - angle, 2.0 * pi)) < 1e-12) return next;
    angle = next;
  }
  return angle;
}

Result<BackSurface> fit_back(const PointCloud& scan_in_couch, const BackOptions& options) {
  std::vector<Vector3> finite;
  finite.reserve(scan_in_couch.size());
  for (const Vector3& p : scan_in_couch.points) {
    if (p.allFinite() && p.cwiseAbs().maxCoeff() < 1e6) finite.push_back(p);
  }
  if (finite.size() < enough_points) {
    return fail(Fault::not_found, "no person found: {} of {} points are finite numbers, {} needed",
                finite.size(), scan_in_couch.size(), enough_points);
  }
  if (auto units = check_units(finite); !units) return tl::unexpected(units.error());

  std::vector<Vector3> above;
  above.reserve(finite.size());
  for (const Vector3& p : finite) {
    if (p.z() > couch_m && p.z() < 1.3) above.push_back(p);
  }
  if (above.size() < enough_points) {
    return fail(Fault::not_found, "no person found: {} of {} points are above the couch, {} needed",
                above.size(), finite.size(), enough_points);
  }
  const Transform own_from_couch = own_frame(above);
  for (Vector3& p : above) p = own_from_couch * p;
  drop_strays(above);
  auto person = find_person(above);
  if (!person) return tl::unexpected(person.error());
  if (person->size() < enough_points) {
    return fail(Fault::not_found,
                "no person found: the largest thing on the couch has {} points, {} needed",
                person->size(), enough_points);
  }
  const auto position = recognise(*person, options.position);
  if (!position) return tl::unexpected(position.error());

  if (*position == BodyPosture::prone)
    if (auto whole = check_lying(*person); !whole) return tl::unexpected(whole.error());

  const double spacing_m = std::clamp(1.3 * spacing_of(*person), 6_mm, 15_mm);
  auto thinned = thin_skin(*person, spacing_m);
  if (!thinned) return tl::unexpected(thinned.error());
  PointCloud cloud = std::move(*thinned);
  const Transform couch_from_own = own_from_couch.inverse();
  for (Vector3& p : cloud.points) p = couch_from_own * p;
  for (Vector3& n : cloud.normals) n = couch_from_own.linear() * n;
  turn_normals_out(cloud, *position);
  const double area = static_cast<double>(cloud.size()) * spacing_m * spacing_m / 1.5;
  if (area < 0.10) {
    return fail(Fault::not_found, "less than a back: {:.2f} square metres of skin, 0.10 needed",
                area);
  }
  return BackSurface(std::move(cloud), *position, spacing_m);
}

}  // namespace tuina::body
