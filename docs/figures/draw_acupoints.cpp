// SPDX-License-Identifier: Apache-2.0
// Draws the figures of docs/acupoints.md: the steps of the method, the morphing of the thesis, and
// its paths beside those of the method before it. Usage: draw_acupoints ATLAS OUT_FOLDER
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "tuina/baselines/plane_picture.hpp"
#include "tuina/baselines/two_planes.hpp"
#include "tuina/body/acupoints.hpp"
#include "tuina/body/correction.hpp"
#include "tuina/core/io/file.hpp"
#include "tuina/core/units.hpp"
#include "tuina/massage/technique/stroke.hpp"
#include "tuina/scanner/sweep.hpp"
#include "tuina/sim/person/phantom.hpp"
#include "tuina/sim/scanner/laser_scanner.hpp"
#include "tuina/telemetry/picture/picture_element.hpp"
#include "tuina/telemetry/plot/svg_plot.hpp"

using namespace tuina;
namespace palette = telemetry::palette;

namespace {

constexpr int tile_px = 250;
constexpr int picture_px = 240;  // height
constexpr int row_px = 312;

std::string words(double x, double y, std::string_view text, bool strong = false,
                  telemetry::Colour colour = palette::grey) {
  return fmt::format(
      "<text x=\"{:.0f}\" y=\"{:.0f}\" text-anchor=\"middle\" fill=\"{}\"{}>{}</text>", x, y,
      telemetry::css(strong ? palette::ink : colour), strong ? " font-weight=\"600\"" : "",
      telemetry::escaped(text));
}

std::string page(int columns, int rows, std::string_view title, const std::string& drawn) {
  return fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0} {1}\" width=\"{0}\" "
      "height=\"{1}\" font-family=\"Inter,system-ui,'Segoe UI',Helvetica,Arial,sans-serif\" "
      "font-size=\"11\"><title>{2}</title><rect width=\"{0}\" height=\"{1}\" "
      "fill=\"#fff\"/>{3}</svg>\n",
      columns * tile_px, rows * row_px, telemetry::escaped(title), drawn);
}

/// One picture with its name above and what it says below.
struct Tile {
  std::string picture;
  std::string name;
  std::vector<std::string> says;
};

std::string laid_out(const std::vector<Tile>& tiles, int columns) {
  std::string drawn;
  for (std::size_t i = 0; i < tiles.size(); ++i) {
    const int column = static_cast<int>(i) % columns;
    const int row = static_cast<int>(i) / columns;
    drawn += fmt::format("<g transform=\"translate({} {})\">", column * tile_px, row * row_px);
    drawn += words(0.5 * tile_px, 18, tiles[i].name, true);
    drawn += fmt::format("<g transform=\"translate(0 28)\">{}</g>", tiles[i].picture);
    double y = 28 + picture_px + 14;
    for (const std::string& line : tiles[i].says) {
      drawn += words(0.5 * tile_px, y, line);
      y += 15;
    }
    drawn += "</g>";
  }
  return drawn;
}

telemetry::View view_of(BodyPosture position) {
  const bool sitting = position == BodyPosture::sitting;
  return {.toward_eye = sitting ? Vector3::UnitY() : Vector3::UnitZ(),
          .up = sitting ? Vector3(Vector3::UnitZ()) : Vector3(-Vector3::UnitY()),
          .width_px = 2 * (tile_px - 10),
          .height_px = 2 * picture_px};
}

std::string centred(const telemetry::ShadedPicture& picture) {
  return telemetry::picture_element(picture, 0.5 * (tile_px - 0.5 * picture.projection.width_px()));
}

/// A person with the scan that the simulated scanner makes.
struct Scanned {
  sim::Person person;
  PointCloud scan;
  body::BackSurface back;
};

Result<Scanned> scanned(sim::BodyType type, std::uint64_t seed, BodyPosture position) {
  auto person = sim::make_phantom(sim::draw_phantom(type, seed), position);
  sim::LaserScanner unit(person.skin_in_couch, position, {}, seed);
  auto scan =
      scanner::scan_sweep(unit, unit, sim::believed_calibration(unit.true_calibration(), seed));
  if (!scan) return tl::unexpected(scan.error());
  auto back = body::fit_back(scan->cloud_in_couch, {.position = position});
  if (!back) return tl::unexpected(back.error());
  return Scanned{std::move(person), std::move(scan->cloud_in_couch), std::move(*back)};
}

