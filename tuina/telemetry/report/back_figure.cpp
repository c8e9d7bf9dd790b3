// SPDX-License-Identifier: Apache-2.0
// The pictures of the back: rendered surface below, letters and leader lines as vectors above.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "tuina/core/units.hpp"
#include "tuina/telemetry/picture/back_view.hpp"
#include "tuina/telemetry/picture/picture_element.hpp"
#include "tuina/telemetry/picture/shaded_picture.hpp"
#include "tuina/telemetry/plot/svg_plot.hpp"
#include "tuina/telemetry/report/figures.hpp"

namespace tuina::telemetry::figures {
namespace {

View view_of(const BackPose& pose) {
  View view;
  const Vector3 right = pose.up.cross(pose.out).normalized();
  // A little from the side and from above, or a back looks flat.
  view.toward_eye = (pose.out - 0.20 * right + 0.10 * pose.up).normalized();
  view.up = pose.up;
  view.width_px = 960;
  view.height_px = 1080;
  return view;
}

struct Label {
  Vector2 at;  ///< place of the point in the drawing
  std::string name;
  std::string remark;
  double y = 0.0;  ///< height of the text
};

/// Moves the labels of one side apart, keeping their order, as near to their points as they can be.
void spread(std::vector<Label>& labels, double top, double bottom) {
  std::sort(labels.begin(), labels.end(),
            [](const Label& a, const Label& b) { return a.at.y() < b.at.y(); });
  const double apart =
      std::min(38.0, (bottom - top) / std::max<double>(1.0, static_cast<double>(labels.size())));
  double free_from = top;
  for (Label& label : labels) {
    label.y = std::max(free_from, label.at.y());
    free_from = label.y + apart;
  }
  double free_to = bottom;
  for (auto label = labels.rbegin(); label != labels.rend(); ++label) {
    label->y = std::min(label->y, free_to);
    free_to = label->y - apart;
  }
}

constexpr double labels_width = 122.0;  // of one column

/// The rendered picture as an element of a drawing, of which one unit is two pixels of the picture,
/// so that it stays sharp on fine screens and on paper.
struct Drawing {
  std::string element;
  double width = 0.0, height = 0.0;
};

Drawing drawing_of(const ShadedPicture& picture) {
  return {.element = picture_element(picture, labels_width),
          .width = picture.image.width / 2.0,
          .height = picture.image.height / 2.0};
}

/// The picture with a column of labels on either side. `key` is one line of drawing beneath.
std::string compose(const Drawing& picture, std::vector<Label> labels, const std::string& title,
                    const std::string& key = {}) {
  constexpr double key_height = 34.0;
  const double width = picture.width, height = picture.height;
  std::vector<Label> left;
  std::vector<Label> right;
  for (Label& label : labels) {
    const bool is_left = label.at.x() < 0.497 * width;
    label.at.x() += labels_width;
    (is_left ? left : right).push_back(std::move(label));
  }
  spread(left, 24, height - 24);
  spread(right, 24, height - 24);

  std::string svg = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0:.0f} {1:.0f}\" role=\"img\" "
      "aria-label=\"{2}\" "
      "class=\"back\" font-family=\"Inter,system-ui,-apple-system,'Segoe "
      "UI',Helvetica,Arial,sans-serif\" font-size=\"12.5\" fill=\"{3}\">"
      "<title>{2}</title>{4}",
      width + 2 * labels_width, height + (key.empty() ? 0.0 : key_height), escaped(title),
      css(palette::ink), picture.element);
  if (!key.empty())
    svg += fmt::format("<g transform=\"translate({:.1f} {:.1f})\">{}</g>", labels_width,
                       height + 20.0, key);
  const auto draw = [&](const Label& label, bool is_left) {
    const double edge = is_left ? labels_width - 8 : labels_width + width + 8;
    const char* anchor = is_left ? "end" : "start";
    const double text_x = is_left ? edge - 4 : edge + 4;
    svg += fmt::format(
        "<path d=\"M{:.1f} {:.1f}L{:.1f} {:.1f}\" stroke=\"#fff\" stroke-width=\"2.6\" "
        "stroke-opacity=\".55\"/>"
        "<path d=\"M{:.1f} {:.1f}L{:.1f} {:.1f}\" stroke=\"{}\" stroke-width=\".9\"/>",
        edge, label.y, label.at.x(), label.at.y(), edge, label.y, label.at.x(), label.at.y(),
        css(palette::ink));
    svg += fmt::format(
        "<text class=\"name\" x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"{}\" "
        "font-weight=\"600\">{}</text>",
        text_x, label.y + 1, anchor, escaped(label.name));
    svg += fmt::format(
        "<text class=\"remark\" x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"{}\" font-size=\"10.5\" "
        "fill=\"{}\">{}</text>",
        text_x, label.y + 14, anchor, css(palette::grey), escaped(label.remark));
  };
  for (const Label& label : left) draw(label, true);
  for (const Label& label : right) draw(label, false);
  return svg + "</svg>";
}

