// SPDX-License-Identifier: Apache-2.0
#include "tuina/sim/scanner/skin_light.hpp"

#include <array>
#include <cmath>

#include "tuina/core/units.hpp"

namespace tuina::sim {
namespace {

constexpr double refractive_index = 1.4;
constexpr double spread_of_scatter = 1.5;  // the bright middle of the glow, in ways 1 / mu_s'
constexpr double hair_height_m = 2_mm, hair_share_back = 0.3;
constexpr double mole_share_back = 0.35;

/// Numbers from 0 to 1 that belong to one cell of space.
class Cell {
 public:
  Cell(const Vector3& at, double size_m, std::uint64_t seed, std::uint64_t kind) noexcept
      : state_(seed * 0x9E3779B97F4A7C15ULL ^ kind) {
    for (int i = 0; i < 3; ++i) {
      const auto step = static_cast<std::int64_t>(std::floor(at[i] / size_m));
      inside_[i] = at[i] / size_m - static_cast<double>(step);
      state_ = (state_ ^ static_cast<std::uint64_t>(step)) * 0xD1342543DE82EF95ULL;
    }
  }
  double next() noexcept {  // SplitMix64
    std::uint64_t z = state_ += 0x9E3779B97F4A7C15ULL;
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9ULL;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBULL;
    return static_cast<double>((z ^ (z >> 31)) >> 11) * 0x1.0p-53;
  }
  [[nodiscard]] const Vector3& inside() const noexcept { return inside_; }  ///< 0 to 1

 private:
  std::uint64_t state_;
  Vector3 inside_;
};

bool on_mole(const Vector3& at, double per_m2, std::uint64_t seed) noexcept {
  constexpr double cell_m = 15_mm;
  Cell cell(at, cell_m, seed, 1);
  if (cell.next() >= per_m2 * cell_m * cell_m) return false;
  const double radius = (0.5_mm + 1_mm * cell.next()) / cell_m;
  Vector3 middle;
  for (double& x : middle) x = 0.2 + 0.6 * cell.next();
  // A spot of the skin, whatever its height in the cell: the two widest differences tell.
  const Vector3 off = (cell.inside() - middle).cwiseAbs();
  return off.sum() - off.maxCoeff() < radius * 1.4;
}

}  // namespace

LeftSkin leave_skin(const ScanFlaws& flaws, const Vector3& at, const Vector3& direction,
                    const Vector3& normal, std::uint64_t seed) noexcept {
  constexpr double hair_m = 1_mm, drop_m = 3_mm;
  LeftSkin left{.share = 1.0 - flaws.dark_share};
  if (Cell hair(at, hair_m, seed, 2); hair.next() < flaws.hair_share) {
    left.by = hair_height_m * hair.next() * normal;
    left.share = hair_share_back;
    return left;
  }
  left.by = flaws.scatter_m / refractive_index * (direction - direction.dot(normal) * normal);
  left.spread_m = spread_of_scatter * flaws.scatter_m;
  if (flaws.moles_per_m2 > 0.0 && on_mole(at, flaws.moles_per_m2, seed))
    left.share *= mole_share_back;
  // A drop shines at the camera or away from it.
  if (Cell drop(at, drop_m, seed, 3); drop.next() < flaws.sweat_share)
    left.share *= 0.3 + 4.0 * drop.next() * drop.next();
  return left;
}

}  // namespace tuina::sim