telemetry::Scene clay(const Scanned& seen) {
  telemetry::Scene scene;
  scene.surface = telemetry::mesh_scan(seen.back.points(), view_of(seen.back.position()).toward_eye,
                                       seen.back.spacing_m());
  scene.colour = palette::clay;
  return scene;
}

// --- The steps of `surface` -------------------------------------------------------------------

Tile tile_of_scan(const Scanned& seen) {
  telemetry::Scene scene = clay(seen);
  return {centred(telemetry::shade(scene, view_of(seen.back.position()))),
          "1  the person",
          {fmt::format("{} points, thinned to {}", seen.scan.size(), seen.back.points().size()),
           "couch and room are left out"}};
}

Tile tile_of_outline(const Scanned& seen, const body::Outline& outline) {
  telemetry::Scene scene = clay(seen);
  const Transform couch_from_back = outline.back_from_couch.inverse();
  for (const body::FeatureLine& line : body::feature_lines(outline)) {
    telemetry::Thread thread{.radius_m = 3_mm, .colour = palette::stroke};
    for (int k = 0; k <= 60; ++k) {
      const Vector2 at = line.p + k / 60.0 * (line.q - line.p);
      const auto hit = seen.back.along(couch_from_back * Vector3(at.x(), 0.6, at.y()),
                                       -couch_from_back.linear().col(1));
      if (hit) thread.points.push_back(hit->at_in_couch + 2_mm * hit->normal_in_couch);
    }
    if (thread.points.size() > 1) scene.threads.push_back(std::move(thread));
  }
  return {centred(telemetry::shade(scene, view_of(seen.back.position()))),
          "2  the outline",
          {"the feature lines of field_morphing;", "tells raised arms"}};
}

/// The model's skin as beads over the scan, coloured one by one.
template <typename ColourOf>
std::string beads(const Scanned& seen, const body::Places& skin, const ColourOf& colour_of) {
  telemetry::Scene scene = clay(seen);
  const Vector3 towards = view_of(seen.back.position()).toward_eye;
  for (Eigen::Index i = 0; i < skin.cols(); ++i) {
    // Lifted, so that a bead that lies a little below the skin is still seen.
    scene.beads.push_back(
        {.at = Vector3(skin.col(i)) + 12_mm * towards, .radius_m = 3.2_mm, .colour = colour_of(i)});
  }
  return centred(telemetry::shade(scene, view_of(seen.back.position())));
}

std::vector<Tile> tiles_of_fit(const Scanned& seen, const body::ShapeModel& model) {
  const auto rigid = body::fit_shape(model, seen.back, {.modes = 0});
  const auto fit = body::fit_shape(model, seen.back);
  const Eigen::Index n = model.skin_points();
  const body::Places mean = rigid.couch_from_model * model.mean.leftCols(n);
  const body::Places shaped = fit.couch_from_model * body::placed(model, fit.weights, 0, n);
  std::vector<double> off_mm;
  for (Eigen::Index i = 0; i < n; ++i) {
    const auto skin = seen.back.nearest(shaped.col(i));
    const bool beside = (skin.at_in_couch - shaped.col(i)).norm() > 15_mm;
    off_mm.push_back(
        beside ? -1.0
               : to_mm(std::abs(skin.normal_in_couch.dot(shaped.col(i) - skin.at_in_couch))));
  }
  const auto rigid_off = [&](Eigen::Index i) {
    const auto skin = seen.back.nearest(mean.col(i));
    return std::min(1.0, to_mm((skin.at_in_couch - mean.col(i)).norm()) / 30.0);
  };
  return {
      {beads(seen, mean, [&](Eigen::Index i) { return telemetry::hardness_colour(rigid_off(i)); }),
       "3  the mean back, laid on",
       {fmt::format("best of {} beginnings, {:.0f} mm off (RMS)",
                    seen.back.position() == BodyPosture::sitting ? 7 : 14, to_mm(rigid.residual_m)),
        "yellow: on it, violet: 30 mm off"}},
      {beads(seen, shaped,
             [&](Eigen::Index i) {
               return off_mm[static_cast<std::size_t>(i)] < 0.0 ? palette::press : palette::rub;
             }),
       "4  the shape of this person",
       {fmt::format("{} modes; blue: seen by the scan ({:.0f} %)", model.modes.cols(),
                    100.0 * fit.seen),
        "red: beyond its rim, told by the modes"}},
      {beads(seen, shaped,
             [&](Eigen::Index i) {
               return telemetry::hardness_colour(
                   std::clamp(off_mm[static_cast<std::size_t>(i)] / 10.0, 0.0, 1.0));
             }),
       "5  what is left",
       {fmt::format("{:.1f} mm off (RMS), moved onto it next", to_mm(fit.residual_m)),
        "yellow: 0, violet: 10 mm"}}};
}

