// SPDX-License-Identifier: Apache-2.0
#include "apps/evaluation/acupoints/page.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "apps/evaluation/acupoints/scores.hpp"
#include "tuina/core/units.hpp"
#include "tuina/telemetry/page.hpp"
#include "tuina/telemetry/picture/picture_element.hpp"
#include "tuina/telemetry/plot/svg_plot.hpp"

namespace tuina::app {
namespace {

using nlohmann::json;
namespace paint = telemetry::palette;

constexpr std::array<telemetry::Colour, 5> method_colours = {paint::rub, paint::press, paint::tap,
                                                             paint::grey, paint::stroke};

/// How many of the seven points are nearer than so many millimetres.
std::string share_plot(const std::map<std::string, Score>& scores) {
  telemetry::Plot plot{.title = "share of points within a distance",
                       .x_label = "distance from the true point, mm",
                       .y_label = "share of points, %",
                       .x_low = 0.0,
                       .x_high = 50.0,
                       .y_low = 0.0,
                       .y_high = 100.0,
                       .width_px = 1000,
                       .height_px = 320};
  for (std::size_t m = 0; m < acupoint_methods.size(); ++m) {
    std::vector<double> errors;
    for (const Finding& f : scores.at(acupoint_methods[m]).findings) {
      if (f.of_the_seven) errors.push_back(f.error_mm);
    }
    std::sort(errors.begin(), errors.end());
    telemetry::Series line{.name = acupoint_methods[m], .colour = method_colours[m]};
    line.x.push_back(0.0);
    line.y.push_back(0.0);
    for (std::size_t i = 0; i < errors.size() && errors[i] <= 50.0; ++i) {
      line.x.push_back(errors[i]);
      line.y.push_back(100.0 * static_cast<double>(i + 1) / static_cast<double>(errors.size()));
    }
    plot.series.push_back(std::move(line));
  }
  return telemetry::to_svg(plot);
}

telemetry::Figure portrait(const body::LabelledBody& person, std::size_t index,
                           const Score& surface) {
  const bool sitting = person.position == BodyPosture::sitting;
  telemetry::Scene scene;
  if (person.skin_in_couch.triangles.empty()) return {.svg = ""};
  scene.surface = telemetry::mesh_for_picture(person.skin_in_couch);
  scene.colour = paint::clay;
  double sum = 0.0;
  double count = 0.0;
  for (const Finding& f : surface.findings) {
    if (f.person != index) continue;
    scene.beads.push_back(
        {.at = f.true_in_couch, .radius_m = f.of_the_seven ? 8_mm : 5_mm, .colour = paint::ink});
    scene.beads.push_back(
        {.at = f.found_in_couch, .radius_m = f.of_the_seven ? 8_mm : 5_mm, .colour = paint::press});
    if (!f.of_the_seven) continue;
    sum += f.error_mm;
    count += 1.0;
  }
  const auto picture =
      telemetry::shade(scene, {.toward_eye = sitting ? Vector3::UnitY() : Vector3::UnitZ(),
                               .up = sitting ? Vector3(0.0, 0.0, 1.0) : Vector3(0.0, -1.0, 0.0),
                               .width_px = 420,
                               .height_px = 480});
  const int width = picture.projection.width_px() / 2;
  const int height = picture.projection.height_px() / 2;
  return {
      .svg = fmt::format("<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {} {}\">{}</svg>",
                         width, height, telemetry::picture_element(picture)),
      .name = person.id,
      .caption = fmt::format("{}, {}", person.body_type,
                             count > 0.0 ? fmt::format("{:.1f} mm", sum / count) : "refused")};
}

}  // namespace

std::string acupoint_page(const json& answer, const std::map<std::string, Score>& scores,
                          const std::vector<body::LabelledBody>& people) {
  const json& methods = answer.at("acupoints");
  std::vector<telemetry::Figure> portraits;
  for (std::size_t i = 0; i < people.size(); ++i)
    portraits.push_back(portrait(people[i], i, scores.at("surface")));
  telemetry::Page page(
      {.title = "Acupoints, found and true",
       .over = "tuina evaluate acupoints",
       .badges = {"simulation"},
       .lead = fmt::format("{} people, {} scan. Distances between found and true points in "
                           "millimetres, over the seven points of the thesis unless said.",
                           answer.at("people").get<std::size_t>(),
                           answer.at("scan").get<std::string>())});
  page.section("Methods", "RMSE: root mean square error on the axes of the couch.")
      .table(place_table(methods))
      .table(spread_table(methods));
  page.section("How many points are how near").figure(share_plot(scores));
  page.section("Point by point", "Method surface.").table(point_table(methods.at("surface")));
  const telemetry::Table palpated = palpated_table(scores);
  page.section("When a finger has shown a point", palpated.note).table(palpated);
  page.section("From the couch to the plan").table(time_table(answer.at("times")));
  page.section("Everybody")
      .key({{paint::ink, "true"}, {paint::press, "found by surface"}})
      .figures(portraits, 0);
  return page.str();
}

}  // namespace tuina::app
