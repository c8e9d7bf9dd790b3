// SPDX-License-Identifier: Apache-2.0
#include "apps/evaluation/acupoints/page.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "tuina/core/units.hpp"
#include "tuina/telemetry/picture/picture_element.hpp"
#include "tuina/telemetry/plot/svg_plot.hpp"
#include "tuina/telemetry/report/style.hpp"

namespace tuina::app {
namespace {

using nlohmann::json;
namespace paint = telemetry::palette;

constexpr std::array<telemetry::Colour, 5> method_colours = {paint::rub, paint::press, paint::tap,
                                                             paint::grey, paint::stroke};

std::string cell(const json& group, const char* key = "mean_mm") {
  return group.is_object() && group.contains(key)
             ? fmt::format("<td>{:.1f}</td>", group[key].get<double>())
             : "<td>-</td>";
}

constexpr const char* spread_heads =
    "<th>mean</th><th>SD</th><th>95 %</th><th>max</th><th>x RMSE</th><th>y RMSE</th><th>z "
    "RMSE</th>";

std::string spread_cells(const json& group) {
  const json rmse = group.is_object() ? group.value("rmse_mm", json()) : json();
  return cell(group) + cell(group, "sd_mm") + cell(group, "p95_mm") + cell(group, "max_mm") +
         cell(rmse, "x") + cell(rmse, "y") + cell(rmse, "z");
}

std::string place_table(const json& methods) {
  std::string table =
      "<table><tr><th>mean, mm</th><th>sitting</th><th>slim</th><th>medium</th><th>hefty</th>"
      "<th>prone</th><th>slim</th><th>medium</th><th>hefty</th><th>all points</th></tr>";
  for (const char* method : acupoint_methods) {
    const json& row = methods.at(method);
    table += fmt::format("<tr><td>{}</td>", method);
    for (const char* position : {"sitting", "prone"}) {
      table += cell(row["by_position"][position]);
      for (const char* type : {"slim", "medium", "hefty"}) {
        table += cell(row["by_position_and_type"][position][type]);
      }
    }
    table += cell(row["all_points"]) + "</tr>";
  }
  return table + "</table>";
}

std::string spread_table(const json& methods) {
  std::string table = fmt::format(
      "<table><tr><th>mm</th>{}<th>within the radius</th><th>failures</th>"
      "<th>ms</th></tr>",
      spread_heads);
  for (const char* method : acupoint_methods) {
    const json& row = methods.at(method);
    table += fmt::format("<tr><td>{}</td>", method) + spread_cells(row);
    table += row["coverage"].is_null()
                 ? "<td>-</td>"
                 : fmt::format("<td>{:.0f} %</td>", 100.0 * row["coverage"].get<double>());
    table += fmt::format("<td>{}</td><td>{:.0f}</td></tr>", row["failures"].get<std::size_t>(),
                         row["compute_ms_median"].get<double>());
  }
  return table + "</table>";
}

std::string point_table(const json& row) {
  std::string table = fmt::format("<table><tr><th>point</th>{}</tr>", spread_heads);
  for (const char* point : seven_acupoints) {
    table += fmt::format("<tr><td>{}</td>", point) + spread_cells(row["by_point"][point]) + "</tr>";
  }
  return table + "</table>";
}

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

std::string portrait(const body::LabelledBody& person, std::size_t index, const Score& surface) {
  const bool sitting = person.position == Position::sitting;
  telemetry::Scene scene;
  if (person.skin_in_couch.triangles.empty()) return {};
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
  return fmt::format(
      "<figure><svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {} {}\">{}</svg>"
      "<figcaption><b>{}</b> {}, {}</figcaption></figure>",
      width, height, telemetry::picture_element(picture), telemetry::escaped(person.id),
      person.body_type, count > 0.0 ? fmt::format("{:.1f} mm", sum / count) : "refused");
}

}  // namespace

std::string acupoint_page(const json& answer, const std::map<std::string, Score>& scores,
                          const std::vector<body::LabelledBody>& people) {
  const json& methods = answer.at("acupoints");
  std::string sheet;
  for (std::size_t i = 0; i < people.size(); ++i)
    sheet += portrait(people[i], i, scores.at("surface"));
  const json& times = answer.at("times");
  const auto seconds = [](const json& value) {
    return value.is_null() ? std::string("-") : fmt::format("{:.2f}", value.get<double>());
  };
  return fmt::format(
      "<!doctype html><html lang=\"en\"><meta charset=\"utf-8\">"
      "<meta name=\"viewport\" content=\"width=device-width,initial-scale=1\">"
      "<title>Acupoints, found and true</title><style>{}"
      ".sheet{{display:grid;grid-template-columns:repeat(auto-fill,minmax(170px,1fr));gap:18px}}"
      "figure{{margin:0}}figcaption{{font-size:13px;text-align:center}}</style><main>"
      "<div class=\"over\">tuina evaluate acupoints</div><h1>Acupoints, found and true</h1>"
      "<p class=\"lead\">{} people, {} scan. Distances between found and true points in "
      "millimetres, over the seven "
      "points of the thesis unless said.</p>"
      "<section><h2>Methods</h2><p>RMSE: root mean square error on the axes of the "
      "couch.</p>{}{}</section>"
      "<section><h2>How many points are how near</h2>{}</section>"
      "<section><h2>Point by point</h2><p>Method surface.</p>{}</section>"
      "<section><h2>From the couch to the plan</h2><table><tr><th>seconds, "
      "median</th><th>scan</th><th>map</th>"
      "<th>plan</th><th>all</th><th>thesis</th><th>teach and "
      "play</th></tr><tr><td></td><td>{}</td><td>{}</td>"
      "<td>{}</td><td>{}</td><td>35</td><td>75</td></tr></table></section>"
      "<section class=\"long\"><h2>Everybody</h2><ul class=\"key\"><li><i "
      "style=\"background:{}\"></i>true</li>"
      "<li><i style=\"background:{}\"></i>found by surface</li></ul><div "
      "class=\"sheet\">{}</div></section>"
      "</main></html>\n",
      telemetry::report_style, answer.at("people").get<std::size_t>(),
      answer.at("scan").get<std::string>(), place_table(methods), spread_table(methods),
      share_plot(scores), point_table(methods.at("surface")), seconds(times["scan_s"]),
      seconds(times["map_s"]), seconds(times["plan_s"]), seconds(times["total_s"]),
      telemetry::css(paint::ink), telemetry::css(paint::press), sheet);
}

}  // namespace tuina::app
