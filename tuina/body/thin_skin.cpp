// SPDX-License-Identifier: Apache-2.0
#include "tuina/body/thin_skin.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>

#include "tuina/body/voxels.hpp"
#include "tuina/core/units.hpp"

namespace tuina::body {
namespace {

// Laser scans and surfaces leave 0.2 to 0.4 mm; 3 mm of noise along the line of sight, 2 mm.
constexpr double much_noise_m = 1.5_mm;  // median residual of neighbourhoods about their planes
constexpr double share_of_tails = 0.15;

}  // namespace

PointCloud thin_skin(const std::vector<Vector3>& person, double spacing_m) {
  const Voxels voxels = gather(person, spacing_m);

  PointCloud cloud;
  std::vector<double> thickness_m;
  std::vector<double> off_m;  // distance from the plane of the neighbourhood
  std::vector<double> share;  // share of the fullest cube of the neighbourhood
  for (std::size_t i = 0; i < voxels.size(); ++i) {
    const auto& p = voxels.place[i];
    int count = 0;
    int cubes = 0;
    int fullest = 0;
    Vector3 mean = Vector3::Zero();
    std::array<int, 27> near{};
    for (int k = 0; k < 27; ++k) {
      const int j = voxels.at({p[0] + k / 9 - 1, p[1] + k / 3 % 3 - 1, p[2] + k % 3 - 1});
      if (j < 0) continue;
      near[static_cast<std::size_t>(cubes++)] = j;
      count += voxels.count[static_cast<std::size_t>(j)];
      fullest = std::max(fullest, voxels.count[static_cast<std::size_t>(j)]);
      mean += voxels.count[static_cast<std::size_t>(j)] * voxels.mean[static_cast<std::size_t>(j)];
    }
    if (cubes < 4) continue;  // flying pixels have no neighbours
    mean /= count;
    Matrix3 scatter = Matrix3::Zero();
    for (int k = 0; k < cubes; ++k) {
      const auto j = static_cast<std::size_t>(near[static_cast<std::size_t>(k)]);
      const Vector3 offset = voxels.mean[j] - mean;
      scatter += voxels.scatter[j] + voxels.count[j] * offset * offset.transpose();
    }
    Eigen::SelfAdjointEigenSolver<Matrix3> eigen;
    eigen.computeDirect(scatter);
    cloud.points.push_back(voxels.mean[i]);
    cloud.normals.push_back(eigen.eigenvectors().col(0));
    thickness_m.push_back(std::sqrt(std::max(0.0, eigen.eigenvalues()[0]) / count));
    off_m.push_back(cloud.normals.back().dot(voxels.mean[i] - mean));
    share.push_back(static_cast<double>(voxels.count[i]) / fullest);
  }
  if (cloud.size() == 0) return cloud;
  std::vector<double> sorted = thickness_m;
  const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
  std::nth_element(sorted.begin(), middle, sorted.end());
  if (*middle < much_noise_m) return cloud;
  PointCloud smooth;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    if (share[i] < share_of_tails) continue;
    smooth.points.push_back(cloud.points[i] - off_m[i] * cloud.normals[i]);
    smooth.normals.push_back(cloud.normals[i]);
  }
  return smooth;
}

}  // namespace tuina::body
