// SPDX-License-Identifier: Apache-2.0
#include "tuina/robot/table/urdf_rows.hpp"

#include <fmt/format.h>

#include <cmath>

#include "tuina/core/units.hpp"

namespace tuina::robot {

void CarriedMass::add(double mass_kg, const Vector3& centre, const Matrix3& about_centre) {
  kg += mass_kg;
  moment += mass_kg * centre;
  about_origin += about_centre + mass_kg * (centre.squaredNorm() * Matrix3::Identity() -
                                            centre * centre.transpose());
}

namespace {

/// Without what rounding leaves of a value that is none: of angles, of lengths in metres, and of
/// others beside the largest of their kind.
double cleaned(double value, double largest = 1.0) {
  return std::abs(value) < 1e-12 * largest ? 0.0 : value;
}

Matrix3 cleaned(const Matrix3& turn) {
  return turn.unaryExpr([](double value) { return cleaned(value); });
}

/// Signed angle about `axis` that turns `from` into `to`, both across it.
double angle_about(const Vector3& axis, const Vector3& from, const Vector3& to) {
  return std::atan2(axis.dot(from.cross(to)), from.dot(to));
}

/// Frame of the next joint on its axis: x along the common normal of both axes, out of this one.
/// Where the axes meet or are parallel, the file's own place of the next joint decides.
Transform next_frame(const Transform& here, const Vector3& next_at, const Vector3& next_axis) {
  const Vector3 z = here.linear().col(2), apart = next_at - here.translation();
  constexpr double parallel = 1e-7, meets_m = 1e-7;
  const Vector3 across = z.cross(next_axis);
  const double sine = across.norm();
  Vector3 x = across, origin = next_at;
  if (sine < parallel) {
    const Vector3 aside = apart - apart.dot(z) * z;
    x = aside.norm() > meets_m ? aside : Vector3(here.linear().col(0));
  } else {
    // Where the common normal meets the next axis.
    const Vector3 normal = across / sine;
    const double along_next = z.cross(normal).dot(apart) / sine;
    origin = next_at + along_next * next_axis;
    const double distance_m = normal.dot(apart);
    if (distance_m < -meets_m) x = -x;
  }
  Transform next = Transform::Identity();
  next.translation() = origin;
  next.linear().col(2) = next_axis;
  next.linear().col(0) = (x - x.dot(next_axis) * next_axis).normalized();
  next.linear().col(1) = next_axis.cross(next.linear().col(0));
  return next;
}

/// The row between two frames whose x axis of the second crosses z of the first at a right angle.
void set_row(Link& link, const Transform& here, const Transform& next) {
  const Vector3 z = here.linear().col(2), x = next.linear().col(0);
  const Vector3 apart = next.translation() - here.translation();
  link.offset_rad = cleaned(angle_about(z, here.linear().col(0), x));
  link.d_m = cleaned(apart.dot(z));
  link.a_m = cleaned(apart.dot(x));
  link.alpha_rad = cleaned(angle_about(x, z, next.linear().col(2)));
}

/// The last row leads to the tip's place; its turn is the tool's own.
Transform last_frame(const Transform& here, const Transform& tip) {
  const Vector3 z = here.linear().col(2);
  const Vector3 apart = tip.translation() - here.translation();
  const Vector3 aside = apart - apart.dot(z) * z;
  Transform last = here;
  last.translation() = tip.translation();
  if (aside.norm() > 1e-7) {
    last.linear().col(0) = aside.normalized();
    last.linear().col(1) = z.cross(last.linear().col(0));
  }
  return last;
}

void set_mass(Link& link, const CarriedMass& mass, const Transform& joint) {
  link.mass_kg = mass.kg;
  if (!(mass.kg > 0.0)) return;
  const Vector3 centre = mass.moment / mass.kg;
  const Matrix3 about_centre =
      mass.about_origin -
      mass.kg * (centre.squaredNorm() * Matrix3::Identity() - centre * centre.transpose());
  const Vector3 com = joint.inverse() * centre;
  const Matrix3 inertia = joint.linear().transpose() * about_centre * joint.linear();
  link.com_in_joint = {cleaned(com.x()), cleaned(com.y()), cleaned(com.z())};
  link.inertia_kg_m2 = {inertia(0, 0), inertia(1, 1), inertia(2, 2)};
  link.inertia_products_kg_m2 = {cleaned(inertia(0, 1), inertia.trace()),
                                 cleaned(inertia(0, 2), inertia.trace()),
                                 cleaned(inertia(1, 2), inertia.trace())};
}

/// Turns axes that are parallel but for the rounding of their angles, as 3.1416 for pi, along the
/// one before: their common normal would lie kilometres away. Each still goes through its place.
/// Says which they were.
std::string straighten(std::vector<TurningJoint>& chain) {
  constexpr double exact = 1e-7, max_sine = 1e-4;
  std::string pairs;
  Vector3 before = chain.front().axis;  // as it stands in the file
  for (std::size_t i = 1; i < chain.size(); ++i) {
    const Vector3 given = chain[i].axis, straight = chain[i - 1].axis;
    const double sine = before.cross(given).norm();
    const bool follows = straight != before;
    if (sine < max_sine && (sine >= exact || follows)) {
      chain[i].axis = before.dot(given) > 0.0 ? straight : Vector3(-straight);
      if (sine >= exact)
        pairs += fmt::format("{}{} and {} are {:.5f}", pairs.empty() ? "" : ", ", i, i + 1,
                             to_deg(std::asin(sine)));
    }
    before = given;
  }
  if (pairs.empty()) return {};
  return fmt::format("joints {} degrees from parallel: taken as parallel", pairs);
}

}  // namespace

UrdfArm arm_of(std::vector<TurningJoint> chain, const Transform& tip) {
  UrdfArm arm;
  arm.note = straighten(chain);
  arm.table.joints = static_cast<int>(chain.size());
  arm.table.tool_mass_kg = 0.16;
  Transform here = Transform::Identity();
  // Frame 0 is on the first axis, nearest to the base link's origin, x as nearly as can be its x.
  const Vector3 axis = chain.front().axis;
  here.translation() = chain.front().at - chain.front().at.dot(axis) * axis;
  const Vector3 ahead = Vector3::UnitX() - axis.x() * axis;
  here.linear().col(2) = axis;
  here.linear().col(0) = ahead.norm() > 1e-3 ? Vector3(ahead.normalized()) : axis.unitOrthogonal();
  here.linear().col(1) = axis.cross(here.linear().col(0));
  arm.link_from_shoulder = here;
  arm.link_from_shoulder.linear() = cleaned(here.linear());
  for (std::size_t i = 0; i < chain.size(); ++i) {
    Link& link = arm.table.links[i];
    link = chain[i].link;
    link.radius_m = 50_mm;
    const Transform next = i + 1 < chain.size()
                               ? next_frame(here, chain[i + 1].at, chain[i + 1].axis)
                               : last_frame(here, tip);
    set_row(link, here, next);
    set_mass(link, chain[i].mass, here * Eigen::AngleAxisd(link.offset_rad, Vector3::UnitZ()));
    here = next;
  }
  const Matrix3 turn = cleaned(here.linear().transpose() * tip.linear());
  if (!turn.isIdentity(1e-12)) arm.table.end_from_tool_turn = turn;
  return arm;
}

}  // namespace tuina::robot
