// SPDX-License-Identifier: Apache-2.0
#include "tuina/sim/person/phantom.hpp"

#include <algorithm>
#include <cmath>
#include <functional>

#include "tuina/core/random.hpp"
#include "tuina/core/units.hpp"
#include "tuina/sim/person/phantom_form.hpp"
#include "tuina/sim/person/phantom_points.hpp"

namespace tuina::sim {
namespace {

double score(Random& random) {
  return std::clamp(gaussian(random, 1.0), -2.5, 2.5);
}

/// Heights of young adults, 1.72 m and 1.60 m, standard deviation 6 cm, as the people of
/// models/phantom.csv (worldwide means of men and women born in 1996: 1.71 m and 1.59 m
/// [ncdrisc2016]).
PhantomShape draw(double lowest_bmi, double highest_bmi, std::uint64_t seed) {
  Random random = make_random(seed, "phantom");
  PhantomShape shape;
  shape.seed = seed;
  shape.bmi = uniform(random, lowest_bmi, highest_bmi);
  shape.woman = uniform(random, 0.0, 1.0) < 0.5;
  shape.height_m = (shape.woman ? 1.60 : 1.72) + 0.06 * score(random);
  shape.arms_up = uniform(random, 0.0, 1.0) < 0.4;
  for (double& way : shape.build) way = score(random);
  for (double& way : shape.posture) way = score(random);
  return shape;
}

/// Visibility from a camera behind (sitting) or above (prone), cut off at the seat, the thighs and
/// the elbows.
std::vector<double> seen_from_behind(const Mesh& body, const PhantomForm& form,
                                     const PhantomPose& pose, const Mesh& posed) {
  // The labelled bodies end where the normal turns away this far.
  constexpr double slightly_from_the_side = 0.36;
  std::vector<Vector3> normals(posed.vertices.size(), Vector3::Zero());
  for (const auto& [a, b, c] : posed.triangles) {
    const auto at = [&](int i) { return posed.vertices[static_cast<std::size_t>(i)]; };
    const Vector3 normal = (at(b) - at(a)).cross(at(c) - at(a));
    for (const int i : {a, b, c}) normals[static_cast<std::size_t>(i)] += normal;
  }
  std::vector<double> seen(posed.vertices.size());
  for (std::size_t i = 0; i < seen.size(); ++i) {
    const double facing =
        normals[i].normalized()[back_axis(pose.position)] + slightly_from_the_side;
    const Vector3& at = body.vertices[i];
    // Prone, the surface ends above the bed and, rounded towards the hips, below the buttocks.
    const double aside = at.x() / form.length_m();
    const double above_seat =
        pose.position == BodyPosture::sitting
            ? posed.vertices[i].z() - 70_mm
            : std::min(posed.vertices[i].z() - 10_mm,
                       at.z() + form.length_m() * (0.35 - 1.1 * aside * aside));
    const double ends = std::min(above_seat, form.before_elbow(at));
    seen[i] = std::min(facing * 0.05, ends);
  }
  return seen;
}

}  // namespace

PhantomShape draw_phantom(BodyType type, std::uint64_t seed) {
  switch (type) {
    case BodyType::slim:
      return draw(16.0, 18.4, seed);
    case BodyType::medium:
      return draw(18.6, 24.9, seed);
    case BodyType::hefty:
      break;
  }
  return draw(25.1, 33.0, seed);
}

PhantomShape draw_phantom(std::uint64_t seed) {
  return draw(16.0, 34.0, seed);
}

Person make_phantom(const PhantomShape& shape, BodyPosture position) {
  constexpr double cell_m = 7_mm;
  const Proportions proportions = proportions_of(shape, position);
  const double length_m = proportions.of[trunk_length] * shape.height_m;
  const PhantomPose pose = pose_of(shape, position, length_m);
  const PhantomForm form(proportions, shape, pose);

  Person person;
  person.position = position;
  person.body_type = body_type_of(shape.bmi);
  person.name =
      fmt::format("phantom_{}_{}_{}", name_of(person.body_type), name_of(position), shape.seed);
  person.woman = shape.woman;
  person.height_m = shape.height_m;
  person.bmi = shape.bmi;
  person.three_cun_m = proportions.of[three_cun] * length_m;

  const Mesh body = polygonise(std::cref(form), form.box(), cell_m);
  Mesh posed = body;
  for (Vector3& vertex : posed.vertices) vertex = pose.couch_from_trunk(vertex);
  person.skin_in_couch = cut(posed, seen_from_behind(body, form, pose, posed));
  mark_points(proportions, form, pose, shape.arms_up && position == BodyPosture::prone, person);
  return person;
}

}  // namespace tuina::sim