Result<Tile> tile_of_points(const Scanned& seen, const body::Atlas& atlas) {
  const auto mapping = body::locate_acupoints(seen.back, atlas);
  if (!mapping) return tl::unexpected(mapping.error());
  telemetry::Scene scene = clay(seen);
  double sum_mm = 0.0;
  for (std::size_t i = 0; i < seven_acupoints.size(); ++i) {
    const Acupoint& found = mapping->acupoints[i];
    const Vector3& truth = seen.person.acupoints[i].at_in_couch;
    sum_mm += to_mm((found.at_in_couch - truth).norm()) / 7.0;
    scene.discs.push_back(
        {.at = found.at_in_couch, .radius_m = found.uncertainty_m, .colour = palette::rub});
    scene.beads.push_back(
        {.at = truth + 3_mm * found.normal_in_couch, .radius_m = 5_mm, .colour = palette::ink});
    scene.beads.push_back({.at = found.at_in_couch + 3_mm * found.normal_in_couch,
                           .radius_m = 5_mm,
                           .colour = palette::press});
  }
  return Tile{centred(telemetry::shade(scene, view_of(seen.back.position()))),
              "6  the points",
              {fmt::format("red: found, {:.1f} mm off; black: true", sum_mm),
               "disc: holds the true one in 95 of 100"}};
}

Result<std::string> method_figure(const body::Atlas& atlas) {
  const auto seen = scanned(sim::BodyType::hefty, 21, BodyPosture::sitting);
  if (!seen) return tl::unexpected(seen.error());
  const auto outline = body::find_outline(seen->back);
  if (!outline) return tl::unexpected(outline.error());
  std::vector<Tile> tiles = {tile_of_scan(*seen), tile_of_outline(*seen, *outline)};
  for (Tile& tile : tiles_of_fit(*seen, atlas.of(BodyPosture::sitting)->shape)) {
    tiles.push_back(std::move(tile));
  }
  auto points = tile_of_points(*seen, atlas);
  if (!points) return tl::unexpected(points.error());
  tiles.push_back(std::move(*points));
  return page(3, 2, "From a scan to the points, step by step", laid_out(tiles, 3));
}

// --- The morphing of the thesis ---------------------------------------------------------------

std::string plane_picture(const baselines::PlanePicture& picture,
                          const std::vector<body::FeatureLine>& lines) {
  const double scale = std::min((tile_px - 16.0) / picture.image.width,
                                static_cast<double>(picture_px) / picture.image.height);
  const double x0 = std::round(0.5 * (tile_px - scale * picture.image.width));
  std::string drawn = telemetry::picture_element(picture.image, x0, scale * picture.image.width,
                                                 scale * picture.image.height);
  for (const body::FeatureLine& line : lines) {
    const Vector2 p = scale * picture.pixel_of(line.p);
    const Vector2 q = scale * picture.pixel_of(line.q);
    drawn += fmt::format(
        "<path d=\"M{:.1f} {:.1f}L{:.1f} {:.1f}\" stroke=\"{}\" stroke-width=\"2\" "
        "stroke-linecap=\"round\" opacity=\"0.85\"/>",
        x0 + p.x(), p.y(), x0 + q.x(), q.y(), telemetry::css(palette::stroke));
  }
  return drawn;
}

