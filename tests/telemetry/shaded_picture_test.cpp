// SPDX-License-Identifier: Apache-2.0
#include "tuina/telemetry/picture/shaded_picture.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "tuina/core/random.hpp"

using namespace tuina;
using namespace tuina::telemetry;

namespace {

/// A gently domed square of 400 mm in the plane y = 0, seen from +y, as a scanner would give it.
PointCloud domed_scan() {
  PointCloud scan;
  Random random = make_random(7, "domed scan");
  for (double x = -0.2; x <= 0.2; x += 0.002) {
    for (double z = -0.2; z <= 0.2; z += 0.002) {
      scan.points.push_back(Vector3(x, 0.05 * std::cos(6.0 * x) + gaussian(random, 0.0004), z));
    }
  }
  return scan;
}

Scene domed_scene() {
  return {.surface = mesh_scan(domed_scan(), Vector3::UnitY())};
}

const View small = {.width_px = 200, .height_px = 200};

Colour pixel(const ShadedPicture& picture, const Vector3& place) {
  const Vector3 at = picture.projection(place);
  const std::uint8_t* p =
      picture.image.row(static_cast<int>(at.y())) + 3 * static_cast<int>(at.x());
  return {p[0], p[1], p[2]};
}

}  // namespace

TEST_CASE(
    "a scan becomes a mesh that stays within a millimetre of its points, with normals towards the "
    "eye") {
  const PictureMesh mesh = mesh_scan(domed_scan(), Vector3::UnitY());
  REQUIRE(mesh.mesh.triangles.size() > 10000);
  double worst = 0.0;
  for (std::size_t k = 0; k < mesh.mesh.vertices.size(); ++k) {
    if (mesh.inside[k] < 0.99F) continue;
    const Vector3& vertex = mesh.mesh.vertices[k];
    worst = std::max(worst, std::abs(vertex.y() - 0.05 * std::cos(6.0 * vertex.x())));
    CHECK(mesh.normals[k].y() > 0.9);
  }
  CHECK(worst < 0.001);
}

TEST_CASE("a picture shows skin where the surface is and paper where it is not") {
  const ShadedPicture picture = shade(domed_scene(), small);
  CHECK(picture.image.width <= 200);
  CHECK(picture.image.height <= 200);
  const Colour middle = pixel(picture, Vector3(0, 0.05, 0));
  CHECK(middle.red > middle.green);
  CHECK(middle.green > middle.blue);
  const std::uint8_t* corner = picture.image.row(1);
  CHECK(corner[0] == 255);
  CHECK(corner[1] == 255);
  CHECK(corner[2] == 255);
}

TEST_CASE("a bead is seen where the projection says, and not when it is behind the skin") {
  Scene scene = domed_scene();
  scene.beads = {{.at = Vector3(0.05, 0.055, 0.03), .radius_m = 0.01, .colour = {0, 0, 255}},
                 {.at = Vector3(-0.05, -0.1, 0.03), .radius_m = 0.01, .colour = {0, 0, 255}}};
  const ShadedPicture picture = shade(scene, small);
  const Colour front = pixel(picture, scene.beads[0].at);
  CHECK(front.blue > 2 * front.red);
  const Colour hidden = pixel(picture, scene.beads[1].at);
  CHECK(hidden.red > hidden.blue);
}

TEST_CASE("a thread throws a shadow to the right, away from the light") {
  Scene scene = domed_scene();
  scene.threads = {{.points = {Vector3(0, 0.07, -0.1), Vector3(0, 0.07, 0.1)},
                    .radius_m = 0.004,
                    .colour = {255, 255, 255}}};
  const ShadedPicture with = shade(scene, small);
  const ShadedPicture without = shade(domed_scene(), small);
  // Seen from +y with z up, x points to the left of the picture.
  double darkest = 1.0;
  for (double x = -0.06; x < -0.01; x += 0.002) {
    const Vector3 place(x, 0.05, 0.0);
    darkest = std::min(darkest,
                       static_cast<double>(pixel(with, place).green) / pixel(without, place).green);
  }
  CHECK(darkest < 0.85);
}

TEST_CASE("the same scene gives the same picture bit for bit") {
  CHECK(shade(domed_scene(), small).image.data == shade(domed_scene(), small).image.data);
}
