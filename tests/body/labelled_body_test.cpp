// SPDX-License-Identifier: Apache-2.0
#include "tuina/body/learn/labelled_body.hpp"

#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <filesystem>
#include <string>

#include "apps/simulated/labelled_phantom.hpp"
#include "tests/folder.hpp"
#include "tests/reason.hpp"
#include "tuina/body/atlas.hpp"
#include "tuina/core/units.hpp"

namespace tuina::body {
namespace {

LabelledBody anna() {
  LabelledBody body = app::labelled(sim::make_phantom(sim::draw_phantom(5), BodyPosture::sitting));
  body.id = "anna";
  return body;
}

/// Why the body is refused when it is read from files.
std::string refusal(const LabelledBody& body) {
  const test::Folder folder;
  const std::filesystem::path ply = folder / "anna.ply";
  REQUIRE(write_labelled_body(body, ply));
  return test::reason(read_labelled_body(ply));
}

bool says(const std::string& message, std::string_view words) {
  INFO(message);
  return message.find(words) != std::string::npos;
}

}  // namespace

TEST_CASE("a labelled body is read as it was written") {
  CHECK(refusal(anna()).empty());
}

TEST_CASE("what is sampled of a skin lies within its triangles, no farther apart than asked") {
  const Mesh skin{.vertices = {{0.0, 0.0, 0.0}, {0.1, 0.0, 0.0}, {0.0, 0.05, 0.0}},
                  .triangles = {{0, 1, 2}}};
  const PointCloud cloud = sample(skin, 5_mm);
  CHECK(cloud.points.size() > 100);
  for (const Vector3& point : cloud.points) {
    CHECK(point.z() == 0.0);
    CHECK(point.head<2>().minCoeff() >= 0.0);
    CHECK(point.x() / 0.1 + point.y() / 0.05 <= 1.0 + 1e-9);
    double nearest_m = 1.0;
    for (const Vector3& other : cloud.points)
      if (&other != &point) nearest_m = std::min(nearest_m, (other - point).norm());
    CHECK(nearest_m <= 5_mm);
  }
}

TEST_CASE("a label off the skin is refused with its distance") {
  LabelledBody body = anna();
  body.acupoints[6].at_in_couch.y() += 80_mm;
  CHECK(says(refusal(body), "anna.json: GV4 lies "));
  CHECK(says(refusal(body), "mm off the skin, at most 30 mm are right"));
  body = anna();
  body.landmarks.front().at_in_couch *= 1e3;
  CHECK(says(refusal(body), "is it in millimetres? metres are needed"));
}

TEST_CASE("a body in millimetres and a normal of no length are refused") {
  LabelledBody body = anna();
  for (Vector3& p : body.skin_in_couch.vertices) p *= 1e3;
  CHECK(says(refusal(body), "anna.ply: the skin spans "));
  CHECK(says(refusal(body), "is it in millimetres? metres are needed"));
  body = anna();
  body.acupoints[2].normal_in_couch.setZero();
  CHECK(says(refusal(body), "anna.json: the normal of BL47_L has length 0.00, 1 is needed"));
}

TEST_CASE("normals into the body, swapped sides and a swapped order are refused") {
  const auto at = [](LabelledBody& body, std::string_view name) -> Acupoint& {
    return *std::find_if(body.acupoints.begin(), body.acupoints.end(),
                         [&](const Acupoint& point) { return point.name == name; });
  };
  LabelledBody body = anna();
  at(body, "GV4").normal_in_couch *= -1.0;
  CHECK(says(refusal(body), "the normal of GV4 points into the body"));
  body = anna();
  std::swap(at(body, "SI11_L").at_in_couch, at(body, "SI11_R").at_in_couch);
  CHECK(says(refusal(body), "SI11_L lies to the right of SI11_R"));
  body = anna();
  std::swap(at(body, "BL47_L").at_in_couch, at(body, "BL50_L").at_in_couch);
  CHECK(says(refusal(body), "BL47_L lies below BL50_L"));
  body = anna();
  std::swap(at(body, "GV14").at_in_couch, at(body, "GV4").at_in_couch);
  CHECK(says(refusal(body), "GV14 lies below"));
}

TEST_CASE("bodies with different labels are not learned from together") {
  LabelledBody other = anna();
  other.id = "ben";
  const std::string name = other.acupoints.back().name;
  other.acupoints.pop_back();
  for (const auto& pair : {std::vector{anna(), other}, std::vector{other, anna()}}) {
    const std::string message = test::reason(learn_atlas(pair, nullptr, {}, nullptr));
    CHECK(says(message, "ben lacks " + name + ", which anna has"));
  }
}

TEST_CASE("a copy of a person is refused, also where it was moved and turned") {
  const Eigen::AngleAxisd turn(0.1, Vector3::UnitZ());
  LabelledBody copy = anna();
  copy.id = "berta";
  const auto move = [&](Vector3& at) { at = turn * at + Vector3(20_mm, -10_mm, 0.0); };
  for (Vector3& at : copy.skin_in_couch.vertices) move(at);
  for (Landmark& landmark : copy.landmarks) move(landmark.at_in_couch);
  for (Acupoint& point : copy.acupoints) {
    move(point.at_in_couch);
    point.normal_in_couch = turn * point.normal_in_couch;
  }
  const std::string message =
      test::reason(learn_atlas(std::vector{anna(), copy}, nullptr, {}, nullptr));
  CHECK(says(message, "berta: its labels are those of anna"));
}

TEST_CASE(
    "a mesh that nobody has looked at gives no more points than are borne, the skin all of its "
    "own") {
  Mesh mesh;
  mesh.vertices = {{0, 0, 0}, {20, 0, 0}, {0, 20, 0}, {0, 0, 1}, {0.02, 0, 1}, {0, 0.02, 1}};
  mesh.triangles = {{0, 1, 2}, {3, 4, 5}};
  CHECK(sample(mesh, 5_mm).size() > 20'000);
  const PointCloud bounded = sample(mesh, 5_mm, 2'000);
  CHECK(bounded.size() < 2'010);
  CHECK(std::ranges::count_if(bounded.points, [](const Vector3& p) { return p.z() > 0.5; }) ==
        3 + 21);
}

}  // namespace tuina::body
