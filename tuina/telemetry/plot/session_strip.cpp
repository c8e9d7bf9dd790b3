// SPDX-License-Identifier: Apache-2.0
#include "tuina/telemetry/plot/session_strip.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "tuina/core/units.hpp"
#include "tuina/telemetry/picture/back_view.hpp"
#include "tuina/telemetry/picture/picture_element.hpp"
#include "tuina/telemetry/picture/shaded_picture.hpp"
#include "tuina/telemetry/plot/svg_plot.hpp"
#include "tuina/telemetry/report/figures.hpp"

namespace tuina::telemetry {
namespace {

constexpr double shown_share = 0.6;  // arms as thick as they are would hide the back

/// Obliquely from above and from the side, so that neither arm hides the other or the back.
View view_of(BodyPosture position, const figures::BackPose& pose) {
  const Vector3 right = pose.up.cross(pose.out).normalized();
  View view;
  view.toward_eye = position == BodyPosture::sitting
                        ? Vector3(0.75 * pose.out - 0.12 * right + 0.70 * pose.up)
                        : Vector3(0.50 * pose.out + 0.80 * right - 0.25 * pose.up);
  view.up = position == BodyPosture::sitting ? pose.up : pose.out;
  view.width_px = 400;
  view.height_px = 360;
  view.margin_px = 14.0;
  return view;
}

const ArmsPose* pose_at(const ReportData& data, double time_s) {
  const auto after = std::lower_bound(
      data.poses.begin(), data.poses.end(), time_s,
      [](const ArmsPose& pose, double wanted_s) { return pose.time_s < wanted_s; });
  if (after == data.poses.end()) return data.poses.empty() ? nullptr : &data.poses.back();
  return &*after;
}

void draw_arms(Scene& scene, const ArmsPose& pose) {
  for (const Arm arm : both_arms) {
    for (const ArmLink& link : pose.links[arm]) {
      scene.threads.push_back({.points = {link.from_in_couch, link.to_in_couch},
                               .radius_m = shown_share * link.radius_m,
                               .colour = mix(palette::clay, colour_of(arm), 0.45)});
    }
  }
}

/// Now in full colour with a ring around it, before that as a faint trace.
void draw_path(Scene& scene, const ContactPath& path, bool now) {
  if (path.points.empty()) return;
  const Colour colour =
      now ? colour_of(path.technique) : mix(palette::skin, colour_of(path.technique), 0.45);
  const ContactPoint& middle = path.points[path.points.size() / 2];
  if (!slides(path.technique)) {
    scene.beads.push_back(
        {.at = middle.at_in_couch, .radius_m = now ? 9_mm : 6_mm, .colour = colour});
    if (now) scene.discs.push_back({.at = middle.at_in_couch, .radius_m = 35_mm, .colour = colour});
  } else {
    scene.threads.push_back(
        {.points = figures::lifted(path, 2_mm), .radius_m = now ? 4_mm : 2.2_mm, .colour = colour});
  }
}

std::string caption_of(const Moment& moment, const Language& say) {
  const auto whole = static_cast<long>(std::lround(std::max(0.0, moment.begin_s)));
  std::string html = fmt::format("<figcaption><b>{}:{:02}</b>", whole / 60, whole % 60);
  for (const PerformedPath* performed : moment.paths) {
    html += fmt::format(
        "<span><i style=\"background:{}\"></i>{}</span>", css(colour_of(performed->arm)),
        escaped(say("{} arm: {} {}", name_of(performed->arm), name_of(performed->path.technique),
                    figures::place_of(performed->path, say))));
  }
  return html + "</figcaption>";
}

}  // namespace

std::vector<Moment> moments_of(const ReportData& data) {
  std::vector<const PerformedPath*> paths;
  for (const PerformedPath& performed : data.paths) paths.push_back(&performed);
  std::stable_sort(paths.begin(), paths.end(), [](const PerformedPath* a, const PerformedPath* b) {
    return a->begin_s < b->begin_s;
  });
  std::vector<Moment> moments;
  for (const PerformedPath* path : paths) {
    const double end_s = path->ended_s();
    if (!moments.empty() && moments.back().paths.size() == 1 &&
        moments.back().paths.front()->arm != path->arm) {
      Moment& last = moments.back();
      const double together_s = std::min(end_s, last.end_s) - path->begin_s;
      const double shorter_s = std::min(end_s - path->begin_s, last.end_s - last.begin_s);
      if (together_s > 0.5 * shorter_s) {
        last.end_s = std::max(last.end_s, end_s);
        last.paths.push_back(path);
        if (path->arm == Arm::left) std::swap(last.paths.front(), last.paths.back());
        continue;
      }
    }
    moments.push_back({.begin_s = path->begin_s, .end_s = end_s, .paths = {path}});
  }
  return moments;
}

std::string session_strip(const ReportData& data) {
  const std::vector<Moment> moments = moments_of(data);
  const figures::BackPose pose = figures::pose_of(data);
  const PictureMesh person = figures::person_of(data, pose, 5_mm);
  if (moments.empty() || person.mesh.triangles.empty()) return "";
  const std::size_t pictures = std::min(moments.size(), max_pictures);
  // The same frame for all: the person, and wherever an arm is in one of them.
  std::vector<std::size_t> shown;
  std::vector<const ArmsPose*> arms;
  std::vector<Vector3> in_frame;
  for (std::size_t k = 0; k < pictures; ++k) {
    shown.push_back(pictures < 2 ? 0 : k * (moments.size() - 1) / (pictures - 1));
    double middle_s = 0.0;
    for (const PerformedPath* path : moments[shown.back()].paths)
      middle_s += 0.5 * (path->begin_s + path->ended_s());
    arms.push_back(
        pose_at(data, middle_s / static_cast<double>(moments[shown.back()].paths.size())));
    if (arms.back() == nullptr) continue;
    for (const Arm arm : both_arms) {
      for (const ArmLink& link : arms.back()->links[arm]) {
        in_frame.push_back(link.from_in_couch);
        in_frame.push_back(link.to_in_couch);
      }
    }
  }
  // Four in a row would leave the last one alone.
  std::string html = pictures % 4 == 1 ? "<div class=\"strip odd\">" : "<div class=strip>";
  for (std::size_t k = 0; k < pictures; ++k) {
    const Moment& moment = moments[shown[k]];
    Scene scene;
    scene.surface = person;
    scene.in_frame = in_frame;
    for (std::size_t before = 0; before < shown[k]; ++before) {
      for (const PerformedPath* path : moments[before].paths) draw_path(scene, path->path, false);
    }
    for (const PerformedPath* path : moment.paths) draw_path(scene, path->path, true);
    if (arms[k] != nullptr) draw_arms(scene, *arms[k]);
    const ShadedPicture picture = shade(scene, view_of(data.position, pose));
    html += fmt::format(
        "<figure><svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {:.0f} {:.0f}\" "
        "role=\"img\" aria-label=\"{}\">{}</svg>{}</figure>",
        picture.image.width / 2.0, picture.image.height / 2.0,
        escaped(data.language("picture {} of the session", k + 1)), picture_element(picture),
        caption_of(moment, data.language));
  }
  return html + "</div>";
}

}  // namespace tuina::telemetry
