// SPDX-License-Identifier: Apache-2.0
// Rubbing is a circle on a curved back: drawn in the tangent plane of the skin, lifted onto the
// skin, and walked at one speed with the tool upright on it.
#include <fmt/core.h>

#include "tuina/core.hpp"
#include "tuina/massage.hpp"
#include "tuina/sim.hpp"

using namespace tuina;

int main() {
  const auto person = sim::parse_person("phantom:medium", BodyPosture::sitting, 1);
  PointCloud skin_in_couch;
  skin_in_couch.points = person->skin_in_couch.vertices;
  const auto back = body::fit_back(skin_in_couch);
  if (!back) {
    fmt::print(stderr, "{}\n", back.error().message);
    return 1;
  }

  // A circle of 30 mm around BL47 on the left, beside the spine; it begins on the headward side.
  constexpr double radius_m = 30_mm;
  const Acupoint& bl47 = person->acupoints[2];
  const body::SurfacePoint centre = back->nearest(bl47.at_in_couch);
  const Vector3 headward_in_couch = Vector3::UnitZ();
  const auto circle = massage::circle_on(*back, centre, radius_m, headward_in_couch, true);
  if (!circle) {
    fmt::print(stderr, "{}\n", circle.error().message);
    return 1;
  }

  // The force follows the normal, so the normal must turn with the skin.
  constexpr int marks = 12;
  const double step_m = circle->length_m() / marks;
  fmt::print("around {}: {:.1f} mm of way, {:.1f} mm for a flat circle\n", bl47.name,
             to_mm(circle->length_m()), to_mm(2.0 * pi * radius_m));
  for (int i = 0; i < marks; ++i) {
    const body::SurfacePoint here = circle->at(i * step_m), next = circle->at((i + 1) * step_m);
    const double spacing_m = (next.at_in_couch - here.at_in_couch).norm();
    const double turn_rad =
        std::acos(std::min(1.0, here.normal_in_couch.dot(next.normal_in_couch)));
    const Vector3 n = here.normal_in_couch;
    fmt::print("{:6.1f} mm: normal ({:5.2f}, {:5.2f}, {:5.2f}), {:.1f} mm and {:4.1f} degrees on\n",
               to_mm(i * step_m), n.x(), n.y(), n.z(), to_mm(spacing_m), to_deg(turn_rad));
  }

  const ContactPath rub = massage::plan_rub(*circle, {.force_n = 15.0, .turns = 3}, "rub BL47_L");
  double peak_n = 0.0, max_m = 0.0;
  for (std::size_t i = 1; i < rub.points.size(); ++i) {
    peak_n = std::max(peak_n, rub.points[i].force_n);
    const double way_m = (rub.points[i].at_in_couch - rub.points[i - 1].at_in_couch).norm();
    max_m = std::max(max_m, way_m / (rub.points[i].time_s - rub.points[i - 1].time_s));
  }
  fmt::print("{}: {} points in {:.1f} s, up to {:.1f} N and {:.0f} mm/s\n", rub.name,
             rub.points.size(), rub.duration_s(), peak_n, to_mm(max_m));
  return 0;
}
