// SPDX-License-Identifier: Apache-2.0
#include "tuina/sim/person/tissue_map.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>

#include "tuina/core/random.hpp"
#include "tuina/core/units.hpp"

namespace tuina::sim {
namespace {

/// 1 up to `from`, 0 beyond `to`, smooth between.
double fades(double distance, double from, double to) {
  const double x = std::clamp((distance - from) / (to - from), 0.0, 1.0);
  return 1.0 - x * x * (3.0 - 2.0 * x);
}

struct Nearest {
  double distance_m = 1e9;
  double along = 0.0;  ///< index of the segment and fraction on it
  Vector3 at = Vector3::Zero();
};

Nearest nearest_on(const std::vector<Vector3>& line, const Vector3& point) {
  Nearest nearest;
  for (std::size_t i = 0; i + 1 < line.size(); ++i) {
    const Vector3 way = line[i + 1] - line[i];
    const double t = std::clamp((point - line[i]).dot(way) / way.squaredNorm(), 0.0, 1.0);
    const Vector3 at = line[i] + t * way;
    const double distance_m = (point - at).norm();
    if (distance_m < nearest.distance_m) {
      nearest = {.distance_m = distance_m, .along = static_cast<double>(i) + t, .at = at};
    }
  }
  return nearest;
}

/// Distance of a point from a triangle in its plane; 0 inside.
double outside_triangle(const std::array<Vector3, 3>& corner, const Vector3& point) {
  const Vector3 normal = (corner[1] - corner[0]).cross(corner[2] - corner[0]).normalized();
  const Vector3 flat = point - normal * normal.dot(point - corner[0]);
  bool inside = true;
  for (std::size_t i = 0; i < 3; ++i) {
    const Vector3 side = corner[(i + 1) % 3] - corner[i];
    inside = inside && side.cross(flat - corner[i]).dot(normal) >= 0.0;
  }
  if (inside) return 0.0;
  return nearest_on({corner[0], corner[1], corner[2], corner[0]}, flat).distance_m;
}

/// Bones of one person, from the landmarks on the skin.
struct Bones {
  std::vector<Vector3> spine;  ///< C7 to S2
  double t12 = 0.0;            ///< position of the last rib along the spine
  std::array<std::vector<Vector3>, 2> scapula_spine;
  std::array<std::array<Vector3, 3>, 2> scapula, sacrum;
  Vector3 left = Vector3::UnitX();
  double cun_m = 0.0265;  ///< B-cun
};

const Vector3* find(const Person& person, const std::string& name) {
  for (const Landmark& landmark : person.landmarks) {
    if (landmark.name == name) return &landmark.at_in_couch;
  }
  return nullptr;
}

std::optional<Bones> find_bones(const Person& person) {
  Bones bones;
  for (const char* name : {"C7", "T3", "T7", "T9", "T12", "L2", "L4", "sacrum_S2"}) {
    const Vector3* at = find(person, name);
    if (at == nullptr) return std::nullopt;
    if (std::string_view(name) == "T12") bones.t12 = static_cast<double>(bones.spine.size());
    bones.spine.push_back(*at);
  }
  for (const std::size_t side : {0U, 1U}) {
    const std::string suffix = side == 0 ? "_L" : "_R";
    const Vector3* root = find(person, "scapula_root" + suffix);
    const Vector3* middle = find(person, "scapula_spine_mid" + suffix);
    const Vector3* tip = find(person, "scapula_inferior_angle" + suffix);
    const Vector3* angle = find(person, "acromial_angle" + suffix);
    const Vector3* psis = find(person, "psis" + suffix);
    if (!root || !middle || !tip || !angle || !psis) return std::nullopt;
    bones.scapula_spine[side] = {*root, *middle, *angle};
    // The lateral border runs from the tip to the socket, inwards of the acromial angle.
    bones.scapula[side] = {*root, *tip, *root + 0.85 * (*angle - *root)};
    // The sacrum narrows from the hips towards a point below S2, away from the spine above it.
    const Vector3 below = bones.spine[7] + 0.5 * (bones.spine[7] - bones.spine[6]);
    bones.sacrum[side] = {bones.spine[7], *psis, below};
    if (side == 0) bones.left = (*root - bones.spine[1]).normalized();
  }
  if (person.three_cun_m > 0.0) bones.cun_m = person.three_cun_m / 3.0;
  return bones;
}

TissueShares shares_at(const Bones& bones, const Vector3& skin) {
  const Nearest spine = nearest_on(bones.spine, skin);
  const bool on_spine = spine.along > 0.0 && spine.along < 7.0;
  const double aside_cun = spine.distance_m / bones.cun_m;
  const std::size_t side = (skin - spine.at).dot(bones.left) >= 0.0 ? 0 : 1;
  const double plate_m = outside_triangle(bones.scapula[side], skin);
  const double ridge_m = nearest_on(bones.scapula_spine[side], skin).distance_m;
  const double sacrum_m =
      std::min(outside_triangle(bones.sacrum[0], skin), outside_triangle(bones.sacrum[1], skin));
  // Superficial bone: spinous processes, ridge of the scapula, sacrum.
  double bone = std::max({fades(spine.distance_m, 5_mm, 23_mm) * (on_spine ? 1.0 : 0.7),
                          fades(ridge_m, 6_mm, 26_mm),
                          0.9 * fades(sacrum_m, 3_mm, 25_mm) * fades(aside_cun, 1.2, 2.2)});
  // Thin muscle over bone: the scapula, and the ribs outside the muscles of the spine.
  bone = std::max(bone, 0.45 * fades(plate_m, 2_mm, 25_mm));
  const double above_loins = fades(spine.along, bones.t12 - 0.3, bones.t12 + 0.45);
  bone = std::max(bone, 0.35 * above_loins * (1.0 - fades(aside_cun, 3.6, 5.0)) *
                            (1.0 - fades(spine.along, 0.6, 1.6)));
  // The rest is hard muscle over the ribs, beside the spine down to L3, and in shoulder and neck,
  // and soft muscle at the loins and below.
  const double loins = 1.0 - above_loins;
  const double beside_spine = fades(aside_cun, 1.9, 2.9) * fades(spine.along, 5.2, 6.6);
  const double soft = loins * (1.0 - beside_spine);
  return {.bone = bone, .hard = (1.0 - bone) * (1.0 - soft), .soft = (1.0 - bone) * soft};
}

/// Waves over the skin by which tissue differs from place to place.
class Waves {
 public:
  struct Lengths {
    double min_m, max_m;
  };
  /// Standard deviations of the logarithms of alpha and beta, in each wave.
  Waves(std::size_t count, const Lengths& lengths, double alpha_sd, double beta_sd,
        Random& random) {
    for (std::size_t i = 0; i < count; ++i) {
      Vector3 way;
      for (double& component : way) component = gaussian(random, 1.0);
      const double length_m = uniform(random, lengths.min_m, lengths.max_m);
      waves_.push_back({.way = way.normalized() * (2.0 * pi / length_m),
                        .phase = uniform(random, 0.0, 2.0 * pi),
                        .alpha = gaussian(random, alpha_sd),
                        .beta = gaussian(random, beta_sd)});
    }
  }
  [[nodiscard]] TangentTissue over(const TangentTissue& tissue, const Vector3& at) const {
    double alpha = 0.0, beta = 0.0;
    for (const Wave& wave : waves_) {
      const double height = std::sin(wave.way.dot(at) + wave.phase);
      alpha += wave.alpha * height;
      beta += wave.beta * height;
    }
    return {.alpha_n = tissue.alpha_n * std::exp(alpha),
            .beta_per_m = tissue.beta_per_m * std::exp(beta)};
  }

