// SPDX-License-Identifier: Apache-2.0
// Phantoms beside labelled bodies: prints the numbers of docs/bodies.md with `test_sim -s
// -tc="phantoms and people*"`.
#include <doctest/doctest.h>

#include <algorithm>
#include <filesystem>
#include <map>

#include "tests/reason.hpp"
#include "tuina/sim/person/phantom.hpp"

using namespace tuina;
using namespace tuina::sim;

namespace {

Vector3 landmark(const Person& person, const std::string& name) {
  const auto found = std::find_if(person.landmarks.begin(), person.landmarks.end(),
                                  [&](const Landmark& l) { return l.name == name; });
  REQUIRE(found != person.landmarks.end());
  return found->at_in_couch;
}

struct Places {
  std::map<std::string, std::vector<Vector3>> of;

  /// In the frame of the trunk: S2 the origin, z to C7, x to the left, for a trunk of half a metre.
  void add(const Person& person) {
    const Vector3 sacrum = landmark(person, "sacrum_S2");
    const Vector3 spine = landmark(person, "C7") - sacrum;
    const Vector3 z = spine.normalized();
    Vector3 x = (landmark(person, "acromion_L") - landmark(person, "acromion_R")).normalized() +
                (landmark(person, "psis_L") - landmark(person, "psis_R")).normalized();
    x = (x - z * z.dot(x)).normalized();
    Matrix3 trunk_from_couch;
    trunk_from_couch << x.transpose(), z.cross(x).transpose(), z.transpose();
    for (std::size_t i = 0; i < seven_acupoints.size(); ++i) {
      const Acupoint& point = person.acupoints[i];
      of[point.name].push_back(trunk_from_couch * (point.at_in_couch - sacrum) * 0.5 /
                               spine.norm());
    }
  }
  [[nodiscard]] Vector3 mean(const std::string& name) const {
    Vector3 sum = Vector3::Zero();
    for (const Vector3& at : of.at(name)) sum += at;
    return sum / static_cast<double>(of.at(name).size());
  }
  [[nodiscard]] Vector3 spread(const std::string& name) const {
    const Vector3 middle = mean(name);
    Vector3 sum = Vector3::Zero();
    for (const Vector3& at : of.at(name)) sum += (at - middle).cwiseAbs2();
    return (sum / static_cast<double>(of.at(name).size())).cwiseSqrt();
  }
};

}  // namespace

TEST_CASE("phantoms and people have their acupoints at the same places of the trunk") {
  const auto folder = std::filesystem::path(TUINA_BODIES) / "population";
  if (!std::filesystem::exists(folder)) {
    MESSAGE("skipped: no labelled bodies in " << folder.string());
    return;
  }
  for (const BodyPosture position : {BodyPosture::sitting, BodyPosture::prone}) {
    Places people;
    Places phantoms;
    for (int i = 1; i <= 80; i += 2) {
      const auto name = fmt::format("p{}{:03}.ply", name_of(position)[0], i + i / 2 % 2);
      const auto person = load_person(folder / name);
      REQUIRE_MESSAGE(person.has_value(), test::reason(person));
      people.add(*person);
      phantoms.add(make_phantom(draw_phantom(static_cast<std::uint64_t>(i)), position));
    }
    for (const char* name : seven_acupoints) {
      const Vector3 apart_mm = 1e3 * (phantoms.mean(name) - people.mean(name));
      const Vector3 ours_mm = 1e3 * phantoms.spread(name);
      const Vector3 theirs_mm = 1e3 * people.spread(name);
      MESSAGE(fmt::format(
          "{} {}: means apart ({:.1f}, {:.1f}, {:.1f}) mm, spread ({:.1f}, {:.1f}, "
          "{:.1f}), people's ({:.1f}, {:.1f}, {:.1f})",
          name_of(position), name, apart_mm.x(), apart_mm.y(), apart_mm.z(), ours_mm.x(),
          ours_mm.y(), ours_mm.z(), theirs_mm.x(), theirs_mm.y(), theirs_mm.z()));
      CHECK(apart_mm.norm() < 8.0);
      CHECK(ours_mm.norm() > 0.6 * theirs_mm.norm());
      CHECK(ours_mm.norm() < 1.6 * theirs_mm.norm());
    }
  }
}
