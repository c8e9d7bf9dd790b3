// SPDX-License-Identifier: Apache-2.0
#include "tuina/scanner/profile_grid.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>

namespace tuina::scanner {
namespace {

// Four rows at a time, in compiler vectors that every processor supports.
constexpr std::size_t lanes = 4;
using Floats [[gnu::vector_size(4 * lanes)]] = float;
using Wholes [[gnu::vector_size(4 * lanes)]] = std::int32_t;

[[gnu::always_inline]] inline Floats load(const float* from) {
  Floats values;
  std::memcpy(&values, from, sizeof values);
  return values;
}

[[gnu::always_inline]] inline void store(float* to, const Floats& values) {
  std::memcpy(to, &values, sizeof values);
}

// One where the claim holds, else zero.
[[gnu::always_inline]] inline Floats one_if(const Wholes& claim) {
  return claim ? Floats{} + 1.0F : Floats{};
}

// Neighbours of a point on its surface: counts in its profile, in adjacent profiles, and of those
// brighter than it. True claims are -1.
struct Company {
  Wholes in_rows = {}, in_profiles = {}, brighter = {};
  void add(bool in_same_profile, const Wholes& near, const Wholes& outshines) {
    (in_same_profile ? in_rows : in_profiles) -= near;
    brighter -= near & outshines;
  }
  // Fewer than half brighter means that the point is not below the median.
  [[nodiscard]] Wholes bears_out(int profiles_needed) const {
    return (in_rows >= 3) & (in_profiles >= profiles_needed) &
           (brighter + brighter < in_rows + in_profiles);
  }
};

std::size_t whole_vectors(std::size_t rows) {
  return (rows + lanes - 1) / lanes * lanes;
}

}  // namespace

ProfileGrid::ProfileGrid(std::size_t profiles, std::size_t rows)
    : profiles_(profiles),
      rows_(rows),
      stride_(whole_vectors(rows) + 2 * margin_rows),
      has_unsure_(profiles + 2, false) {
  const std::size_t count = (profiles + 2 * margin_profiles) * stride_;
  for (const Plane plane : {x, y, z}) plane_[plane].assign(count, unlit_m);
  for (const Plane plane : {amplitude, deviation, reach_rows, reach_profiles, unsure}) {
    plane_[plane].assign(count, 0.0F);
  }
}

void ProfileGrid::light(std::size_t profile, std::size_t row, const Node& node) {
  const std::size_t i = place(profile, row);
  plane_[x][i] = static_cast<float>(node.point.x());
  plane_[y][i] = static_cast<float>(node.point.y());
  plane_[z][i] = static_cast<float>(node.point.z());
  plane_[amplitude][i] = node.amplitude_dn;
  plane_[deviation][i] = node.deviation_m;
  plane_[reach_rows][i] = node.reach_rows_m;
  plane_[reach_profiles][i] = node.reach_profiles_m;
  if (!node.unsure) return;
  plane_[unsure][i] = 1.0F;
  has_unsure_[profile + 1] = true;
}

NeighbourFilter::NeighbourFilter(const ProfileGrid& grid) : grid_(grid) {
  const std::size_t rows = whole_vectors(grid.rows());
  for (Sums& sums_of : near_) {
    for (auto& sum : sums_of) sum.assign(rows, 0.0F);
  }
  verdict_.trusted.assign(rows, 0.0F);
  for (auto& component : verdict_.normal) component.assign(rows, 0.0F);
  verdict_.neighbours.assign(rows, 0.0F);
  verdict_.offset_m.assign(rows, 0.0F);
  for (std::ptrdiff_t profile = 0; profile < profiles_near; ++profile) add_up_rows(profile);
}

const NeighbourFilter::Verdict& NeighbourFilter::next() {
  ++profile_;
  add_up_rows(profile_ + profiles_near);
  fit_planes();
  compare_amplitudes();
  return verdict_;
}

// Sums up to six rows up and down, every third one, since rows lie closer than profiles.
void NeighbourFilter::add_up_rows(std::ptrdiff_t profile) {
  Sums& to = near_[static_cast<std::size_t>(profile) % window];
  if (profile >= static_cast<std::ptrdiff_t>(grid_.profiles())) {
    for (auto& sum : to) std::fill(sum.begin(), sum.end(), 0.0F);
    return;
  }
  const std::size_t begin = grid_.place(static_cast<std::size_t>(profile), 0);
  const float* const at[3] = {grid_.plane_[ProfileGrid::x].data() + begin,
                              grid_.plane_[ProfileGrid::y].data() + begin,
                              grid_.plane_[ProfileGrid::z].data() + begin};
  const float* reach = grid_.plane_[ProfileGrid::reach_rows].data() + begin;
  for (std::size_t row = 0; row < to[n].size(); row += lanes) {
    const Floats x = load(at[0] + row);
    const Floats y = load(at[1] + row);
    const Floats z = load(at[2] + row);
    const Floats reach_m = load(reach + row);
    Floats sum[sums] = {};
    sum[n] += 1.0F;
    for (const int j : {-6, -3, 3, 6}) {
      const auto on = static_cast<std::ptrdiff_t>(row) + j;
      Floats dx = load(at[0] + on) - x;
      Floats dy = load(at[1] + on) - y;
      Floats dz = load(at[2] + on) - z;
      const auto step = static_cast<float>(j);
      const Floats far = reach_m * step;
      const Floats near = one_if(dx * dx + dy * dy + dz * dz <= far * far);
      dx *= near;
      dy *= near;
      dz *= near;
      sum[n] += near;
      sum[j1] += step * near;
      sum[jj] += step * step * near;
      sum[px] += dx;
      sum[py] += dy;
      sum[pz] += dz;
      sum[jx] += step * dx;
      sum[jy] += step * dy;
      sum[jz] += step * dz;
    }
    for (std::size_t k = 0; k < sums; ++k) store(to[k].data() + row, sum[k]);
  }
}

// Least squares of point = origin + a i + b j over profiles i and rows j around each point; the
// normal is perpendicular to a and b.
void NeighbourFilter::fit_planes() {
  const std::size_t begin = grid_.place(static_cast<std::size_t>(profile_), 0);
  const auto stride = static_cast<std::ptrdiff_t>(grid_.stride_);
  const float* const at[3] = {grid_.plane_[ProfileGrid::x].data() + begin,
                              grid_.plane_[ProfileGrid::y].data() + begin,
                              grid_.plane_[ProfileGrid::z].data() + begin};
  const float* reach = grid_.plane_[ProfileGrid::reach_profiles].data() + begin;
  for (std::size_t row = 0; row < verdict_.trusted.size(); row += lanes) {
    const Floats origin[3] = {load(at[0] + row), load(at[1] + row), load(at[2] + row)};
    const Floats reach_m = load(reach + row);
    Floats count = {}, i1 = {}, j_1 = {}, ii = {}, ij = {}, j_j = {};
    Floats p[3] = {}, ip[3] = {}, jp[3] = {};
    for (std::ptrdiff_t i = -profiles_near; i <= profiles_near; ++i) {
      if (profile_ + i < 0) continue;
      const Sums& from = near_[static_cast<std::size_t>(profile_ + i) % window];
      const auto on = static_cast<std::ptrdiff_t>(row) + i * stride;
      const auto step = static_cast<float>(i);
      Floats away[3];
      for (int k = 0; k < 3; ++k) away[k] = load(at[k] + on) - origin[k];
      const Floats far = reach_m * step;
      const Floats near =
          one_if(away[0] * away[0] + away[1] * away[1] + away[2] * away[2] <= far * far);
      const Floats here = load(from[n].data() + row) * near;
      const Floats rows_here = load(from[j1].data() + row) * near;
      count += here;
      i1 += step * here;
      ii += step * step * here;
      j_1 += rows_here;
      ij += step * rows_here;
      j_j += load(from[jj].data() + row) * near;
      for (std::size_t k = 0; k < 3; ++k) {
        const Floats place = load(from[px + k].data() + row) * near + here * away[k];
        p[k] += place;
        ip[k] += step * place;
        jp[k] += load(from[jx + k].data() + row) * near + rows_here * away[k];
      }
    }
    const Floats share = 1.0F / (count > 1.0F ? count : Floats{} + 1.0F);
    const Floats c_ii = ii - i1 * i1 * share;
    const Floats c_ij = ij - i1 * j_1 * share;
    const Floats c_jj = j_j - j_1 * j_1 * share;
    // The common factor 1 / spread of a and b does not change the normal.
    Floats a[3], b[3];
    for (int k = 0; k < 3; ++k) {
      const Floats along_i = ip[k] - i1 * share * p[k];
      const Floats along_j = jp[k] - j_1 * share * p[k];
      a[k] = c_jj * along_i - c_ij * along_j;
      b[k] = c_ii * along_j - c_ij * along_i;
    }
    Floats normal[3];
    for (int k = 0; k < 3; ++k) {
      normal[k] = a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3];
    }
    const Floats length2 = normal[0] * normal[0] + normal[1] * normal[1] + normal[2] * normal[2];
    Floats length;
    for (std::size_t k = 0; k < lanes; ++k) length[k] = std::sqrt(length2[k]);
    const Floats known =
        one_if((count >= 6.0F) & (c_ii * c_jj - c_ij * c_ij >= 1.0F) & (length > 1e-12F));
    store(verdict_.trusted.data() + row, known);
    for (std::size_t k = 0; k < 3; ++k) {
      store(verdict_.normal[k].data() + row, normal[k] / (length + 1e-30F));
    }
  }
}

