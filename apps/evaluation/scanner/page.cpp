// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "apps/evaluation/scanner/proof.hpp"
#include "tuina/core/units.hpp"
#include "tuina/telemetry/picture/picture_element.hpp"
#include "tuina/telemetry/picture/shaded_picture.hpp"
#include "tuina/telemetry/plot/svg_plot.hpp"
#include "tuina/telemetry/report/style.hpp"

namespace tuina::app {
namespace {

using telemetry::Plot;
using telemetry::Series;
namespace palette = telemetry::palette;

template <typename Trial, typename Of>
std::vector<double> each(const std::vector<Trial>& trials, Of&& of) {
  std::vector<double> values;
  for (const Trial& trial : trials) values.push_back(of(trial));
  return values;
}

std::string section(const std::string& title, const std::string& what, const std::string& content) {
  return fmt::format("<section><h2>{}</h2><p>{}</p>{}</section>\n", title, what, content);
}

std::string wide(const std::string& svg) {
  return "<div class=\"wide\">" + svg + "</div>";
}

std::string walls_section(const ScannerProof& proof) {
  const auto& walls = proof.walls;
  if (walls.empty()) return {};
  const auto depth = each(walls, [](const WallTrial& w) { return w.depth_m; });
  const auto mm_of = [&](auto which, auto part) {
    return each(walls, [&](const WallTrial& w) { return to_mm((w.*which).*part); });
  };
  const Series printed{.name = "thesis, printed",
                       .x = {0.35, 0.9},
                       .y = {3.0, 3.0},
                       .colour = palette::press,
                       .width_px = 3.0};
  const Series printed_far{.name = "",
                           .x = {1.75},
                           .y = {6.21},
                           .colour = palette::press,
                           .width_px = 5.0,
                           .dots = true};
  Plot near{.title = "Depth error over distance",
            .x_label = "distance of the wall, m",
            .y_label = "error, mm RMS",
            .x_high = 1.8,
            .y_low = 0.0,
            .y_high = 8.0,
            .height_px = 330};
  near.series = {
      printed,
      printed_far,
      {.name = "(4.1) fitted",
       .x = depth,
       .y = mm_of(&WallTrial::fitted, &DepthErrors::rms_m),
       .colour = palette::tap,
       .dashed = true},
      {.name = "tuina",
       .x = depth,
       .y = mm_of(&WallTrial::ours, &DepthErrors::rms_m),
       .colour = palette::rub,
       .width_px = 2.6},
      {.name = "systematic part",
       .x = depth,
       .y = mm_of(&WallTrial::ours, &DepthErrors::systematic_m),
       .colour = palette::rub,
       .width_px = 1.2,
       .dashed = true},
      {.name = "tuina, speckle",
       .x = depth,
       .y = each(proof.speckled_walls, [](const WallTrial& w) { return to_mm(w.ours.rms_m); }),
       .colour = palette::stroke}};
  Plot far{.title = "Depth error of the nominal geometry",
           .x_label = "distance of the wall, m",
           .y_label = "error, mm RMS",
           .y_low = 0.0};
  far.series = {{.name = "(4.1)-(4.3), nominal",
                 .x = depth,
                 .y = mm_of(&WallTrial::nominal, &DepthErrors::rms_m),
                 .colour = palette::ink},
                {.name = "(4.1) fitted",
                 .x = depth,
                 .y = mm_of(&WallTrial::fitted, &DepthErrors::rms_m),
                 .colour = palette::tap,
                 .dashed = true},
                {.name = "tuina",
                 .x = depth,
                 .y = mm_of(&WallTrial::ours, &DepthErrors::rms_m),
                 .colour = palette::rub,
                 .width_px = 2.6}};
  Plot ladder{.title = "Random error, predicted and measured",
              .x_label = "distance of the wall, m",
              .y_label = "random error, mm",
              .y_low = 0.0};
  ladder.series = {{.name = "predicted by (4.3)",
                    .x = depth,
                    .y = each(walls, [](const WallTrial& w) { return to_mm(w.predicted_m); }),
                    .colour = palette::grey,
                    .width_px = 3.5},
                   {.name = "measured",
                    .x = depth,
                    .y = mm_of(&WallTrial::ours, &DepthErrors::random_m),
                    .colour = palette::rub,
                    .dots = true}};
  std::string table =
      "<div class=\"wide\"><table><tr><th>distance, m</th><th>nominal, mm</th><th>fitted, mm</th>"
      "<th>tuina, mm</th><th>systematic</th><th>random</th><th>predicted</th><th>line, px</th>"
      "<th>bound, px</th><th>with speckle, mm</th></tr>";
  for (std::size_t i = 0; i < walls.size(); ++i) {
    const WallTrial& w = walls[i];
    table += fmt::format(
        "<tr><td>{:.2f}</td><td>{:.2f}</td><td>{:.2f}</td><td><b>{:.2f}</b></td><td>{:.2f}</td>"
        "<td>{:.2f}</td><td>{:.2f}</td><td>{:.3f}</td><td>{:.3f}</td><td>{:.2f}</td></tr>",
        w.depth_m, to_mm(w.nominal.rms_m), to_mm(w.fitted.rms_m), to_mm(w.ours.rms_m),
        to_mm(w.ours.systematic_m), to_mm(w.ours.random_m), to_mm(w.predicted_m), w.line_px,
        w.bound_px, to_mm(proof.speckled_walls[i].ours.rms_m));
  }
  table += "</table></div>";
  return section(
             "Figure 4-9 again: a wall, near and far",
             "Several scanners, each a little off its drawing as a hand builds it, before a white "
             "wall. Nominal: the equations with the dimensions on the drawing. Fitted: (4.1) "
             "with its two constants fitted to walls at 0.5, 0.8 and 1.5 m. Tuina: calibrated "
             "from 40 poses of a board. Speckle: 0.1 px, correlated along the line. Red: what the "
             "thesis "
             "prints, within 3 mm to 0.9 m and 6.21 mm at 1.75 m.",
             wide(to_svg(near)) + wide(to_svg(far)) + table) +
         section("The ladder from line noise to range error",
                 "What the noise of the line makes of the depth by geometry alone, beside what is "
                 "measured. Below 0.6 m the line is clipped and narrower noise than the bound of "
                 "an unclipped line cannot be had.",
                 wide(to_svg(ladder)));
}

std::string picture(const PointCloud& cloud, const Vector3& toward_eye, double cell_m,
                    int width_px) {
  telemetry::Scene scene;
  scene.surface = telemetry::mesh_scan(cloud, toward_eye, cell_m);
  scene.colour = palette::clay;
  if (scene.surface.mesh.triangles.empty()) return {};
  const auto shaded = telemetry::shade(
      scene, {.toward_eye = toward_eye, .width_px = 2 * width_px, .height_px = 2 * width_px});
  return fmt::format(
      "<svg viewBox=\"0 0 {0:.0f} {1:.0f}\" width=\"{0:.0f}\" height=\"{1:.0f}\">{2}</svg>",
      shaded.image.width / 2.0, shaded.image.height / 2.0, telemetry::picture_element(shaded));
}

std::string bodies_section(const ScannerProof& proof) {
  if (!proof.box || !proof.sphere) return {};
  PointCloud person;
  for (std::size_t i = 0; i < proof.back_in_couch.size(); ++i) {
    if (proof.back_in_couch.points[i].z() < 0.02) continue;  // the seat
    person.points.push_back(proof.back_in_couch.points[i]);
    person.normals.push_back(proof.back_in_couch.normals[i]);
  }
  const Vector3 from_behind(0.25, 1.0, 0.3);
  const auto& box = *proof.box;
  std::string content =
      "<div class=\"even\"><div>" + picture(box.cloud, from_behind.normalized(), 0.003, 420) +
      fmt::format(
          "<p class=\"note\">The box of the thesis, 150 x 150 x 200 mm, a "
          "corner towards the scanner at 1 m: edges {:.1f}, {:.1f} and "
          "{:.1f} mm, angles {:.1f}, {:.1f} and {:.1f} degrees, faces flat "
          "to {:.2f} mm.</p></div><div>",
          to_mm(box.found.edges_m[0]), to_mm(box.found.edges_m[1]), to_mm(box.found.edges_m[2]),
          to_deg(box.found.angles_rad[0]), to_deg(box.found.angles_rad[1]),
          to_deg(box.found.angles_rad[2]), to_mm(box.found.flatness_m)) +
      picture(proof.sphere->cloud, Vector3::UnitY(), 0.003, 420) +
      fmt::format(
          "<p class=\"note\">A sphere of 75 mm radius at 1 m: radius "
          "{:.2f} mm, round to {:.2f} mm.</p></div></div>",
          to_mm(0.5 * proof.sphere->found.diameter_m), to_mm(proof.sphere->found.rms_m)) +
      picture(person, Vector3::UnitY(), 0.003, 620) +
      fmt::format(
          "<p class=\"note\">The back of a phantom who sits, from 1.1 m: "
          "{} points of one sweep of six seconds.</p>",
          person.size());
  return section(
      "A box, a sphere, a back",
      "Clouds of single sweeps with a calibration from 40 poses, meshed to be looked at.", content);
}

std::string back_row(const std::string& name, const BackTrial& back) {
  if (back.refused) {
    return fmt::format("<tr><td>{}</td><td colspan=\"5\">refused</td></tr>", name);
  }
  return fmt::format(
      "<tr><td>{}</td><td>{:.2f}</td><td>{:.2f}</td><td>{:.3f}</td><td>{:.2f}</td><td>{:.1f}</td>"
      "</tr>",
      name, to_mm(back.rms_m), to_mm(back.expected_m), 100.0 * back.outlier_share,
      100.0 * back.seen_share, 100.0 * back.covered_points);
}

std::string backs_section(const ScannerProof& proof) {
  if (proof.backs.empty()) return {};
  std::string table =
      "<div class=\"wide\"><table><tr><th>condition</th><th>RMS, mm</th><th>the scan expects, "
      "mm</th><th>outliers, %</th><th>seen, %</th><th>acupoints covered, %</th></tr>";
  for (const auto& [key, back] : proof.backs) {
    std::string name = key;
    std::replace(name.begin(), name.end(), '_', ' ');
    table += back_row(name, back);
  }
  return section("Backs at 1.1 m",
                 fmt::format("{} phantoms, sitting and prone, each scanned once with a calibration "
                             "of its own. An outlier lies more than 5 mm from the surface; seen is "
                             "the share of the rows in which laser and camera both see something.",
                             proof.people),
                 table + "</table></div>");
}

std::string curves_section(const ScannerProof& proof) {
  if (proof.curves.empty()) return {};
  std::string content = "<div class=\"even\">";
  for (const Curve& curve : proof.curves) {
    Plot plot{.title = curve.name,
              .x_label = curve.x_label,
              .y_label = "RMS, mm",
              .y_low = 0.0,
              .width_px = 520,
              .height_px = 230};
    const auto rms =
        each(curve.y, [](const BackTrial& b) { return b.refused ? std::nan("") : to_mm(b.rms_m); });
    double most = 1.0;
    for (const double value : rms) most = std::max(most, std::isnan(value) ? 0.0 : 1.1 * value);
    plot.y_high = most;
    plot.series = {
        {.name = "true error", .x = curve.x, .y = rms, .colour = palette::rub, .width_px = 2.4},
        {.name = "the scan expects",
         .x = curve.x,
         .y = each(
             curve.y,
             [](const BackTrial& b) { return b.refused ? std::nan("") : to_mm(b.expected_m); }),
         .colour = palette::grey,
         .dashed = true}};
    const auto refused = static_cast<int>(
        std::count_if(curve.y.begin(), curve.y.end(), [](const auto& b) { return b.refused; }));
    content += "<div>" + to_svg(plot);
    for (std::size_t i = 0; refused > 0 && i < curve.y.size(); ++i) {
      if (!curve.y[i].refused) continue;
      content += fmt::format("<p class=\"note\">From {:g} on the scan is refused.</p>", curve.x[i]);
      break;
    }
    content += "</div>";
  }
  return section("What spoils a scan, one by one",
                 "The same backs while one condition is made worse. What the scan itself expects "
                 "covers noise and calibration; it cannot know of a person who moves or of a "
                 "latency that is wrong.",
                 content + "</div>");
}

std::string devices_section(const ScannerProof& proof) {
  if (proof.backs.empty() || proof.walls.empty()) return {};
  const auto at_1_m = std::find_if(proof.walls.begin(), proof.walls.end(), [](const WallTrial& w) {
    return std::abs(w.depth_m - 1.0) < 1e-6;
  });
  const auto speckled =
      proof.speckled_walls[static_cast<std::size_t>(at_1_m - proof.walls.begin())];
  const std::string ours = fmt::format(
      "<tr><td>this scanner, simulated</td><td>70 USD</td><td class=\"l\">{:.2f} mm RMS at 1 m, "
      "{:.2f} "
      "with speckle; a back at 1.1 m {:.2f} and {:.2f}</td><td class=\"l\">6 s</td></tr>",
      to_mm(at_1_m->ours.rms_m), to_mm(speckled.ours.rms_m),
      to_mm(proof.backs.at("noise_only").rms_m), to_mm(proof.backs.at("speckle").rms_m));
  return section(
      "Beside what can be bought",
      "Figures of the others are as published by makers and testers, not measured here; those of "
      "this scanner come from a simulation without lens blur, motion blur and scattering in skin.",
      "<div class=\"wide\"><table><tr><th>device</th><th>price</th><th class=\"l\">error</th>"
      "<th class=\"l\">time</th></tr>" +
          ours +
          "<tr><td>scanner of the thesis</td><td>70 USD</td><td class=\"l\">within 3 mm to 0.9 m, "
          "6.21 mm at 1.75 m</td><td class=\"l\">stop and shoot</td></tr>"
          "<tr><td>RealSense D435</td><td>280 USD</td><td class=\"l\">2.4 mm of noise at 1 m, "
          "offsets "
          "to 8 mm before correction</td><td class=\"l\">one frame, 33 ms</td></tr>"
          "<tr><td>RealSense D405</td><td>-</td><td class=\"l\">2 % at 0.5 m</td><td "
          "class=\"l\">one "
          "frame</td></tr>"
          "<tr><td>Femto Bolt</td><td>-</td><td class=\"l\">below 11 mm + 0.1 %</td><td "
          "class=\"l\">one "
          "frame</td></tr>"
          "<tr><td>RPLidar A1</td><td>-</td><td class=\"l\">about 1 %, one plane</td><td "
          "class=\"l\">-"
          "</td></tr></table></div>");
}

}  // namespace

std::string page_of(const ScannerProof& proof) {
  return fmt::format(
             "<!doctype html><html lang=\"en\"><head><meta charset=\"utf-8\"><meta "
             "name=\"viewport\" content=\"width=device-width,initial-scale=1\"><title>The "
             "scanner, measured</title><style>{}</style></head><body><main>"
             "<div class=\"over\"><span>tuina</span><span class=\"badge\">simulation</span></div>"
             "<h1>The 70-dollar scanner, measured</h1><p class=\"lead\">A line laser, a webcam and "
             "a "
             "servo, simulated with noise, clipping, shadows and a motor that counts in steps of "
             "0.29 degrees.</p>",
             telemetry::report_style) +
         walls_section(proof) + backs_section(proof) + curves_section(proof) +
         bodies_section(proof) + devices_section(proof) + "</main></body></html>\n";
}

}  // namespace tuina::app
