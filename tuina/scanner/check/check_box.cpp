// SPDX-License-Identifier: Apache-2.0
#include "tuina/scanner/check/check_box.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <optional>

#include "tuina/core/units.hpp"
#include "tuina/scanner/check/box_faces.hpp"

namespace tuina::scanner {
namespace {

// Largest deviation from the right angle between two faces.
constexpr double upright_rad = 20.0_deg;
constexpr double inside_m = 5.0_mm;
constexpr double max_strips = 40.0;
constexpr double points_of_strip = 15.0;
constexpr double allowed_m = 2.0_mm;
constexpr double allowed_share = 0.01;
constexpr double allowed_rad = 2.0_deg;

using Faces = std::vector<const Face*>;

// True when two faces meet in an edge of a box seen from outside, or of a hollow one.
bool meet(const Face& a, const Face& b, double diagonal_m, bool hollow) {
  if (std::abs(a.normal.dot(b.normal)) > std::sin(upright_rad)) return false;
  if ((a.middle - b.middle).norm() > diagonal_m) return false;
  const double side = hollow ? 1.0 : -1.0;
  return side * a.out_m(b.middle) > inside_m && side * b.out_m(a.middle) > inside_m;
}

// Prefers three faces that meet to two, then more points.
Faces choose(const std::vector<Face>& faces, double diagonal_m, bool hollow) {
  const auto count = [](const Faces& chosen) {
    std::size_t points = 0;
    for (const Face* face : chosen) points += face->points.size();
    return points;
  };
  Faces best;
  const auto consider = [&](Faces chosen) {
    const bool better =
        chosen.size() != best.size() ? chosen.size() > best.size() : count(chosen) > count(best);
    if (better) best = std::move(chosen);
  };
  for (std::size_t i = 0; i < faces.size(); ++i) {
    for (std::size_t j = i + 1; j < faces.size(); ++j) {
      if (!meet(faces[i], faces[j], diagonal_m, hollow)) continue;
      consider({&faces[i], &faces[j]});
      for (std::size_t k = j + 1; k < faces.size(); ++k) {
        if (meet(faces[i], faces[k], diagonal_m, hollow) &&
            meet(faces[j], faces[k], diagonal_m, hollow)) {
          consider({&faces[i], &faces[j], &faces[k]});
        }
      }
    }
  }
  return best;
}

// Edges of the box as axes: axis k is the edge of the two other faces. Origin: the common corner,
// or any point of the only visible edge.
struct Axes {
  Matrix3 from_box = Matrix3::Identity();  // columns are unit
  Vector3 corner = Vector3::Zero();
};

Axes axes_of(const Faces& faces, bool hollow) {
  Matrix3 normals;
  Vector3 offsets;
  for (Eigen::Index k = 0; k < 2; ++k) {
    normals.row(k) = faces[static_cast<std::size_t>(k)]->normal;
    offsets(k) = faces[static_cast<std::size_t>(k)]->offset_m;
  }
  if (faces.size() == 3) {
    normals.row(2) = faces[2]->normal;
    offsets(2) = faces[2]->offset_m;
  } else {
    normals.row(2) = faces[0]->normal.cross(faces[1]->normal).normalized();
    offsets(2) = normals.row(2).dot(faces[0]->middle);
  }
  Axes axes;
  axes.corner = normals.inverse() * offsets;
  for (Eigen::Index k = 0; k < 3; ++k) {
    const Vector3 edge =
        normals.row((k + 1) % 3).cross(normals.row((k + 2) % 3)).normalized().transpose();
    const double side = edge.dot(normals.row(k)) * (hollow ? -1.0 : 1.0);
    axes.from_box.col(k) = side > 0.0 ? Vector3(-edge) : edge;
  }
  return axes;
}

// Extent of a face along an axis: mean end of its points in strips, plus half a gap, since the
// border lies between the last point and the next.
struct Reach {
  double to_m = 0.0;
  double gap_m = 0.0;  // half the point spacing
};

double median_of(std::vector<double>& values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

Reach reach_of(const std::vector<Vector3>& in_box, Eigen::Index along, Eigen::Index across,
               double sign) {
  double low = INFINITY;
  double high = -INFINITY;
  for (const Vector3& point : in_box) {
    low = std::min(low, point(across));
    high = std::max(high, point(across));
  }
  const double count =
      std::clamp(static_cast<double>(in_box.size()) / points_of_strip, 5.0, max_strips);
  std::vector<std::vector<double>> strips(static_cast<std::size_t>(count));
  for (const Vector3& point : in_box) {
    const double share = (point(across) - low) / std::max(1e-9, high - low);
    if (share < 0.1 || share > 0.9) continue;  // corners are frayed
    strips[static_cast<std::size_t>(share * (static_cast<double>(strips.size()) - 0.5))].push_back(
        sign * point(along));
  }
  std::vector<double> ends;
  std::vector<double> gaps;
  for (auto& strip : strips) {
    if (strip.size() < 5) continue;
    std::sort(strip.begin(), strip.end());
    double sum = 0.0;
    double sum2 = 0.0;
    for (std::size_t i = 1; i < strip.size(); ++i) {
      const double gap = strip[i] - strip[i - 1];
      sum += gap;
      sum2 += gap * gap;
    }
    ends.push_back(strip.back());
    gaps.push_back(0.5 * sum2 / std::max(1e-9, sum));
  }
  if (ends.size() < 3) return {.to_m = 0.0, .gap_m = INFINITY};
  const double gap_m = median_of(gaps);
  return {.to_m = median_of(ends) + gap_m, .gap_m = gap_m};
}

// Length of an edge, from both adjacent faces, weighted by their point density.
Reach length_of(const std::vector<std::vector<Vector3>>& in_box, Eigen::Index along) {
  double sum = 0.0;
  double weights = 0.0;
  for (std::size_t face = 0; face < in_box.size(); ++face) {
    const auto of_face = static_cast<Eigen::Index>(face);
    if (of_face == along) continue;
    const Eigen::Index across = 3 - along - of_face;
    Reach far = reach_of(in_box[face], along, across, 1.0);
    // The edge between the only two visible faces ends freely on both sides.
    if (static_cast<std::size_t>(along) >= in_box.size()) {
      far.to_m += reach_of(in_box[face], along, across, -1.0).to_m;
    }
    if (!std::isfinite(far.gap_m)) continue;
    const double weight = 1.0 / std::max(1e-9, far.gap_m * far.gap_m);
    sum += weight * far.to_m;
    weights += weight;
  }
  if (weights == 0.0) return {};
  return {.to_m = sum / weights, .gap_m = 1.0 / std::sqrt(weights)};
}

FoundBox measure(const Faces& faces, const Vector3& size_m, bool hollow) {
  FoundBox box{.angles_rad = {}, .hollow = hollow};
  const Axes axes = axes_of(faces, hollow);
  const Matrix3 box_from = axes.from_box.inverse();
  std::vector<std::vector<Vector3>> in_box;
  double squares = 0.0;
  for (const Face* face : faces) {
    auto& points = in_box.emplace_back();
    for (const Vector3& point : face->points) points.emplace_back(box_from * (point - axes.corner));
    squares += face->rms_m * face->rms_m * static_cast<double>(face->points.size());
    box.points += face->points.size();
  }
  box.flatness_m = std::sqrt(squares / static_cast<double>(box.points));
  std::array<double, 3> lengths_m{};
  for (Eigen::Index k = 0; k < 3; ++k) {
    const Reach length = length_of(in_box, k);
    lengths_m[static_cast<std::size_t>(k)] = length.to_m;
    box.border_m = std::max(box.border_m, length.gap_m);
  }
  // The edges are assigned to the nominal size by the best fit.
  std::array<std::size_t, 3> order = {0, 1, 2};
  double least = INFINITY;
  do {
    double worst = 0.0;
    for (std::size_t k = 0; k < 3; ++k) {
      const double wanted_m = size_m(static_cast<Eigen::Index>(k));
      worst = std::max(worst, std::abs(lengths_m[order[k]] / wanted_m - 1.0));
    }
    if (worst < least) {
      least = worst;
      for (std::size_t k = 0; k < 3; ++k) box.edges_m[k] = lengths_m[order[k]];
    }
  } while (std::next_permutation(order.begin(), order.end()));
  for (std::size_t i = 0; i < faces.size(); ++i) {
    for (std::size_t j = i + 1; j < faces.size(); ++j) {
      const double cosine = faces[i]->normal.dot(faces[j]->normal);
      // Faces whose normals differ by more than 90 degrees meet at less.
      box.angles_rad.push_back(pi - std::acos(std::clamp(cosine, -1.0, 1.0)));
    }
  }
  return box;
}

std::string told(const Vector3& size_m) {
  return fmt::format("{:.0f} x {:.0f} x {:.0f} mm", to_mm(size_m.x()), to_mm(size_m.y()),
                     to_mm(size_m.z()));
}

}  // namespace

Result<FoundBox> find_box(const PointCloud& cloud, const Vector3& size_m) {
  const double diagonal_m = size_m.norm();
  // Searches up to twice the size, so that a wrong scale is found and reported.
  const auto faces = find_faces(cloud, 2.0 * diagonal_m);
  for (const bool hollow : {false, true}) {
    const Faces chosen = choose(faces, 2.0 * diagonal_m, hollow);
    if (chosen.empty()) continue;
    FoundBox box = measure(chosen, size_m, hollow);
    bool about = true;
    for (std::size_t k = 0; k < 3; ++k) {
      const double ratio = box.edges_m[k] / size_m(static_cast<Eigen::Index>(k));
      about = about && ratio > 0.5 && ratio < 2.0;
    }
    if (about) return box;
  }
  return fail(Fault::not_found,
              "no box of about {} is found among {} points; stand it with an edge or a corner "
              "towards the scanner, two or three faces in view, nothing within a hand's breadth",
              told(size_m), cloud.size());
}

Result<FoundBox> check_box(const PointCloud& cloud, const Vector3& size_m) {
  auto box = find_box(cloud, size_m);
  if (!box) return box;
  if (box->hollow) {
    return fail(Fault::bad_input,
                "the box of {} comes out hollow: a sign of the calibration is wrong; are the "
                "pictures mirrored?",
                told(size_m));
  }
  for (const double angle_rad : box->angles_rad) {
    if (std::abs(angle_rad - 0.5 * pi) > allowed_rad) {
      return fail(Fault::bad_input,
                  "two faces of the box meet at {:.1f} degrees instead of 90: light plane, yaw "
                  "axis or sign of the yaw are wrong in the calibration",
                  to_deg(angle_rad));
    }
  }
  for (std::size_t k = 0; k < 3; ++k) {
    const double wanted_m = size_m(static_cast<Eigen::Index>(k));
    const double off_m = std::abs(box->edges_m[k] - wanted_m);
    if (off_m > std::max(allowed_m, allowed_share * wanted_m) + box->border_m) {
      return fail(Fault::bad_input,
                  "the box of {} measures {:.1f} x {:.1f} x {:.1f} mm: the scale of the "
                  "calibration is wrong; is square_m in board.toml right?",
                  told(size_m), to_mm(box->edges_m[0]), to_mm(box->edges_m[1]),
                  to_mm(box->edges_m[2]));
    }
  }
  return box;
}

}  // namespace tuina::scanner