Result<std::string> morphing_figure() {
  const auto standard = scanned(sim::BodyType::medium, 3, BodyPosture::sitting);
  const auto person = scanned(sim::BodyType::hefty, 21, BodyPosture::sitting);
  if (!standard || !person) return tl::unexpected((standard ? person : standard).error());
  const auto of_standard = body::find_outline(standard->back);
  const auto of_person = body::find_outline(person->back);
  if (!of_standard || !of_person) {
    return tl::unexpected((of_standard ? of_person : of_standard).error());
  }
  std::vector<Vector2> marks;
  for (std::size_t i = 0; i < seven_acupoints.size(); ++i) {
    marks.push_back(of_standard->plane(standard->person.acupoints[i].at_in_couch));
  }
  const auto standard_lines = body::feature_lines(*of_standard);
  const auto person_lines = body::feature_lines(*of_person);
  const auto a = baselines::project(standard->back, *of_standard, marks);
  const auto b = baselines::project(person->back, *of_person, {});
  const auto morphed = baselines::morph(a, standard_lines, b, person_lines, 0.5);
  double off_mm = 0.0;
  for (std::size_t i = 0; i < marks.size(); ++i) {
    const Vector2 truth = of_person->plane(person->person.acupoints[i].at_in_couch);
    const auto shown = baselines::found_mark(morphed, static_cast<int>(i));
    if (shown) off_mm += to_mm((*shown - truth).norm()) / static_cast<double>(marks.size());
  }
  const std::vector<Tile> tiles = {
      {plane_picture(a, standard_lines),
       "the standard model",
       {"on the plane of the back, with stickers", "green: the feature lines"}},
      {plane_picture(b, person_lines), "the person", {"the same lines, found on another"}},
      {plane_picture(morphed, {}),
       "morphed, \u03b1 = 0.5",
       {"the standard in the person's shape;",
        fmt::format("stickers {:.0f} mm off the true points", off_mm)}}};
  return page(3, 1, "Field morphing, [thesis] Fig. 5-8", laid_out(tiles, 3));
}

// --- Paths ------------------------------------------------------------------------------------

Result<std::string> path_figure() {
  const auto seen = scanned(sim::BodyType::medium, 6, BodyPosture::sitting);
  if (!seen) return tl::unexpected(seen.error());
  constexpr double speed = 0.06;
  telemetry::Scene older = clay(*seen);
  telemetry::Scene ours = clay(*seen);
  double older_jerk = 0.0;
  double our_jerk = 0.0;
  for (const std::size_t side : {0U, 1U}) {
    const std::vector<Vector3> places = {seen->person.acupoints[side].at_in_couch,
                                         seen->person.acupoints[2 + side].at_in_couch,
                                         seen->person.acupoints[4 + side].at_in_couch};
    const auto line = massage::line_through(seen->back, places);
    if (!line) return tl::unexpected(line.error());
    telemetry::Thread smooth{.points = {}, .radius_m = 3_mm, .colour = palette::stroke};
    std::vector<Vector3> along;
    for (double way = 0.0; way < line->length_m(); way += 2_mm) {
      along.push_back(line->at(way).at_in_couch);
      smooth.points.push_back(along.back() + 3_mm * line->at(way).normal_in_couch);
    }
    const auto tortuous = baselines::two_plane_path(seen->scan, seen->back, places, 15_mm);
    older_jerk += 0.5 * baselines::mean_square_jerk(tortuous, speed);
    our_jerk += 0.5 * baselines::mean_square_jerk(along, speed);
    telemetry::Thread bent{.points = tortuous, .radius_m = 3_mm, .colour = palette::press};
    for (Vector3& p : bent.points) p += 9_mm * Vector3::UnitY();
    older.threads.push_back(std::move(bent));
    ours.threads.push_back(std::move(smooth));
  }
  const std::vector<Tile> tiles = {
      {centred(telemetry::shade(older, view_of(BodyPosture::sitting))),
       "two planes",
       {"nearest scan points to lines on two planes",
        fmt::format("mean square jerk {:.3g} m\u00b2/s\u2076", older_jerk)}},
      {centred(telemetry::shade(ours, view_of(BodyPosture::sitting))),
       "tuina",
       {"a spline on the smoothed skin",
        fmt::format("mean square jerk {:.3g} m\u00b2/s\u2076 (1/{:.0f})", our_jerk,
                    older_jerk / our_jerk)}}};
  std::printf("mean square jerk: two planes %.4g, tuina %.4g m2/s6\n", older_jerk, our_jerk);
  return page(2, 1, "Strokes, [thesis] Fig. 5-12", laid_out(tiles, 2));
}

bool write(const Result<std::string>& figure, const std::string& path) {
  const auto written = figure ? write_file(path, *figure) : Result<void>();
  if (figure && written) return true;
  fmt::print(stderr, "{}: {}\n", path, figure ? written.error().message : figure.error().message);
  return false;
}

}  // namespace

int main(int count, char** arguments) {
  if (count != 3) return 1;
  const auto atlas = body::read_atlas(arguments[1]);
  if (!atlas) {
    fmt::print(stderr, "{}\n", atlas.error().message);
    return 1;
  }
  const std::string folder = arguments[2];
  const bool all = write(method_figure(*atlas), folder + "/acupoint_steps.svg") &&
                   write(morphing_figure(), folder + "/morphing.svg") &&
                   write(path_figure(), folder + "/paths.svg");
  return all ? 0 : 1;
}
