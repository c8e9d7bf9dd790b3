// SPDX-License-Identifier: Apache-2.0
#include "tuina/body/palpation.hpp"

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <algorithm>
#include <tuple>

#include "apps/simulated/labelled_phantom.hpp"
#include "tests/reason.hpp"
#include "tuina/core/random.hpp"
#include "tuina/core/units.hpp"

namespace tuina::body {
namespace {

/// A phantom on the couch as the shipped atlas sees them.
struct Scene {
  LabelledBody person;
  BackSurface back;
  Mapping found;
};

const Scene& scene() {
  static const Scene scene = [] {
    const auto atlas = read_atlas(TUINA_SOURCE_DIR "/models/atlas.tuina");
    REQUIRE_MESSAGE(atlas.has_value(), test::reason(atlas));
    LabelledBody person =
        app::labelled(sim::make_phantom(sim::draw_phantom(77), BodyPosture::sitting));
    auto back = fit_back(sample(person.skin_in_couch, 5_mm));
    REQUIRE_MESSAGE(back.has_value(), test::reason(back));
    auto found = locate_acupoints(*back, *atlas);
    REQUIRE_MESSAGE(found.has_value(), test::reason(found));
    return Scene{std::move(person), std::move(*back), std::move(*found)};
  }();
  return scene;
}

const Acupoint& point(const Mapping& mapping, std::string_view name) {
  return *std::find_if(mapping.acupoints.begin(), mapping.acupoints.end(),
                       [&](const Acupoint& p) { return p.name == name; });
}

/// Where a finger is that lies `along_m` towards the head from where the scan has the point.
PalpatedPoint finger(std::string_view name, double along_m, double error_m = 3_mm) {
  return {std::string(name), point(scene().found, name).at_in_couch + Vector3(0.0, 0.0, along_m),
          error_m};
}

Result<Mapping> fixed(const std::vector<PalpatedPoint>& points) {
  return fix_points(scene().found, scene().back, points);
}

std::string refusal(const PalpatedPoint& palpated) {
  return test::reason(fixed({palpated}));
}

}  // namespace

TEST_CASE("the 95 % radius of a Gaussian holds 95 % of it") {
  Random random = make_random(1, "gaussian");
  for (const Vector3& sigma : {Vector3(1, 1, 1), Vector3(1, 1, 0.01), Vector3(1, 0.2, 0.1)}) {
    const Matrix3 covariance = sigma.cwiseAbs2().asDiagonal();
    int inside = 0;
    for (int i = 0; i < 20000; ++i) {
      const Vector3 x(gaussian(random, sigma.x()), gaussian(random, sigma.y()),
                      gaussian(random, sigma.z()));
      inside += x.norm() <= radius95_of(covariance) ? 1 : 0;
    }
    CHECK(inside == doctest::Approx(19000).epsilon(0.01));
  }
}

TEST_CASE("the joint covariance says the same radii as the points do") {
  const Mapping& found = scene().found;
  REQUIRE(found.covariance_m2.rows() ==
          static_cast<Eigen::Index>(3 * (found.acupoints.size() + found.landmarks.size())));
  for (std::size_t i = 0; i < found.acupoints.size(); ++i) {
    const auto row = static_cast<Eigen::Index>(3 * i);
    CHECK(radius95_of(found.covariance_m2.block<3, 3>(row, row)) ==
          doctest::Approx(found.acupoints[i].uncertainty_m));
  }
}

TEST_CASE("a finger where the scan has the point moves nothing, and makes every radius smaller") {
  const auto after = fixed({finger("GV14", 0.0)});
  REQUIRE_MESSAGE(after.has_value(), test::reason(after));
  for (const Acupoint& before : scene().found.acupoints) {
    const Acupoint& now = point(*after, before.name);
    CAPTURE(before.name);
    CHECK((now.at_in_couch - before.at_in_couch).norm() < 1_mm);
    CHECK(now.uncertainty_m < before.uncertainty_m);
  }
  CHECK(after->fixed.size() == 1);
}

TEST_CASE(
    "the other points follow a finger the same way, the near ones more, and stay on the skin") {
  const auto after = fixed({finger("GV4", 10_mm)});
  REQUIRE_MESSAGE(after.has_value(), test::reason(after));
  const auto moved_m = [&](const char* name) {
    return point(*after, name).at_in_couch.z() - point(scene().found, name).at_in_couch.z();
  };
  CHECK(moved_m("GV4") > 6_mm);
  CHECK(moved_m("GV4") < 10_mm);
  CHECK(moved_m("BL50_L") > 2_mm);
  CHECK(moved_m("BL50_L") > moved_m("SI11_L"));
  for (const Acupoint& now : after->acupoints) {
    CHECK(scene().back.nearest(now.at_in_couch).distance_m < 0.5_mm);
    CHECK(now.normal_in_couch.norm() == doctest::Approx(1.0));
  }
}

TEST_CASE("a sure finger is believed, a doubtful one hardly") {
  const auto error_m = [&](double finger_error_m) {
    const auto after = fixed({finger("GV4", 10_mm, finger_error_m)});
    REQUIRE(after);
    const Vector3 at = finger("GV4", 10_mm).at_in_couch;
    return (point(*after, "GV4").at_in_couch - scene().back.nearest(at).at_in_couch).norm();
  };
  CHECK(error_m(0.0) < 1_mm);
  CHECK(error_m(30_mm) > 8_mm);
}

TEST_CASE("a radius reaches back to where the scan had the point, where a finger contradicts it") {
  for (const double along_m : {-12_mm, -6_mm, 6_mm, 12_mm}) {
    const auto after = fixed({finger("BL18_L", along_m)});
    REQUIRE_MESSAGE(after.has_value(), test::reason(after));
    for (const Acupoint& before : scene().found.acupoints) {
      const Acupoint& now = point(*after, before.name);
      CAPTURE(before.name);
      CHECK((now.at_in_couch - before.at_in_couch).norm() < now.uncertainty_m);
    }
  }
}

TEST_CASE("a finger on the next vertebra is refused, also where the scan is not sure") {
  Mapping unsure = scene().found;
  unsure.covariance_m2 *= 4.0;
  for (const auto& [name, instead, side] :
       {std::tuple("GV3", "GV4", "above"), std::tuple("BL21_R", "BL20_R", "above"),
        std::tuple("BL20_L", "BL21_L", "below")}) {
    CAPTURE(std::string(name));
    PalpatedPoint miscounted = finger(instead, 0.0);
    miscounted.name = name;
    const std::string message =
        test::reason(fix_points(unsure, scene().back, std::vector{miscounted}));
    INFO(message);
    CHECK(message.find(fmt::format("the next vertebra {} is", side)) != std::string::npos);
    // Who is sure of the count says how unsure the place is.
    miscounted.error_m = 40_mm;
    CHECK(fix_points(unsure, scene().back, std::vector{miscounted}).has_value());
  }
}

TEST_CASE("a point that an atlas knows in one position only has a name") {
  Atlas atlas;
  atlas.positions.resize(2);
  atlas.positions[0].shape.labels = {"GV4", "GV14"};
  atlas.positions[1].shape.labels = {"GV4", "BL18_L"};
  CHECK(labels_of(atlas) == std::vector<std::string>{"GV4", "GV14", "BL18_L"});
  CHECK(check_names(std::vector{finger("BL18_L", 0.0)}, labels_of(atlas)).has_value());
}

TEST_CASE("points fixed one after the other are as if fixed at once") {
  const PalpatedPoint first = finger("GV14", 5_mm), second = finger("GV4", -4_mm);
  const auto at_once = fixed({first, second});
  const auto one = fixed({first});
  REQUIRE(one);
  const auto both = fix_points(*one, scene().back, std::vector{second});
  REQUIRE(at_once);
  REQUIRE(both);
  CHECK(both->fixed.size() == 2);
  for (const Acupoint& p : at_once->acupoints)
    CHECK((point(*both, p.name).at_in_couch - p.at_in_couch).norm() < 1_mm);
}

TEST_CASE("a finger that contradicts the back, or an unknown point, is refused with the reason") {
  const auto says = [](const std::string& message, std::string_view words) {
    INFO(message);
    return message.find(words) != std::string::npos;
  };
  PalpatedPoint off_skin = finger("GV4", 0.0);
  off_skin.at_in_couch.y() += 60_mm;
  CHECK(says(refusal(off_skin), "mm off the skin of this scan, at most 20 mm"));
  CHECK(says(refusal(finger("GV4", 90_mm)), "times as far as can be"));
  PalpatedPoint other_side = finger("BL47_R", 0.0);
  other_side.name = "BL47_L";
  CHECK(says(refusal(other_side), "other side"));
  PalpatedPoint unknown = finger("GV4", 0.0);
  unknown.name = "GV44";
  CHECK(says(refusal(unknown), "no point is called `GV44`; is `GV4` meant?"));
  CHECK(fixed({unknown}).error().fault == Fault::usage);
  unknown.name = "GV4";
  unknown.at_in_couch.x() = std::nan("");
  CHECK_FALSE(fixed({unknown}).has_value());
}

}  // namespace tuina::body
