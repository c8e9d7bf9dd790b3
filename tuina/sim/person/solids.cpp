// SPDX-License-Identifier: Apache-2.0
#include "tuina/sim/person/solids.hpp"

#include <cmath>

#include "tuina/core/units.hpp"

namespace tuina::sim {

Mesh ball_mesh(const Vector3& centre, double radius_m) {
  constexpr int around = 240;
  constexpr int over = 120;
  Mesh mesh;
  for (int i = 0; i <= over; ++i) {
    const double polar = pi * i / over;
    for (int k = 0; k < around; ++k) {
      const double turn = 2.0 * pi * k / around;
      mesh.vertices.emplace_back(centre + radius_m * Vector3(std::sin(polar) * std::cos(turn),
                                                             std::sin(polar) * std::sin(turn),
                                                             std::cos(polar)));
    }
  }
  for (int i = 0; i < over; ++i) {
    for (int k = 0; k < around; ++k) {
      const int here = i * around + k;
      const int beside = i * around + (k + 1) % around;
      mesh.triangles.push_back({here, here + around, beside});
      mesh.triangles.push_back({beside, here + around, beside + around});
    }
  }
  return mesh;
}

Mesh box_mesh(const Vector3& middle, const Matrix3& turned, const Vector3& size_m) {
  Mesh mesh;
  for (int corner = 0; corner < 8; ++corner) {
    const Vector3 sign((corner & 1) != 0 ? 0.5 : -0.5, (corner & 2) != 0 ? 0.5 : -0.5,
                       (corner & 4) != 0 ? 0.5 : -0.5);
    mesh.vertices.emplace_back(middle + turned * sign.cwiseProduct(size_m));
  }
  constexpr int faces[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4},
                               {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
  for (const auto& f : faces) {
    mesh.triangles.push_back({f[0], f[1], f[2]});
    mesh.triangles.push_back({f[0], f[2], f[3]});
  }
  return mesh;
}

Matrix3 corner_towards_y() {
  return (Eigen::AngleAxisd(-35.0_deg, Vector3::UnitX()) *
          Eigen::AngleAxisd(45.0_deg, Vector3::UnitZ()))
      .toRotationMatrix();
}

}  // namespace tuina::sim
