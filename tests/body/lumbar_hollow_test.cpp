// SPDX-License-Identifier: Apache-2.0
#include "tuina/body/lumbar_hollow.hpp"

#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <string_view>

#include "apps/simulated/bad_scans.hpp"
#include "apps/simulated/labelled_phantom.hpp"
#include "tests/reason.hpp"
#include "tuina/body/acupoints.hpp"
#include "tuina/core/units.hpp"

namespace tuina::body {
namespace {

double hill(double x) {
  return std::exp(-x * x);
}

/// A sheet that stands 0.6 m high, turned about the vertical, and this hollow at a height.
BackSurface sheet(double depth_m, double at_m, const Matrix3& couch_from_sheet) {
  PointCloud cloud;
  for (double x = -0.15; x < 0.15; x += 6_mm) {
    for (double z = 0.0; z < 0.6; z += 6_mm) {
      const double y = -depth_m * hill((z - at_m) / 0.08);
      cloud.points.emplace_back(couch_from_sheet * Vector3(x, y, z));
      cloud.normals.emplace_back(couch_from_sheet * Vector3::UnitY());
    }
  }
  return {std::move(cloud), BodyPosture::sitting, 6_mm};
}

/// From C7 at 0.58 m to the sacrum at 0.12 m.
Places midline(const Matrix3& couch_from_sheet) {
  Places line(3, 3);
  line << 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.58, 0.30, 0.12;
  return couch_from_sheet * line;
}

/// A sitting phantom made to stand: a trunk that is short for its breadth, hollow at L4, with
/// buttocks that stand out.
LabelledBody standing(std::uint64_t seed) {
  LabelledBody person =
      app::labelled(sim::make_phantom(sim::draw_phantom(seed), BodyPosture::sitting));
  const auto at = [&](std::string_view name) {
    return std::find_if(person.landmarks.begin(), person.landmarks.end(),
                        [&](const Landmark& mark) { return mark.name == name; })
        ->at_in_couch;
  };
  const Vector3 sacrum = at("sacrum_S2");
  const double spine_m = at("C7").z() - sacrum.z();
  const auto stand = [&](Vector3& p) {
    const double share = (p.z() - sacrum.z()) / spine_m;
    p.y() += 30_mm * hill((share + 0.3) / 0.25) - 45_mm * hill((share - 0.13) / 0.18);
    p.z() = sacrum.z() + 0.85 * (p.z() - sacrum.z());
  };
  person.scan_in_couch = sample(person.skin_in_couch, 5_mm);
  for (Vector3& p : person.scan_in_couch.points) stand(p);
  for (Acupoint& point : person.acupoints) stand(point.at_in_couch);
  return person;
}

}  // namespace

TEST_CASE("the deepest place of the loins is found on a turned person") {
  for (const double turned_rad : {0.0, 20_deg}) {
    const Matrix3 turn = Eigen::AngleAxisd(turned_rad, Vector3::UnitZ()).toRotationMatrix();
    const auto hollow = find_lumbar_hollow(sheet(40_mm, 0.21, turn), midline(turn), turn);
    REQUIRE(hollow.has_value());
    CHECK(hollow->at_in_couch.z() == doctest::Approx(0.21).epsilon(0.03));
    CHECK((turn.transpose() * hollow->at_in_couch).y() == doctest::Approx(-0.039).epsilon(0.05));
    CHECK(hollow->depth_m == doctest::Approx(0.039).epsilon(0.05));
  }
}

TEST_CASE("flat loins, and a hollow between the shoulder blades, say nothing") {
  const Matrix3 turn = Matrix3::Identity();
  CHECK_FALSE(find_lumbar_hollow(sheet(15_mm, 0.21, turn), midline(turn), turn).has_value());
  CHECK_FALSE(find_lumbar_hollow(sheet(40_mm, 0.48, turn), midline(turn), turn).has_value());
}

// Without the hollow these three are 20 to 31 mm off along the spine.
TEST_CASE("who stands with a short trunk has GV4 above the deepest place of the loins") {
  const auto atlas = read_atlas(TUINA_SOURCE_DIR "/models/atlas.tuina");
  REQUIRE_MESSAGE(atlas.has_value(), test::reason(atlas));
  for (const std::uint64_t seed : {84U, 88U, 92U}) {
    const LabelledBody person = standing(seed);
    const auto back = fit_back(person.scan_in_couch);
    REQUIRE_MESSAGE(back.has_value(), test::reason(back));
    const auto found = locate_acupoints(*back, *atlas);
    REQUIRE_MESSAGE(found.has_value(), test::reason(found));
    for (std::size_t i = 0; i < found->acupoints.size(); ++i) {
      if (found->acupoints[i].name != "GV4") continue;
      CAPTURE(seed);
      CHECK(app::place_error_m(found->acupoints[i], person.acupoints[i]) < 12_mm);
    }
  }
}

}  // namespace tuina::body
