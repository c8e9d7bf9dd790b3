// SPDX-License-Identifier: Apache-2.0
#include "apps/tuina/mount/plate.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "tuina/core/units.hpp"

namespace tuina::app {
namespace {

constexpr int sides = 48;  // of a round hole

double cross(const Vector2& a, const Vector2& b, const Vector2& c) {
  return (b.x() - a.x()) * (c.y() - a.y()) - (b.y() - a.y()) * (c.x() - a.x());
}

double signed_area_m2(const Outline& outline) {
  double sum = 0.0;
  for (std::size_t i = 0; i < outline.size(); ++i) {
    const Vector2& a = outline[i];
    const Vector2& b = outline[(i + 1) % outline.size()];
    sum += a.x() * b.y() - a.y() * b.x();
  }
  return 0.5 * sum;
}

/// Whether two segments have a point in common.
bool touches(const Vector2& a, const Vector2& b, const Vector2& c, const Vector2& d) {
  const auto on = [](const Vector2& p, const Vector2& q, const Vector2& r) {
    return cross(p, q, r) == 0.0 && (r - p).dot(r - q) <= 0.0;
  };
  return (cross(a, b, c) * cross(a, b, d) < 0.0 && cross(c, d, a) * cross(c, d, b) < 0.0) ||
         on(a, b, c) || on(a, b, d) || on(c, d, a) || on(c, d, b);
}

/// A ring of corners, by their numbers.
using Ring = std::vector<int>;

class Cover {
 public:
  explicit Cover(const Plate& plate) {
    ring_ = add(plate.outline);
    std::vector<Ring> holes;
    holes.reserve(plate.windows.size());
    for (const Outline& window : plate.windows) holes.push_back(add(window));
    // The rightmost first, so that no bridge has to pass over a hole that is not bridged yet.
    std::sort(holes.begin(), holes.end(), [this](const Ring& a, const Ring& b) {
      return at(a[rightmost(a)]).x() > at(b[rightmost(b)]).x();
    });
    for (const Ring& hole : holes) bridge(hole);
    clip_ears();
  }
  Covered covered;

 private:
  [[nodiscard]] const Vector2& at(int corner) const {
    return covered.corners[static_cast<std::size_t>(corner)];
  }
  Ring add(const Outline& outline) {
    Ring ring;
    for (const Vector2& point : outline) {
      ring.push_back(static_cast<int>(covered.corners.size()));
      covered.corners.push_back(point);
    }
    edges_.push_back(ring);
    return ring;
  }
  [[nodiscard]] std::size_t rightmost(const Ring& ring) const {
    std::size_t best = 0;
    for (std::size_t i = 1; i < ring.size(); ++i)
      if (at(ring[i]).x() > at(ring[best]).x()) best = i;
    return best;
  }
  [[nodiscard]] bool sees(int from, int to) const {
    for (const Ring& ring : edges_) {
      for (std::size_t i = 0; i < ring.size(); ++i) {
        const int one = ring[i], other = ring[(i + 1) % ring.size()];
        const bool begins_there = one == from || one == to || other == from || other == to;
        if (!begins_there && touches(at(from), at(to), at(one), at(other))) return false;
      }
    }
    return true;
  }
  /// Whether the ring at its corner i opens towards there; one corner may be in it several times.
  [[nodiscard]] bool opens(std::size_t i, int towards) const {
    const Vector2& before = at(ring_[(i + ring_.size() - 1) % ring_.size()]);
    const Vector2& here = at(ring_[i]);
    const Vector2& after = at(ring_[(i + 1) % ring_.size()]);
    const bool from_before = cross(before, here, at(towards)) > 0.0,
               from_after = cross(here, after, at(towards)) > 0.0;
    return cross(before, here, after) > 0.0 ? from_before && from_after : from_before || from_after;
  }
  /// Makes one ring of two, by a cut to and fro.
  void bridge(const Ring& hole) {
    const std::size_t begin = rightmost(hole);
    std::size_t best = 0;
    double best_m = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < ring_.size(); ++i) {
      const double far_m = (at(ring_[i]) - at(hole[begin])).norm();
      if (far_m < best_m && at(ring_[i]).x() > at(hole[begin]).x() && opens(i, hole[begin]) &&
          sees(hole[begin], ring_[i]))
        best = i, best_m = far_m;
    }
    Ring joined(ring_.begin(), ring_.begin() + static_cast<std::ptrdiff_t>(best) + 1);
    for (std::size_t i = 0; i <= hole.size(); ++i)
      joined.push_back(hole[(begin + i) % hole.size()]);
    joined.insert(joined.end(), ring_.begin() + static_cast<std::ptrdiff_t>(best), ring_.end());
    ring_ = std::move(joined);
  }
  [[nodiscard]] bool is_ear(std::size_t i) const {
    const std::size_t count = ring_.size();
    const std::array<int, 3> ear = {ring_[(i + count - 1) % count], ring_[i],
                                    ring_[(i + 1) % count]};
    if (cross(at(ear[0]), at(ear[1]), at(ear[2])) <= 0.0) return false;
    return std::none_of(ring_.begin(), ring_.end(), [&](int corner) {
      if (std::find(ear.begin(), ear.end(), corner) != ear.end()) return false;
      for (std::size_t k = 0; k < 3; ++k)
        if (cross(at(ear[k]), at(ear[(k + 1) % 3]), at(corner)) < 0.0) return false;
      return true;
    });
  }
  void clip_ears() {
    while (ring_.size() >= 3) {
      std::size_t i = 0;
      while (i < ring_.size() && !is_ear(i)) ++i;
      if (i == ring_.size()) return;  // what is left has no area
      const std::size_t count = ring_.size();
      covered.triangles.push_back(
          {ring_[(i + count - 1) % count], ring_[i], ring_[(i + 1) % count]});
      ring_.erase(ring_.begin() + static_cast<std::ptrdiff_t>(i));
    }
  }

  Ring ring_;
  std::vector<Ring> edges_;
};

}  // namespace

Outline round_hole(const Vector2& at, double diameter_m) {
  // The sides touch the circle, so that no corner is within it.
  const double radius_m = 0.5 * diameter_m / std::cos(pi / sides);
  Outline hole;
  for (int i = 0; i < sides; ++i) {
    const double angle = -2.0 * pi * i / sides;
    hole.emplace_back(at + radius_m * Vector2(std::cos(angle), std::sin(angle)));
  }
  return hole;
}

Outline slot(const Vector2& from, const Vector2& to, double width_m) {
  const Vector2 along = (to - from).normalized(), aside(-along.y(), along.x());
  Outline hole;
  for (const bool far : {true, false}) {
    for (int i = 0; i <= sides / 2; ++i) {
      const double angle = 2.0 * pi * i / sides;
      const Vector2 around = std::cos(angle) * aside + std::sin(angle) * along;
      hole.push_back((far ? to : from) + 0.5 * width_m * (far ? around : Vector2(-around)));
    }
  }
  return hole;
}

Outline rectangular_hole(const Vector2& middle, const Vector2& along, double width_m,
                         double depth_m) {
  const Vector2 half = 0.5 * width_m * along;
  const Vector2 up = 0.5 * depth_m * Vector2(-along.y(), along.x());
  return {middle - half - up, middle - half + up, middle + half + up, middle + half - up};
}

double area_m2(const Plate& plate) {
  double area = signed_area_m2(plate.outline);
  for (const Outline& window : plate.windows) area += signed_area_m2(window);
  return area;
}

Covered cover(const Plate& plate) {
  return Cover(plate).covered;
}

}  // namespace tuina::app