 private:
  struct Wave {
    Vector3 way;
    double phase, alpha, beta;
  };
  std::vector<Wave> waves_;
};

double mix(const TissueShares& shares, double bone, double hard, double soft) {
  return std::exp(shares.bone * std::log(bone) + shares.hard * std::log(hard) +
                  shares.soft * std::log(soft));
}

}  // namespace

TissueLaws tissue_laws_of(BodyType type, bool woman) {
  // Means over the men of each type: subjects 2 and 6, 1 and 5, 3 and 7; beta printed per
  // millimetre.
  const TissueLaws men =
      type == BodyType::slim
          ? TissueLaws{.bone = {5.125, 270.0}, .hard = {11.455, 250.0}, .soft = {4.27, 245.0}}
      : type == BodyType::medium
          ? TissueLaws{.bone = {4.67, 270.0}, .hard = {11.42, 225.0}, .soft = {4.205, 215.0}}
          : TissueLaws{.bone = {4.355, 240.0}, .hard = {6.42, 220.0}, .soft = {4.09, 190.0}};
  if (!woman) return men;
  const TissueLaws woman_of_medium_build = {// subject 4, the only woman
                                            .bone = {4.13, 270.0},
                                            .hard = {6.36, 260.0},
                                            .soft = {4.10, 250.0}};
  if (type == BodyType::medium) return woman_of_medium_build;
  // No slim or hefty woman was measured: geometric mean of the man of that type and the one woman.
  const auto between = [](const TangentTissue& a, const TangentTissue& b) {
    return TangentTissue{.alpha_n = std::sqrt(a.alpha_n * b.alpha_n),
                         .beta_per_m = std::sqrt(a.beta_per_m * b.beta_per_m)};
  };
  return {.bone = between(men.bone, woman_of_medium_build.bone),
          .hard = between(men.hard, woman_of_medium_build.hard),
          .soft = between(men.soft, woman_of_medium_build.soft)};
}

std::vector<TissueShares> find_tissue_shares(const Person& person) {
  std::vector<TissueShares> shares(person.skin_in_couch.vertices.size(), TissueShares{.hard = 1.0});
  const auto bones = find_bones(person);
  if (!bones) return shares;
  for (std::size_t i = 0; i < shares.size(); ++i) {
    shares[i] = shares_at(*bones, person.skin_in_couch.vertices[i]);
  }
  return shares;
}

std::vector<TangentTissue> lay_tissue(const Person& person, std::uint64_t seed) {
  Random random = make_random(seed, "tissue");
  // The spread of the seven subjects within their types is 3 to 6 % in alpha and 2 to 4 % in beta.
  TissueLaws laws = tissue_laws_of(person.body_type, person.woman);
  for (TangentTissue* law : {&laws.bone, &laws.hard, &laws.soft}) {
    law->alpha_n *= std::exp(std::clamp(gaussian(random, 0.05), -0.12, 0.12));
    law->beta_per_m *= std::exp(std::clamp(gaussian(random, 0.03), -0.08, 0.08));
  }
  // Muscle varies within a person.
  const Waves waves(6, {0.12, 0.40}, 0.02, 0.012, random);
  const auto shares = find_tissue_shares(person);
  std::vector<TangentTissue> tissue(shares.size());
  for (std::size_t i = 0; i < shares.size(); ++i) {
    const TangentTissue mixed = {
        .alpha_n = mix(shares[i], laws.bone.alpha_n, laws.hard.alpha_n, laws.soft.alpha_n),
        .beta_per_m =
            mix(shares[i], laws.bone.beta_per_m, laws.hard.beta_per_m, laws.soft.beta_per_m)};
    tissue[i] = waves.over(mixed, person.skin_in_couch.vertices[i]);
  }
  return tissue;
}

void roughen(std::vector<TangentTissue>& per_vertex, const Mesh& skin, double share,
             std::uint64_t seed) {
  constexpr std::size_t count = 12;
  const double each = share * std::sqrt(2.0 / count);
  Random random = make_random(seed, "grain of the tissue");
  const Waves waves(count, {20_mm, 60_mm}, each, 0.4 * each, random);
  for (std::size_t i = 0; i < per_vertex.size(); ++i)
    per_vertex[i] = waves.over(per_vertex[i], skin.vertices[i]);
}

}  // namespace tuina::sim