/// A dot and a word for each technique.
std::string key_line(const std::vector<KeyEntry>& key) {
  constexpr double dot = 14.0, letter = 7.2, gap = 22.0;
  std::string line;
  double x = 0.0;
  for (const KeyEntry& entry : key) {
    line += entry.line
                ? fmt::format("<path d=\"M{:.1f} 0h12\" stroke=\"{}\" stroke-width=\"3\"/>",
                              x - 6.0, css(entry.colour))
                : fmt::format("<circle cx=\"{:.1f}\" r=\"5\" fill=\"{}\"/>", x, css(entry.colour));
    line += fmt::format("<text x=\"{:.1f}\" y=\"4\">{}</text>", x + dot, escaped(entry.text));
    x += dot + letter * static_cast<double>(entry.text.size()) + gap;
  }
  return line;
}

Vector2 drawn(const Projection& projection, const Vector3& place) {
  return projection(place).head<2>() / 2.0;
}

/// "BL47_L" as "BL47 L".
std::string short_name(std::string name) {
  std::replace(name.begin(), name.end(), '_', ' ');
  return name;
}

bool is_one_of_seven(const std::string& name) {
  return std::find(seven_acupoints.begin(), seven_acupoints.end(), name) != seven_acupoints.end();
}

}  // namespace

BackFigure back(const ReportData& data, const std::vector<KeyEntry>& key) {
  const BackPose pose = pose_of(data);
  Scene scene;
  scene.surface = person_of(data, pose);
  if (scene.surface.mesh.triangles.empty()) return {};
  for (const PerformedPath& performed : data.paths) {
    const ContactPath& path = performed.path;
    if (path.points.empty()) continue;
    if (!slides(path.technique)) {
      const ContactPoint& place = path.points[path.points.size() / 2];
      const double radius_m = path.technique == Technique::press ? 5.5_mm : 4_mm;
      scene.beads.push_back(
          {.at = place.at_in_couch, .radius_m = radius_m, .colour = colour_of(path.technique)});
    } else {
      scene.threads.push_back({.points = lifted(path, 1.5_mm),
                               .radius_m = 1.7_mm,
                               .colour = colour_of(path.technique)});
    }
  }
  for (const FoundAcupoint& found : data.acupoints) {
    const Acupoint& point = found.acupoint;
    scene.discs.push_back(
        {.at = point.at_in_couch, .radius_m = point.uncertainty_m, .colour = palette::marker});
    scene.beads.push_back({.at = point.at_in_couch + 4.2_mm * point.normal_in_couch,
                           .radius_m = 2.2_mm,
                           .colour = palette::marker});
  }
  const ShadedPicture picture = shade(scene, view_of(pose));
  std::vector<Label> labels;
  for (const FoundAcupoint& found : data.acupoints) {
    const Acupoint& point = found.acupoint;
    if (data.acupoints.size() > 16 && !is_one_of_seven(point.name)) continue;
    labels.push_back(
        {.at = drawn(picture.projection, point.at_in_couch + 4_mm * point.normal_in_couch),
         .name = short_name(point.name),
         .remark = fmt::format("{} ± {:.0f} mm", data.language(chinese_name(point.name)),
                               to_mm(point.uncertainty_m))});
  }
  const std::string title = data.language("The scanned back with acupoints and paths");
  const Drawing drawing = drawing_of(picture);
  return {.plain = compose(drawing, labels, title),
          .with_key = compose(drawing, labels, title, key_line(key))};
}

std::string tissue(const ReportData& data, double scale_n_per_mm) {
  const BackPose pose = pose_of(data);
  Scene scene;
  scene.surface = person_of(data, pose);
  if (scene.surface.mesh.triangles.empty() || data.tissue.empty()) return "";
  const double hardest = hardest_shown(data, scale_n_per_mm);
  const std::vector<FeltTissue> all_felt = last_felt(data);
  for (const Vector3& vertex : scene.surface.mesh.vertices) {
    const auto value = data.stiffness_at ? data.stiffness_at(vertex) : std::nullopt;
    // Full colour where it is known to a tenth, plain clay where it is not.
    const double shown = value ? std::clamp(1.4 - 4.0 * value->log_sd, 0.0, 1.0) : 0.0;
    scene.colours.push_back(
        mix(palette::clay, hardness_colour(value ? value->n_per_mm / hardest : 0.0), shown));
  }
  for (const FeltTissue& felt : all_felt) {
    scene.beads.push_back({.at = felt.at_in_couch,
                           .radius_m = 2.6_mm,
                           .colour = felt.estimate.converged ? palette::marker : palette::grey});
  }
  const ShadedPicture picture = shade(scene, view_of(pose));
  std::vector<Label> labels;
  for (const FeltTissue& felt : all_felt) {
    labels.push_back({.at = drawn(picture.projection, felt.at_in_couch),
                      .name = short_name(felt.name),
                      .remark = fmt::format("{:.1f} ± {:.1f} N/mm", felt.stiffness_n_per_mm,
                                            felt.stiffness_ci95_n_per_mm)});
  }
  return compose(drawing_of(picture), labels,
                 data.language("The back coloured by the estimated stiffness of its tissue")) +
         hardness_bar_svg(0.0, hardest,
                          data.language("stiffness under {:.0f} N, N/mm", data.stiffness_force_n));
}

}  // namespace tuina::telemetry::figures
