// SPDX-License-Identifier: Apache-2.0
#include "apps/simulated/bad_scans.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "tuina/core/units.hpp"

namespace tuina::app {
namespace {

using body::LabelledBody;

constexpr double min_wrong_m = 15_mm;

Vector3 at(const LabelledBody& person, std::string_view landmark) {
  for (const Landmark& known : person.landmarks) {
    if (known.name == landmark) return known.at_in_couch;
  }
  return Vector3::Constant(std::nan(""));
}

/// Place on a back: left of the spine, out of the back, and up the spine from the sacrum, where C7
/// is 1.
struct Frame {
  Vector3 origin, left, out, up;
  double spine_m;

  explicit Frame(const LabelledBody& person)
      : origin(at(person, "sacrum_S2")), up(at(person, "C7") - origin), spine_m(up.norm()) {
    up /= spine_m;
    const Vector3 across = at(person, "scapula_root_L") - at(person, "scapula_root_R");
    left = (across - across.dot(up) * up).normalized();
    out = up.cross(left);
    // Person's left, out and up are right-handed in this order: left x out = up.
    if (out.dot(person.position == BodyPosture::sitting ? Vector3::UnitY() : Vector3::UnitZ()) < 0)
      out = -out;
  }
  /// Left and out in metres, up in lengths of the spine.
  [[nodiscard]] Vector3 of(const Vector3& p) const {
    const Vector3 off = p - origin;
    return {off.dot(left), off.dot(out), off.dot(up) / spine_m};
  }
};

double bump(double x) {  // 1 in the middle, smoothly 0 from 1 on
  return std::abs(x) < 1.0 ? std::pow(std::cos(0.5 * pi * x), 2) : 0.0;
}

/// A box on the skin: all points in its outline are as high as its face.
void put_box(LabelledBody& person, double left_m, double up, double half_wide_m, double half_high_m,
             double thick_m) {
  const Frame frame(person);
  const auto inside = [&](const Vector3& q) {
    return std::abs(q.x() - left_m) < half_wide_m &&
           std::abs(q.z() - up) * frame.spine_m < half_high_m;
  };
  double face_m = -1e9;
  for (const Vector3& p : person.scan_in_couch.points) {
    const Vector3 q = frame.of(p);
    if (inside(q)) face_m = std::max(face_m, q.y());
  }
  for (Vector3& p : person.scan_in_couch.points) {
    const Vector3 q = frame.of(p);
    if (inside(q)) p += (face_m + thick_m - q.y()) * frame.out;
  }
}

/// A soft thing that follows the skin and is thickest in its middle; negative: pressed in.
void put_pad(LabelledBody& person, double left_m, double up, double half_wide_m, double half_high_m,
             double thick_m) {
  const Frame frame(person);
  for (Vector3& p : person.scan_in_couch.points) {
    const Vector3 q = frame.of(p);
    p += thick_m *
         std::sqrt(bump((q.x() - left_m) / half_wide_m) *
                   bump((q.z() - up) * frame.spine_m / half_high_m)) *
         frame.out;
  }
}

/// Cloth between two heights, so taut that it bends no more than with this radius, and so thick.
void put_cloth(LabelledBody& person, double from_up, double to_up, double radius_m,
               double thick_m) {
  const Frame frame(person);
  std::vector<Vector3> skin;
  for (const Vector3& p : person.scan_in_couch.points) {
    const Vector3 q = frame.of(p);
    if (q.z() > from_up - 0.1 && q.z() < to_up + 0.1) skin.push_back(q);
  }
  constexpr double reach_m = 90_mm;
  for (Vector3& p : person.scan_in_couch.points) {
    const Vector3 q = frame.of(p);
    if (q.z() < from_up || q.z() > to_up) continue;
    double height_m = q.y();
    for (std::size_t i = 0; i < skin.size(); i += 4) {
      const double across = skin[i].x() - q.x();
      const double along = (skin[i].z() - q.z()) * frame.spine_m;
      const double far2 = across * across + along * along;
      if (far2 < reach_m * reach_m)
        height_m = std::max(height_m, skin[i].y() - far2 / (2.0 * radius_m));
    }
    p += (height_m + thick_m - q.y()) * frame.out;
  }
}

template <typename Hidden>
void hide(LabelledBody& person, const Hidden& hidden) {
  const Frame frame(person);
  std::erase_if(person.scan_in_couch.points,
                [&](const Vector3& p) { return hidden(frame.of(p), frame.spine_m); });
}

/// Moves skin, points and landmarks alike; normals keep.
template <typename Motion>
void move_body(LabelledBody& person, const Motion& motion) {
  for (Vector3& p : person.skin_in_couch.vertices) p = motion(p);
  for (Vector3& p : person.scan_in_couch.points) p = motion(p);
  for (Acupoint& point : person.acupoints) point.at_in_couch = motion(point.at_in_couch);
  for (Landmark& landmark : person.landmarks) landmark.at_in_couch = motion(landmark.at_in_couch);
}

}  // namespace

void bend(LabelledBody& person, double angle_rad) {
  const Frame frame(person);
  move_body(person, [&](const Vector3& p) {
    const Vector3 q = frame.of(p);
    const double share = std::max(0.0, q.z());
    if (share <= 0.0) return p;
    const double turned = angle_rad * std::min(share, 1.1);
    const double radius_m = frame.spine_m / angle_rad;
    const double beyond_m = (share - std::min(share, 1.1)) * frame.spine_m;
    const double left_m =
        radius_m - (radius_m - q.x()) * std::cos(turned) + beyond_m * std::sin(turned);
    const double up_m = (radius_m - q.x()) * std::sin(turned) + beyond_m * std::cos(turned);
    return Vector3(frame.origin + left_m * frame.left + q.y() * frame.out + up_m * frame.up);
  });
}

void twist(LabelledBody& person, double angle_rad) {
  const Frame frame(person);
  move_body(person, [&](const Vector3& p) {
    const double share = std::clamp(frame.of(p).z(), 0.0, 1.0);
    const Vector3 axis = frame.origin - 0.08 * frame.out;
    return Vector3(axis + Eigen::AngleAxisd(share * angle_rad, frame.up) * (p - axis));
  });
}

namespace {

void resize(LabelledBody& person, double scale) {
  move_body(person, [&](const Vector3& p) { return Vector3(scale * p); });
}

/// The same person once more in the scan, moved.
void double_up(LabelledBody& person, double left_m, double up_m, double out_m) {
  const Frame frame(person);
  const std::vector<Vector3> once = person.scan_in_couch.points;
  for (const Vector3& p : once) {
    person.scan_in_couch.points.emplace_back(p + left_m * frame.left + up_m * frame.up +
                                             out_m * frame.out);
  }
}

/// The person moves by this much while the scanner is at this height.
void slip(LabelledBody& person, double at_up, double left_m) {
  const Frame frame(person);
  for (Vector3& p : person.scan_in_couch.points) {
    if (frame.of(p).z() > at_up) p += left_m * frame.left;
  }
}

/// Only so much of the spine's direction is in view, from this far above C7 down.
void only_m(LabelledBody& person, double above_m, double length_m) {
  hide(person, [&](const Vector3& q, double spine_m) {
    const double below_m = above_m - (q.z() - 1.0) * spine_m;
    return below_m < 0.0 || below_m > length_m;
  });
}

constexpr std::array kinds = {
    BadScan{"rucksack, 12 cm", [](LabelledBody& p) { put_box(p, 0.0, 0.62, 0.14, 0.20, 120_mm); }},
    BadScan{"flat rucksack, 5 cm",
            [](LabelledBody& p) { put_box(p, 0.0, 0.62, 0.14, 0.20, 50_mm); }},
    BadScan{"soft rucksack, 10 cm",
            [](LabelledBody& p) { put_pad(p, 0.0, 0.62, 0.18, 0.26, 100_mm); }},
    BadScan{"bag on one shoulder",
            [](LabelledBody& p) { put_box(p, 0.10, 0.75, 0.07, 0.12, 70_mm); }},
    BadScan{"tablet on the loins", [](LabelledBody& p) { put_box(p, 0.0, 0.3, 0.12, 0.09, 8_mm); }},
    BadScan{"pillow on the loins",
            [](LabelledBody& p) { put_pad(p, 0.0, 0.25, 0.25, 0.14, 80_mm); }},
    BadScan{"pillow on neck and shoulders",
            [](LabelledBody& p) { put_pad(p, 0.0, 1.05, 0.30, 0.14, 80_mm); }},
    BadScan{"long hair", [](LabelledBody& p) { put_pad(p, 0.0, 0.95, 0.13, 0.20, 30_mm); }},
    BadScan{"plait along the spine",
            [](LabelledBody& p) { put_pad(p, 0.0, 0.7, 0.035, 0.25, 30_mm); }},
    BadScan{"arm across the loins",
            [](LabelledBody& p) { put_pad(p, 0.0, 0.42, 0.6, 0.05, 75_mm); }},
    BadScan{"arm across the shoulder blades",
            [](LabelledBody& p) { put_pad(p, 0.0, 0.78, 0.6, 0.05, 75_mm); }},
    BadScan{"hand on the back", [](LabelledBody& p) { put_pad(p, 0.06, 0.5, 0.06, 0.1, 30_mm); }},
    BadScan{"coat", [](LabelledBody& p) { put_cloth(p, -1.0, 2.0, 0.30, 15_mm); }},
    BadScan{"padded coat", [](LabelledBody& p) { put_cloth(p, -1.0, 2.0, 0.60, 30_mm); }},
    BadScan{"blanket up to the waist",
            [](LabelledBody& p) { put_cloth(p, -1.0, 0.35, 0.30, 20_mm); }},
    BadScan{"blanket up to the shoulder blades",
            [](LabelledBody& p) { put_cloth(p, -1.0, 0.7, 0.30, 20_mm); }},
    BadScan{"shawl", [](LabelledBody& p) { put_cloth(p, 0.75, 2.0, 0.30, 15_mm); }},
    BadScan{"trousers", [](LabelledBody& p) { put_cloth(p, -1.0, 0.1, 0.20, 6_mm); }},
    BadScan{"towel over the hips", [](LabelledBody& p) { put_cloth(p, -1.0, 0.12, 0.40, 12_mm); }},
    BadScan{"high skirt", [](LabelledBody& p) { put_cloth(p, -1.0, 0.3, 0.60, 8_mm); }},
    BadScan{"elastic band at T9", [](LabelledBody& p) { put_pad(p, 0.0, 0.6, 2.0, 0.03, -10_mm); }},
    BadScan{"elastic band at L3",
            [](LabelledBody& p) { put_pad(p, 0.0, 0.22, 2.0, 0.03, -12_mm); }},
    BadScan{"bent sideways, 15 degrees", [](LabelledBody& p) { bend(p, 15_deg); }},
    BadScan{"bent sideways, 30 degrees", [](LabelledBody& p) { bend(p, 30_deg); }},
    BadScan{"bent sideways, 45 degrees", [](LabelledBody& p) { bend(p, -45_deg); }},
    BadScan{"twisted, 25 degrees", [](LabelledBody& p) { twist(p, 25_deg); }},
    BadScan{"child, three quarters of a phantom", [](LabelledBody& p) { resize(p, 0.75); }},
    BadScan{"giant, six fifths of a phantom", [](LabelledBody& p) { resize(p, 1.2); }},
    BadScan{"hole over the loins",
            [](LabelledBody& p) {
              hide(p, [](const Vector3& q, double) {
                return std::abs(q.x()) < 0.1 && std::abs(q.z() - 0.35) < 0.2;
              });
            }},
    BadScan{
        "left third unseen",
        [](LabelledBody& p) { hide(p, [](const Vector3& q, double) { return q.x() > 0.05; }); }},
    BadScan{"unseen above T5",
            [](LabelledBody& p) { hide(p, [](const Vector3& q, double) { return q.z() > 0.8; }); }},
    BadScan{"unseen below T12",
            [](LabelledBody& p) { hide(p, [](const Vector3& q, double) { return q.z() < 0.4; }); }},
    BadScan{"540 mm in view", [](LabelledBody& p) { only_m(p, 20_mm, 0.54); }},
    BadScan{"450 mm in view", [](LabelledBody& p) { only_m(p, 0.0, 0.45); }},
    BadScan{"somebody else close behind", [](LabelledBody& p) { double_up(p, 0.32, 0.05, 0.03); }},
    BadScan{"moved between two sweeps, 70 mm up",
            [](LabelledBody& p) { double_up(p, 0.0, 70_mm, 0.0); }},
    BadScan{"moved between two sweeps, 30 mm up",
            [](LabelledBody& p) { double_up(p, 0.0, 30_mm, 0.0); }},
    BadScan{"moved between two sweeps, 50 mm aside",
            [](LabelledBody& p) { double_up(p, 50_mm, 0.0, 0.0); }},
    BadScan{"moved between two sweeps, 15 mm out",
            [](LabelledBody& p) { double_up(p, 0.0, 0.0, 15_mm); }},
    BadScan{"moved between two sweeps, 40 mm out",
            [](LabelledBody& p) { double_up(p, 0.0, 0.0, 40_mm); }},
    BadScan{"moved while scanned", [](LabelledBody& p) { slip(p, 0.5, 40_mm); }},
};

}  // namespace

std::span<const BadScan> bad_scans() {
  return kinds;
}

LabelledBody spoilt(LabelledBody person, const BadScan& bad) {
  person.scan_in_couch = body::sample(person.skin_in_couch, 5_mm);
  bad.spoil(person);
  return person;
}

double place_error_m(const Acupoint& found, const Acupoint& truth) {
  Vector3 off = found.at_in_couch - truth.at_in_couch;
  off -= off.dot(truth.normal_in_couch) * truth.normal_in_couch;
  return off.norm();
}

bool wrong_and_sure(const Acupoint& found, const Acupoint& truth) {
  return place_error_m(found, truth) > std::max(min_wrong_m, found.uncertainty_m);
}

}  // namespace tuina::app
