// SPDX-License-Identifier: Apache-2.0
#include "tuina/sim/robot/back_contact.hpp"

#include <doctest/doctest.h>

#include "tests/allocation.hpp"
#include "tuina/core/random.hpp"

using namespace tuina;
using namespace tuina::sim;

namespace {

constexpr TangentTissue bone{.alpha_n = 4.559, .beta_per_m = 263.2};
constexpr TangentTissue soft{.alpha_n = 4.275, .beta_per_m = 143.6};

std::vector<TangentTissue> all(const TangentTissue& tissue, const Mesh& mesh) {
  return std::vector<TangentTissue>(mesh.vertices.size(), tissue);
}

/// A back in front of which the tool stands along y.
BackContact flat_back(const TangentTissue& tissue, const ContactOptions& options = {}) {
  const Mesh mesh = make_patch({});
  return {mesh, all(tissue, mesh), options};
}

/// Where the centre of a 17 mm sphere is that has gone `travel_m` into the flat back.
Vector3 pressed_by(double travel_m) {
  return {0.003, 17_mm - travel_m, 0.002};
}

}  // namespace

TEST_CASE("the closest point of the tree is that of trying all triangles") {
  const Mesh mesh = make_patch({.bend_radius_m = 0.2, .edge_m = 20_mm});
  const ClosestPoint tree(mesh);
  Random random = make_random(1, "points");
  for (int n = 0; n < 500; ++n) {
    const Vector3 point(uniform(random, -0.4, 0.4), uniform(random, -0.3, 0.2),
                        uniform(random, -0.4, 0.4));
    double closest = 1e9;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
      Mesh one;
      for (const int corner : mesh.triangles[t]) {
        one.vertices.push_back(mesh.vertices[static_cast<std::size_t>(corner)]);
      }
      one.triangles.push_back({0, 1, 2});
      closest = std::min(closest, ClosestPoint(one).find(point).distance_m);
    }
    const auto place = tree.find(point, n % static_cast<int>(mesh.triangles.size()));
    CHECK(place.distance_m == doctest::Approx(closest));
    CHECK((point - place.at).norm() == doctest::Approx(place.distance_m));
  }
}

