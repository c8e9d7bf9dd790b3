// SPDX-License-Identifier: Apache-2.0
#include "tuina/sim/person/tissue_map.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "tests/reason.hpp"
#include "tuina/sim/person/phantom.hpp"

using namespace tuina;
using namespace tuina::sim;

namespace {

std::size_t vertex_at(const Person& person, const Vector3& at) {
  const auto& vertices = person.skin_in_couch.vertices;
  const auto nearest = std::min_element(vertices.begin(), vertices.end(), [&](auto& a, auto& b) {
    return (a - at).squaredNorm() < (b - at).squaredNorm();
  });
  return static_cast<std::size_t>(nearest - vertices.begin());
}

TissueShares under(const Person& person, const std::vector<TissueShares>& shares,
                   const std::string& name) {
  for (const Acupoint& point : person.acupoints) {
    if (point.name == name) return shares[vertex_at(person, point.at_in_couch)];
  }
  for (const Landmark& landmark : person.landmarks) {
    if (landmark.name == name) return shares[vertex_at(person, landmark.at_in_couch)];
  }
  FAIL("no point " << name);
  return {};
}

void check_anatomy(const Person& person) {
  CAPTURE(person.name);
  const auto shares = find_tissue_shares(person);
  for (const auto& share : shares) {
    REQUIRE(share.bone + share.hard + share.soft == doctest::Approx(1.0));
    REQUIRE(std::min({share.bone, share.hard, share.soft}) >= 0.0);
  }
  for (const char* bony :
       {"T3", "T9", "L2", "sacrum_S2", "GV4", "scapula_root_L", "scapula_spine_mid_R"}) {
    CAPTURE(bony);
    CHECK(under(person, shares, bony).bone > 0.6);
  }
  for (const char* muscle : {"BL15_L", "BL17_R", "BL18_L", "BL47_L", "BL47_R"}) {
    CAPTURE(muscle);
    CHECK(under(person, shares, muscle).hard > 0.5);
  }
  CHECK(under(person, shares, "BL50_L").soft > 0.3);
  CHECK(under(person, shares, "SI11_L").bone > 0.25);
  CHECK(under(person, shares, "SI11_L").hard > 0.4);
}

}  // namespace

TEST_CASE("bone, hard and soft muscle lie where anatomy has them, on phantoms of every kind") {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    for (const BodyPosture position : {BodyPosture::sitting, BodyPosture::prone}) {
      check_anatomy(make_phantom(draw_phantom(seed), position));
    }
  }
}

TEST_CASE("and on a labelled body from a file") {
  const std::filesystem::path bodies = TUINA_BODIES;
  if (!std::filesystem::exists(bodies)) {
    MESSAGE("skipped: no labelled bodies in " << bodies.string());
    return;
  }
  for (const char* name : {"standard/standard_sitting.ply", "standard/standard_prone.ply"}) {
    const auto person = load_person(bodies / name);
    REQUIRE_MESSAGE(person.has_value(), test::reason(person));
    check_anatomy(*person);
  }
}

TEST_CASE("the tissue of a person stays in the range of the seven people of Table 6-2") {
  for (const BodyType type : {BodyType::slim, BodyType::medium, BodyType::hefty}) {
    const Person person = make_phantom(draw_phantom(type, 2), BodyPosture::sitting);
    for (const auto& [alpha_n, beta_per_m] : lay_tissue(person, 2)) {
      REQUIRE(alpha_n > 3.3);
      REQUIRE(alpha_n < 14.5);
      REQUIRE(beta_per_m > 160.0);
      REQUIRE(beta_per_m < 310.0);
    }
  }
}

TEST_CASE("tissue has no edges: over one triangle its stiffness changes little") {
  const Person person = make_phantom(draw_phantom(BodyType::medium, 4), BodyPosture::sitting);
  const auto tissue = lay_tissue(person, 4);
  double steepest = 0.0;
  for (const auto& triangle : person.skin_in_couch.triangles) {
    for (const std::size_t i : {0U, 1U, 2U}) {
      const auto a = static_cast<std::size_t>(triangle[i]);
      const auto b = static_cast<std::size_t>(triangle[(i + 1) % 3]);
      const double apart_m =
          (person.skin_in_couch.vertices[a] - person.skin_in_couch.vertices[b]).norm();
      if (apart_m < 0.002) continue;
      steepest =
          std::max(steepest, std::abs(std::log(tissue[a].alpha_n / tissue[b].alpha_n)) / apart_m);
    }
  }
  CHECK(steepest <
        0.9 / 0.010);  // the whole way from soft to hard muscle takes more than a centimetre
}

TEST_CASE("the same seed lays the same tissue, another seed another") {
  const Person person = make_phantom(draw_phantom(BodyType::medium, 4), BodyPosture::sitting);
  const auto once = lay_tissue(person, 4);
  const auto again = lay_tissue(person, 4);
  const auto other = lay_tissue(person, 5);
  CHECK(once[1000].alpha_n == again[1000].alpha_n);
  CHECK(once[1000].beta_per_m == again[1000].beta_per_m);
  CHECK(once[1000].alpha_n != other[1000].alpha_n);
}
