// SPDX-License-Identifier: Apache-2.0
#include "tuina/scanner/check/check_box.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "tests/reason.hpp"
#include "tuina/core/random.hpp"
#include "tuina/core/units.hpp"

using namespace tuina;
using namespace tuina::scanner;

namespace {

const Vector3 thesis_box_m(150.0_mm, 150.0_mm, 200.0_mm);

// A box tipped onto a corner over a table, seen along -z in columns 4 mm and rows 1 mm apart.
PointCloud box_on_table(const Matrix3& turned, const Vector3& size_m = thesis_box_m,
                        bool table = true, double noise_m = 0.3_mm) {
  Random random = make_random(5, "box on a table");
  const Vector3 middle(0.02, -0.3, 0.2);
  PointCloud cloud;
  for (double x = -0.3; x < 0.3; x += 4.0_mm) {
    for (double y = -0.6; y < 0.0; y += 1.0_mm) {
      // Where the ray down at (x, y) enters the box, and through which face.
      const Vector3 from = turned.transpose() * (Vector3(x, y, 1.0) - middle);
      const Vector3 down = turned.transpose() * -Vector3::UnitZ();
      double enters_m = -INFINITY;
      double leaves_m = INFINITY;
      Eigen::Index face = 0;
      for (Eigen::Index k = 0; k < 3; ++k) {
        const double near_m = (-std::copysign(0.5 * size_m(k), down(k)) - from(k)) / down(k);
        const double far_m = (std::copysign(0.5 * size_m(k), down(k)) - from(k)) / down(k);
        if (near_m > enters_m) {
          enters_m = near_m;
          face = k;
        }
        leaves_m = std::min(leaves_m, far_m);
      }
      const bool hit = enters_m < leaves_m;
      if (!hit && !table) continue;
      const double z = hit ? 1.0 - enters_m : 0.0;
      const Vector3 normal =
          hit ? Vector3(-std::copysign(1.0, down(face)) * turned.col(face)) : Vector3::UnitZ();
      if (normal.z() < 0.15) continue;
      cloud.points.emplace_back(x, y, z + gaussian(random, noise_m));
      cloud.normals.push_back(normal);
    }
  }
  return cloud;
}

Matrix3 turned(double about_x_rad, double about_y_rad, double about_z_rad) {
  return (Eigen::AngleAxisd(about_x_rad, Vector3::UnitX()) *
          Eigen::AngleAxisd(about_y_rad, Vector3::UnitY()) *
          Eigen::AngleAxisd(about_z_rad, Vector3::UnitZ()))
      .toRotationMatrix();
}

const Matrix3 corner_up = turned(40.0_deg, 30.0_deg, 10.0_deg);

}  // namespace

TEST_CASE("a box on a corner shows its three edges and three right angles") {
  for (const double turn : {0.0_deg, 25.0_deg, 70.0_deg}) {
    CAPTURE(turn);
    const auto box = check_box(box_on_table(turned(0.0, 0.0, turn) * corner_up), thesis_box_m);
    REQUIRE_MESSAGE(box.has_value(), test::reason(box));
    CHECK(std::abs(box->edges_m[0] - 150.0_mm) < 1.5_mm);
    CHECK(std::abs(box->edges_m[1] - 150.0_mm) < 1.5_mm);
    CHECK(std::abs(box->edges_m[2] - 200.0_mm) < 1.5_mm);
    REQUIRE(box->angles_rad.size() == 3);
    for (const double angle_rad : box->angles_rad) {
      CHECK(std::abs(to_deg(angle_rad) - 90.0) < 0.3);
    }
    CHECK(box->flatness_m < 0.4_mm);
  }
}

TEST_CASE("two faces of a box are enough for its size") {
  const auto box = check_box(box_on_table(turned(0.0, 45.0_deg, 0.0)), thesis_box_m);
  REQUIRE_MESSAGE(box.has_value(), test::reason(box));
  CHECK(box->angles_rad.size() == 1);
  // The faces end beside a column, and the next is 5.7 mm farther on them.
  CHECK(box->border_m < 3.0_mm);
  for (std::size_t k = 0; k < 3; ++k) {
    const double wanted_m = thesis_box_m(static_cast<Eigen::Index>(k));
    CHECK(std::abs(box->edges_m[k] - wanted_m) < box->border_m + 0.3_mm);
  }
}

TEST_CASE("a scan in another scale, askew, inside out, or without the box is refused") {
  const PointCloud good = box_on_table(corner_up);
  PointCloud large = good;
  for (Vector3& point : large.points) point *= 1.05;
  CHECK(std::abs(find_box(large, thesis_box_m)->edges_m[2] - 210.0_mm) < 2.0_mm);
  CHECK(check_box(large, thesis_box_m).error().message.find("scale") != std::string::npos);

  // A light plane that is wrong shears the scene.
  PointCloud askew = good;
  for (Vector3& point : askew.points) point.z() += 0.15 * point.x();
  CHECK(check_box(askew, thesis_box_m).error().message.find("degrees") != std::string::npos);

  PointCloud hollow = box_on_table(corner_up, thesis_box_m, false);
  for (Vector3& point : hollow.points) point.z() = -point.z();
  for (Vector3& normal : hollow.normals) normal = Vector3(-normal.x(), -normal.y(), normal.z());
  CHECK(check_box(hollow, thesis_box_m).error().message.find("hollow") != std::string::npos);

  CHECK(check_box(good, {0.4, 0.4, 0.5}).error().fault == Fault::not_found);
  CHECK(check_box(PointCloud{}, thesis_box_m).error().fault == Fault::not_found);
}