TEST_CASE("tissue and torso share the travel and carry the same force") {
  for (const double travel_m : {1_mm, 4_mm, 7_mm, 12_mm}) {
    BackContact back = flat_back(bone);
    const ContactTruth truth = back.touch(Arm::left, 0.0, pressed_by(travel_m), Vector3::Zero());
    CHECK(truth.force_n > 0.0);
    CHECK(truth.force_n == doctest::Approx(35'000.0 * (travel_m - truth.depth_m)));
    if (truth.force_n < 90.0) {
      CHECK(truth.force_n ==
            doctest::Approx(bone.alpha_n * std::tan(bone.beta_per_m * truth.depth_m)));
    }
    CHECK(truth.normal_in_couch.isApprox(Vector3::UnitY()));
    CHECK(truth.at_in_couch.isApprox(Vector3(0.003, 0.0, 0.002), 1e-9));
  }
}

TEST_CASE(
    "on a rigid torso all travel is depth, and beyond the pole the force stays finite and rises") {
  BackContact back = flat_back(bone, {.torso_n_per_m = rigid});
  double last_n = 0.0;
  for (double travel_m = 0.5_mm; travel_m < 12_mm; travel_m += 0.1_mm) {
    const ContactTruth truth = back.touch(Arm::left, 0.0, pressed_by(travel_m), Vector3::Zero());
    CHECK(truth.depth_m == doctest::Approx(travel_m));
    CHECK(truth.force_n > last_n);
    last_n = truth.force_n;
  }
  CHECK(last_n < 1e5);
}

TEST_CASE("a tool that wanders near and far feels what a tool that was never anywhere else feels") {
  const Mesh mesh = make_patch({.bend_radius_m = 0.3});
  BackContact wandered(mesh, all(soft, mesh));
  Random random = make_random(2, "walk");
  Vector3 centre(0.0, 0.05, 0.0);
  int touches = 0;
  for (int n = 0; n < 2000; ++n) {
    centre += Vector3(gaussian(random, 4_mm), gaussian(random, 4_mm), gaussian(random, 4_mm));
    centre.y() = std::clamp(centre.y(), 5_mm, 80_mm);
    BackContact fresh(mesh, all(soft, mesh));
    const double force_n = wandered.touch(Arm::right, 0.0, centre, Vector3::Zero()).force_n;
    if (n % 20 == 0 || force_n > 0.0) {
      CHECK(force_n ==
            doctest::Approx(fresh.touch(Arm::right, 0.0, centre, Vector3::Zero()).force_n));
    }
    touches += force_n > 0.0 ? 1 : 0;
    if (touches > 60) break;
  }
  CHECK(touches > 20);
}

TEST_CASE("a breath in pushes the tool, by its amplitude half a period on") {
  BackContact back = flat_back(soft, {.torso_n_per_m = rigid, .breathing = {.amplitude_m = 3_mm}});
  CHECK(back.touch(Arm::left, 0.0, pressed_by(2_mm), Vector3::Zero()).depth_m ==
        doctest::Approx(2_mm));
  CHECK(back.touch(Arm::left, 2.0, pressed_by(2_mm), Vector3::Zero()).depth_m ==
        doctest::Approx(5_mm));
  CHECK(back.touch(Arm::left, 4.0, pressed_by(2_mm), Vector3::Zero()).depth_m ==
        doctest::Approx(2_mm));
}

TEST_CASE("a person who moves away takes the contact along, at the speed that was said") {
  BackContact back = flat_back(soft, {.torso_n_per_m = rigid});
  back.add_shift({.start_s = 1.0, .by_in_couch = {0.0, -50_mm, 0.0}, .speed_m_per_s = 0.1});
  CHECK(back.touch(Arm::left, 1.0, pressed_by(6_mm), Vector3::Zero()).force_n > 0.0);
  CHECK(back.touch(Arm::left, 1.05, pressed_by(6_mm), Vector3::Zero()).depth_m ==
        doctest::Approx(1_mm));
  CHECK(back.touch(Arm::left, 1.2, pressed_by(6_mm), Vector3::Zero()).force_n == 0.0);
  CHECK(back.moved_in_couch(9.0).y() == doctest::Approx(-50_mm));
}

TEST_CASE(
    "friction opposes sliding, turns the tool, and is never more than its share of the force") {
  BackContact back = flat_back(soft, {.friction = 0.2});
  const ContactTruth truth = back.touch(Arm::left, 0.0, pressed_by(6_mm), Vector3(0.05, 0.02, 0.0));
  const Vector3 force_n = truth.on_tool_in_couch.force_n;
  CHECK(force_n.y() == doctest::Approx(truth.force_n));
  CHECK(force_n.x() == doctest::Approx(-0.2 * truth.force_n));
  CHECK(truth.on_tool_in_couch.torque_nm.z() == doctest::Approx(11_mm * force_n.x()));
  const ContactTruth still = back.touch(Arm::left, 0.0, pressed_by(6_mm), Vector3::Zero());
  CHECK(still.on_tool_in_couch.force_n.x() == 0.0);
}

TEST_CASE("the tissue under the tool is that of the place") {
  const Mesh mesh = make_patch({});
  std::vector<TangentTissue> tissue;
  for (const Vector3& v : mesh.vertices) tissue.push_back(v.x() > 0.1 ? bone : soft);
  BackContact back(mesh, tissue);
  const Vector3 left(0.15, 10_mm, 0.0), right(-0.15, 10_mm, 0.0);
  CHECK(back.touch(Arm::left, 0.0, left, Vector3::Zero()).tissue.beta_per_m ==
        doctest::Approx(263.2));
  CHECK(back.touch(Arm::right, 0.0, right, Vector3::Zero()).tissue.beta_per_m ==
        doctest::Approx(143.6));
}

TEST_CASE("beside the rim of the skin there is nothing to touch") {
  BackContact back = flat_back(bone);
  CHECK(back.touch(Arm::left, 0.0, Vector3(0.27, -0.05, 0.0), Vector3::Zero()).force_n == 0.0);
  CHECK(back.touch(Arm::left, 0.0, Vector3(0.255, -0.001, 0.0), Vector3::Zero()).force_n == 0.0);
}

TEST_CASE("the contact takes nothing from the heap") {
  BackContact back = flat_back(bone, {.breathing = {.amplitude_m = 3_mm}});
  const auto before = test::allocations();
  double sum_n = 0.0;
  for (int n = 0; n < 100; ++n) {
    sum_n += back.touch(Arm::left, n * 1e-3, pressed_by(n * 0.1_mm), Vector3::UnitX()).force_n;
  }
  CHECK(test::allocations() == before);
  CHECK(sum_n > 0.0);
}
