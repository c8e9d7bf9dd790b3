// SPDX-License-Identifier: Apache-2.0
#include "tuina/baselines/two_planes.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "tuina/body/learn/labelled_body.hpp"
#include "tuina/core/random.hpp"
#include "tuina/core/units.hpp"
#include "tuina/massage/technique/stroke.hpp"
#include "tuina/sim/person/phantom.hpp"

namespace tuina::baselines {
using namespace body;

TEST_CASE("a path that bends evenly has the jerk of its circle, however its points are spread") {
  constexpr double radius_m = 0.2;
  constexpr double speed = 0.06;
  std::vector<Vector3> arc;
  for (double angle = 0.0; angle < 1.5; angle += arc.size() % 2 == 0 ? 1e-3 : 2e-3) {
    arc.emplace_back(radius_m * std::cos(angle), radius_m * std::sin(angle), 0.0);
  }
  const double jerk = std::pow(speed, 3) / std::pow(radius_m, 2);
  CHECK(mean_square_jerk(arc, speed, 0.2) == doctest::Approx(jerk * jerk).epsilon(0.02));
}

TEST_CASE("strokes are at least ten times smoother than the paths of the two planes, Fig. 5-12") {
  for (const BodyPosture position : {BodyPosture::sitting, BodyPosture::prone}) {
    const auto person = sim::make_phantom(sim::draw_phantom(sim::BodyType::medium, 6), position);
    PointCloud scan{.points = sample(person.skin_in_couch, 5_mm).points};
    Random random = make_random(1, "scan noise");
    const Vector3 out = position == BodyPosture::sitting ? Vector3::UnitY() : Vector3::UnitZ();
    for (Vector3& p : scan.points) p += gaussian(random, 0.4_mm) * out;
    const auto back = fit_back(scan);
    REQUIRE(back);
    for (const std::size_t side : {0U, 1U}) {
      const std::vector<Vector3> places = {person.acupoints[side].at_in_couch,
                                           person.acupoints[2 + side].at_in_couch,
                                           person.acupoints[4 + side].at_in_couch};
      const auto stroke = massage::line_through(*back, places);
      REQUIRE(stroke);
      std::vector<Vector3> ours;
      for (double s = 0.0; s < stroke->length_m(); s += 2_mm) {
        ours.push_back(stroke->at(s).at_in_couch);
      }
      // As far apart as the knots of a SurfaceCurve.
      const auto older = two_plane_path(scan, *back, places, 15_mm);
      const double ratio = mean_square_jerk(older, 0.06) / mean_square_jerk(ours, 0.06);
      MESSAGE(std::string(name_of(position)), ": mean square jerk of the two planes is ", ratio,
              " times ours");
      CHECK(ratio > 10.0);
    }
  }
}

}  // namespace tuina::baselines