// A point needs three neighbours along its profile, two on adjacent profiles (if there are any),
// and at least 0.6 of their median amplitude. Beside a shadow edge or couch edge that cuts the
// laser's sheet, whole profiles are dim, centimetres off and consistent with each other, but the
// surface ends there. So unsure points count only where it continues in the profiles on both sides.
void NeighbourFilter::compare_amplitudes() {
  constexpr float dim = 0.6F;
  const std::size_t begin = grid_.place(static_cast<std::size_t>(profile_), 0);
  const auto stride = static_cast<std::ptrdiff_t>(grid_.stride_);
  const auto plane = [&](ProfileGrid::Plane name) { return grid_.plane_[name].data() + begin; };
  const float* const at[3] = {plane(ProfileGrid::x), plane(ProfileGrid::y), plane(ProfileGrid::z)};
  const float* light = plane(ProfileGrid::amplitude);
  const float* unsure = plane(ProfileGrid::unsure);
  const bool several = grid_.profiles() > 2;
  const bool some_unsure = grid_.unsure_near(static_cast<std::size_t>(profile_));
  const int needed = several ? 2 : 0;
  const int a_side = several ? 1 : 0;
  for (std::size_t row = 0; row < verdict_.trusted.size(); row += lanes) {
    const Floats origin[3] = {load(at[0] + row), load(at[1] + row), load(at[2] + row)};
    const Floats reach_rows = load(plane(ProfileGrid::reach_rows) + row);
    const Floats reach_profiles = load(plane(ProfileGrid::reach_profiles) + row);
    const Floats amplitude = load(light + row);
    const Floats normal[3] = {load(verdict_.normal[0].data() + row),
                              load(verdict_.normal[1].data() + row),
                              load(verdict_.normal[2].data() + row)};
    Floats offsets_m = {};
    Company all, sure;
    const auto meet = [&](std::ptrdiff_t i, std::ptrdiff_t j) {
      const auto on = static_cast<std::ptrdiff_t>(row) + i * stride + j;
      Floats distance2 = {}, offset_m = {};
      for (int k = 0; k < 3; ++k) {
        const Floats away = load(at[k] + on) - origin[k];
        distance2 += away * away;
        offset_m += away * normal[k];
      }
      const Floats far = reach_profiles * static_cast<float>(i * i) +
                         reach_rows * static_cast<float>(j < 0 ? -j : j);
      const Wholes near = distance2 <= far * far;
      const Wholes outshines = dim * load(light + on) >= amplitude;
      offsets_m += one_if(near) * offset_m;
      all.add(i == 0, near, outshines);
      if (some_unsure) sure.add(i == 0, near & (load(unsure + on) == 0.0F), outshines);
      return near;
    };
    for (const int j : {-3, -2, -1, 1, 2, 3}) meet(0, j);
    Wholes before = {}, after = {};
    for (const int j : {-1, 0, 1}) {
      before -= meet(-1, j);
      after -= meet(1, j);
    }
    Wholes good = all.bears_out(needed);
    if (some_unsure) {
      const Wholes on_both_sides = (before >= a_side) & (after >= a_side);
      good = (good & on_both_sides) | ((load(unsure + row) == 0.0F) & sure.bears_out(needed));
    }
    const Floats neighbours = __builtin_convertvector(all.in_rows + all.in_profiles, Floats);
    store(verdict_.neighbours.data() + row, neighbours);
    store(verdict_.offset_m.data() + row,
          offsets_m / (neighbours > 1.0F ? neighbours : Floats{} + 1.0F));
    const Floats trusted = one_if(good);
    store(verdict_.trusted.data() + row, load(verdict_.trusted.data() + row) * trusted);
  }
}

}  // namespace tuina::scanner
