// SPDX-License-Identifier: Apache-2.0
#include "tuina/body/thin_skin.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "tuina/body/voxels.hpp"
#include "tuina/core/units.hpp"

namespace tuina::body {
namespace {

// Laser scans and surfaces leave 0.2 to 0.4 mm; 3 mm of noise along the line of sight, 2 mm.
constexpr double much_noise_m = 1.5_mm;  // median residual of neighbourhoods about their planes
constexpr double share_of_tails = 0.15;
constexpr double min_layer_m = 1_mm;

// Of 24 people of docs/bodies.md, once and with 5 mm of noise, at most 11 % of the skin has skin
// behind it; shown once more 20 to 70 mm away, 22 % and more.
constexpr double share_behind = 0.17, max_behind_m = 60_mm, same_way = 0.8;
// Noise has a kurtosis of 2.6 and more here, two layers that are nearer than 20 mm one below 1.95.
constexpr double min_kurtosis = 2.1;

/// A patch of skin, about a cube that has points.
struct Patch {
  int voxel;
  Vector3 mean, normal;  ///< of the 27 cubes around
  double thickness_m;    ///< standard deviation about the plane
  double share;          ///< of the fullest of them
};

std::vector<Patch> patches_of(const Voxels& voxels) {
  std::vector<Patch> patches;
  for (std::size_t i = 0; i < voxels.size(); ++i) {
    const auto& p = voxels.place[i];
    int count = 0, cubes = 0, fullest = 0;
    Vector3 mean = Vector3::Zero();
    std::array<std::size_t, 27> near{};
    for (int k = 0; k < 27; ++k) {
      const int at = voxels.at({p[0] + k / 9 - 1, p[1] + k / 3 % 3 - 1, p[2] + k % 3 - 1});
      if (at < 0) continue;
      const auto j = static_cast<std::size_t>(at);
      near[static_cast<std::size_t>(cubes++)] = j;
      count += voxels.count[j];
      fullest = std::max(fullest, voxels.count[j]);
      mean += voxels.count[j] * voxels.mean[j];
    }
    if (cubes < 4) continue;  // flying pixels have no neighbours
    mean /= count;
    Matrix3 scatter = Matrix3::Zero();
    for (const std::size_t j : std::span(near).first(static_cast<std::size_t>(cubes))) {
      const Vector3 offset = voxels.mean[j] - mean;
      scatter += voxels.scatter[j] + voxels.count[j] * offset * offset.transpose();
    }
    Eigen::SelfAdjointEigenSolver<Matrix3> eigen;
    eigen.computeDirect(scatter);
    patches.push_back({static_cast<int>(i), mean, eigen.eigenvectors().col(0),
                       std::sqrt(std::max(0.0, eigen.eigenvalues()[0]) / count),
                       static_cast<double>(voxels.count[i]) / fullest});
  }
  return patches;
}

/// Patches by the cube they are about; null where a cube has none.
std::vector<const Patch*> by_voxel(const std::vector<Patch>& patches, const Voxels& voxels) {
  std::vector<const Patch*> of(voxels.size(), nullptr);
  for (const Patch& patch : patches) of[static_cast<std::size_t>(patch.voxel)] = &patch;
  return of;
}

/// Share of the patches that have another one behind or before them that faces the same way. Tails
/// of noise are no skin.
double share_with_another_behind(const std::vector<Patch>& patches, const Voxels& voxels,
                                 double from_m) {
  const std::vector<const Patch*> of = by_voxel(patches, voxels);
  const auto has = [&](const Patch& patch, double far_m) {
    const Vector3 there = voxels.mean[static_cast<std::size_t>(patch.voxel)] + far_m * patch.normal;
    const int at = voxels.around(there);
    const Patch* other = at < 0 ? nullptr : of[static_cast<std::size_t>(at)];
    return other != nullptr && other->share > share_of_tails &&
           std::abs(other->normal.dot(patch.normal)) > same_way;
  };
  std::size_t found = 0;
  for (const Patch& patch : patches) {
    bool behind = false;
    for (double far_m = from_m; far_m < max_behind_m && !behind; far_m += 0.7 * voxels.size_m)
      behind = has(patch, far_m) || has(patch, -far_m);
    found += behind ? 1 : 0;
  }
  return static_cast<double>(found) / static_cast<double>(patches.size());
}

/// Kurtosis of the distances of points from the planes of their patches: 1 for two thin layers, 3
/// for noise.
double kurtosis(const std::vector<Vector3>& points, const std::vector<Patch>& patches,
                const Voxels& voxels) {
  const std::vector<const Patch*> of = by_voxel(patches, voxels);
  double count = 0.0, square = 0.0, fourth = 0.0;
  for (const Vector3& point : points) {
    const int at = voxels.around(point);
    const Patch* patch = at < 0 ? nullptr : of[static_cast<std::size_t>(at)];
    if (patch == nullptr || patch->thickness_m < min_layer_m) continue;
    const double off = patch->normal.dot(point - patch->mean) / patch->thickness_m;
    count += 1.0;
    square += off * off;
    fourth += off * off * off * off;
  }
  return count > 0.0 ? count * fourth / (square * square) : 3.0;
}

}  // namespace

Result<PointCloud> thin_skin(const std::vector<Vector3>& points, double spacing_m) {
  const Voxels voxels = gather(points, spacing_m);
  const std::vector<Patch> patches = patches_of(voxels);
  PointCloud cloud;
  if (patches.empty()) return cloud;
  std::vector<double> thickness_m;
  thickness_m.reserve(patches.size());
  for (const Patch& patch : patches) thickness_m.push_back(patch.thickness_m);
  const auto middle = thickness_m.begin() + static_cast<std::ptrdiff_t>(thickness_m.size() / 2);
  std::nth_element(thickness_m.begin(), middle, thickness_m.end());
  const bool noisy = *middle > much_noise_m;
  const double from_m = (noisy ? 3.0 : 2.0) * spacing_m;
  if (share_with_another_behind(patches, voxels, from_m) > share_behind ||
      (noisy && kurtosis(points, patches, voxels) < min_kurtosis)) {
    return fail(Fault::bad_input,
                "the cloud shows the back twice, one skin over the other: did the person move "
                "between two sweeps? Scan once more");
  }
  for (const Patch& patch : patches) {
    if (noisy && patch.share < share_of_tails) continue;
    const Vector3& mean = voxels.mean[static_cast<std::size_t>(patch.voxel)];
    const double off_m = noisy ? patch.normal.dot(mean - patch.mean) : 0.0;
    cloud.points.emplace_back(mean - off_m * patch.normal);
    cloud.normals.push_back(patch.normal);
  }
  return cloud;
}

}  // namespace tuina::body
