// SPDX-License-Identifier: Apache-2.0
// Draws docs/figures/frames.svg: every frame in both positions, from the same tables that the
// simulation uses, so that the drawing cannot say something else than the code. Usage: draw_frames
// OUT.svg
#include <fmt/format.h>

#include <algorithm>
#include <cstdio>

#include "tuina/core/io/file.hpp"
#include "tuina/core/io/png.hpp"
#include "tuina/core/units.hpp"
#include "tuina/robot/inverse_kinematics.hpp"
#include "tuina/robot/ready_posture.hpp"
#include "tuina/sim/person/phantom.hpp"
#include "tuina/sim/scanner/laser_scanner.hpp"
#include "tuina/telemetry/picture/picture_element.hpp"
#include "tuina/telemetry/picture/shaded_picture.hpp"
#include "tuina/telemetry/plot/svg_plot.hpp"

using namespace tuina;
using namespace tuina::telemetry;

namespace {

constexpr Colour axis_colours[3] = {{206, 44, 40}, {30, 140, 60}, {34, 88, 200}};
constexpr Colour metal = {196, 200, 206};
constexpr Colour joint = {88, 98, 114};
constexpr Colour cushion = {150, 168, 178};
constexpr Colour dark = {60, 64, 72};
constexpr Colour laser = {230, 20, 40};

/// A scene that solids are added to, and the letters that go on it.
struct Drawing {
  Scene scene;
  struct Word {
    Vector3 at;
    std::string text;
    Colour colour;
    bool strong = false;
    Vector2 shift_px = Vector2::Zero();
  };
  std::vector<Word> words;
  std::vector<Vector3> light_plane;  ///< a polygon
  struct Dash {
    Vector3 from, to;
    Colour colour = palette::ink;
    const char* pattern = "7 3 2 3";
  };
  std::vector<Dash> dashes;

  void add(const Mesh& mesh, Colour colour) {
    const PictureMesh more = mesh_for_picture(mesh);
    auto& to = scene.surface;
    const int first = static_cast<int>(to.mesh.vertices.size());
    to.mesh.vertices.insert(to.mesh.vertices.end(), more.mesh.vertices.begin(),
                            more.mesh.vertices.end());
    to.normals.insert(to.normals.end(), more.normals.begin(), more.normals.end());
    to.inside.insert(to.inside.end(), more.inside.begin(), more.inside.end());
    scene.colours.resize(to.mesh.vertices.size(), colour);
    for (const auto& t : more.mesh.triangles)
      to.mesh.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
  }

  /// A box about the middle of `pose`; its faces share no vertex, so its edges stay sharp.
  void add_box(const Transform& pose, const Vector3& size, Colour colour) {
    Mesh mesh;
    for (int axis = 0; axis < 3; ++axis) {
      for (const double side : {-0.5, 0.5}) {
        const int first = static_cast<int>(mesh.vertices.size());
        for (int k = 0; k < 4; ++k) {
          Vector3 corner;
          corner[axis] = side;
          corner[(axis + 1) % 3] = k == 1 || k == 2 ? 0.5 : -0.5;
          corner[(axis + 2) % 3] = k >= 2 ? 0.5 : -0.5;
          mesh.vertices.push_back(pose * Vector3(corner.cwiseProduct(size)));
        }
        if (side > 0)
          mesh.triangles.insert(mesh.triangles.end(),
                                {{first, first + 1, first + 2}, {first, first + 2, first + 3}});
        else
          mesh.triangles.insert(mesh.triangles.end(),
                                {{first, first + 2, first + 1}, {first, first + 3, first + 2}});
      }
    }
    add(mesh, colour);
  }

  void add_axes(const Transform& couch_from_frame, double length_m, const std::string& name,
                Vector2 shift_px) {
    const Vector3 origin = couch_from_frame.translation();
    for (int k = 0; k < 3; ++k) {
      const Vector3 tip = couch_from_frame * Vector3(length_m * Vector3::Unit(k));
      // What a solid hides shows through as dashes.
      dashes.push_back({.from = origin, .to = tip, .colour = axis_colours[k], .pattern = "2 3"});
      scene.threads.push_back(
          {.points = {origin, tip}, .radius_m = 5_mm, .colour = axis_colours[k]});
      for (int ring = 0; ring <= 8; ++ring) {
        scene.beads.push_back({.at = tip + (tip - origin).normalized() * (ring * 4_mm),
                               .radius_m = 12_mm * (8 - ring) / 8.0 + 1_mm,
                               .colour = axis_colours[k]});
      }
      words.push_back({.at = tip + (tip - origin).normalized() * 0.055,
                       .text = std::string(1, "xyz"[k]),
                       .colour = axis_colours[k]});
    }
    scene.beads.push_back({.at = origin, .radius_m = 10_mm, .colour = dark});
    words.push_back(
        {.at = origin, .text = name, .colour = palette::ink, .strong = true, .shift_px = shift_px});
  }
};

Transform at(const Vector3& place, const Matrix3& turn = Matrix3::Identity()) {
  Transform pose = Transform::Identity();
  pose.linear() = turn;
  pose.translation() = place;
  return pose;
}

/// Both arms with their tools on BL47, where the mount lets them stand.
void add_robot(Drawing& drawing, const sim::Person& person) {
  const robot::RobotMount mount = robot::mount_for(person.position);
  const robot::ArmTable table = robot::thesis_arm();
  const Transform couch_from_base = mount.base_from_couch.inverse();
  const auto ready = robot::ready_posture(table, mount);
  PerArm<std::vector<robot::ContactGoal>> goals;
  const robot::ArmModel left(table, mount, Arm::left);
  const robot::ArmModel right(table, mount, Arm::right);
  const PerArm<const robot::ArmModel*> models = {.of = {&left, &right}};
  for (const Arm arm : both_arms) {
    for (const Acupoint& point : person.acupoints) {
      if (point.name != (arm == Arm::left ? "BL47_L" : "BL47_R")) continue;
      goals[arm].push_back({mount.base_from_couch * point.at_in_couch,
                            mount.base_from_couch.linear() * point.normal_in_couch});
    }
  }
  const double rail_m = robot::choose_rail(models, mount, goals, ready).value_or(0.0);
  for (const Arm arm : both_arms) {
    const auto posture = robot::find_posture(*models[arm], rail_m, goals[arm].front(), ready[arm]);
    const auto kinematics = models[arm]->kinematics(posture.q_rad, rail_m);
    std::vector<Vector3> places;
    for (int k = 0; k <= table.joints; ++k)
      places.push_back(couch_from_base * kinematics.origins_in_base[static_cast<std::size_t>(k)]);
    for (std::size_t k = 0; k + 1 < places.size(); ++k) {
      if ((places[k + 1] - places[k]).norm() < 1_mm) continue;
      drawing.scene.threads.push_back({.points = {places[k], places[k + 1]},
                                       .radius_m = k + 2 == places.size() ? 14_mm : 30_mm,
                                       .colour = metal});
    }
    for (std::size_t k = 0; k + 1 < places.size(); ++k)
      drawing.scene.beads.push_back({.at = places[k], .radius_m = 38_mm, .colour = joint});
    drawing.scene.beads.push_back(
        {.at = places.back(), .radius_m = table.tool_radius_m, .colour = palette::press});
    const Transform couch_from_tool = couch_from_base * kinematics.base_from_tool;
    if (arm == Arm::left) {
      drawing.add_axes(couch_from_tool, 0.12, "tool",
                       person.position == BodyPosture::prone ? Vector2{-44, 22} : Vector2{-10, 32});
    }
  }
  // What the arms keep away from, as the planner knows it.
  const bool prone = person.position == BodyPosture::prone;
  for (const robot::Obstacle& solid : mount.obstacles) {
    const Vector3 ridden =
        solid.rides ? Vector3(rail_m * mount.rail_axis_in_base) : Vector3::Zero();
    drawing.add_box(couch_from_base * Eigen::Translation3d(ridden) * solid.base_from_box,
                    solid.edges_m,
                    solid.kind == robot::Surrounding::couch ? cushion
                    : solid.rides                           ? joint
                                                            : metal);
  }
  drawing.add_axes(couch_from_base, 0.17, "base", prone ? Vector2{-30, -14} : Vector2{10, -16});
}

/// The unit with camera and laser, its yaw axis, and the light on the skin.
void add_scanner(Drawing& drawing, const sim::Person& person) {
  const scanner::ScannerCalibration truth = sim::true_calibration(person.position);
  const Transform& couch_from_camera = truth.couch_from_camera;
  const Vector3 laser_in_camera =
      truth.laser_distance_m / truth.laser_normal_in_camera.x() * Vector3::UnitX();
  const Vector3 axis = truth.axis_point_in_camera;
  drawing.add_box(couch_from_camera * at(axis - Vector3(0, 0, 0.02)), Vector3(0.26, 0.05, 0.03),
                  metal);
  drawing.add_box(couch_from_camera * at(Vector3(0, 0, -0.005)), Vector3(0.05, 0.05, 0.05), dark);
  drawing.add_box(couch_from_camera * at(laser_in_camera - Vector3(0, 0, 0.005)),
                  Vector3(0.03, 0.03, 0.06), laser);
  const Vector3 along = truth.axis_direction_in_camera;
  drawing.dashes.push_back({.from = couch_from_camera * Vector3(axis - 0.20 * along),
                            .to = couch_from_camera * Vector3(axis + 0.20 * along)});
  drawing.words.push_back({.at = couch_from_camera * Vector3(axis + 0.22 * along),
                           .text = "yaw axis",
                           .colour = palette::grey,
                           .shift_px = {0, -6}});
  drawing.add_axes(couch_from_camera, 0.15, "camera",
                   person.position == BodyPosture::prone ? Vector2{-62, 4} : Vector2{14, 26});

  // The line on the skin: where triangles that face the camera cross the light plane.
  const Vector3 normal = couch_from_camera.linear() * truth.laser_normal_in_camera;
  const double offset = truth.laser_distance_m + normal.dot(couch_from_camera.translation());
  std::vector<Vector3> lit;
  for (const auto& t : person.skin_in_couch.triangles) {
    std::vector<Vector3> cut;
    for (int k = 0; k < 3; ++k) {
      const Vector3& a =
          person.skin_in_couch.vertices[static_cast<std::size_t>(t[static_cast<std::size_t>(k)])];
      const Vector3& b =
          person.skin_in_couch
              .vertices[static_cast<std::size_t>(t[static_cast<std::size_t>((k + 1) % 3)])];
      const double da = normal.dot(a) - offset;
      const double db = normal.dot(b) - offset;
      if ((da < 0) != (db < 0)) cut.push_back(a + (b - a) * (da / (da - db)));
    }
    if (cut.size() != 2) continue;
    drawing.scene.threads.push_back(
        {.points = {cut[0], cut[1]}, .radius_m = 4_mm, .colour = laser});
    lit.push_back(0.5 * (cut[0] + cut[1]));
  }
  if (lit.empty()) return;
  const Vector3 down = couch_from_camera.linear().col(1);
  const auto [first, last] = std::minmax_element(
      lit.begin(), lit.end(),
      [&](const Vector3& a, const Vector3& b) { return down.dot(a) < down.dot(b); });
  drawing.light_plane = {couch_from_camera * laser_in_camera, *first, *last};
}

std::string panel(BodyPosture position, double left_px, int width_px) {
  const sim::Person person = sim::make_phantom({}, position);
  Drawing drawing;
  drawing.add(person.skin_in_couch, palette::skin);
  const bool prone = position == BodyPosture::prone;
  add_robot(drawing, person);
  add_scanner(drawing, person);
  drawing.add_axes(Transform::Identity(), 0.22, "couch",
                   prone ? Vector2{-54, 24} : Vector2{-66, 10});

  View view;
  view.toward_eye = prone ? Vector3(1.0, 0.42, 0.40) : Vector3(1.0, 0.62, 0.45);
  view.up = Vector3::UnitZ();
  view.distance_m = 6.0;
  view.width_px = 2 * width_px;
  view.height_px = 1240;
  view.margin_px = 60;
  const ShadedPicture picture = shade(drawing.scene, view);
  const auto place = [&](const Vector3& where) -> Vector2 {
    return picture.projection(where).head<2>() / 2.0;
  };
  const double width = picture.image.width / 2.0;
  const double height = picture.image.height / 2.0;
  const double x0 = left_px + (width_px - width) / 2.0;
  const double y0 = 50.0 + (620.0 - height) / 2.0;
  std::string svg =
      fmt::format("<g transform=\"translate({:.1f} {:.1f})\">{}", x0, y0, picture_element(picture));
  if (!drawing.light_plane.empty()) {
    svg += "<path d=\"";
    for (std::size_t k = 0; k < drawing.light_plane.size(); ++k) {
      const Vector2 p = place(drawing.light_plane[k]);
      svg += fmt::format("{}{:.1f} {:.1f}", k == 0 ? 'M' : 'L', p.x(), p.y());
    }
    svg += fmt::format(
        "Z\" fill=\"{0}\" fill-opacity=\".10\" stroke=\"{0}\" stroke-opacity=\".35\" "
        "stroke-width=\".7\"/>",
        css(laser));
  }
  for (const auto& dash : drawing.dashes) {
    const Vector2 a = place(dash.from);
    const Vector2 b = place(dash.to);
    svg += fmt::format(
        "<path d=\"M{:.1f} {:.1f}L{:.1f} {:.1f}\" stroke=\"{}\" stroke-width=\"1.2\" "
        "stroke-dasharray=\"{}\"/>",
        a.x(), a.y(), b.x(), b.y(), css(dash.colour), dash.pattern);
  }
  for (const auto& word : drawing.words) {
    const Vector2 p = place(word.at) + word.shift_px;
    svg += fmt::format(
        "<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"middle\" fill=\"{}\" font-size=\"{}\" "
        "font-weight=\"{}\" stroke=\"#fff\" stroke-width=\"3.4\" paint-order=\"stroke\" "
        "stroke-linejoin=\"round\">{}</text>",
        p.x(), p.y() + 4, css(word.colour), word.strong ? 16 : 13, word.strong ? 700 : 600,
        escaped(word.text));
  }
  return svg + "</g>" +
         fmt::format(
             "<text x=\"{:.1f}\" y=\"34\" text-anchor=\"middle\" font-size=\"20\" "
             "font-weight=\"600\" fill=\"{}\">{}</text>",
             left_px + width_px / 2.0, css(palette::ink), name_of(position));
}

}  // namespace

int main(int count, char** words) {
  if (count != 2) return std::fputs("usage: draw_frames OUT.svg\n", stderr), 1;
  std::string svg =
      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 1240 655\" "
      "font-family=\"Inter,system-ui,'Segoe UI',Helvetica,Arial,sans-serif\">"
      "<title>The frames of tuina, sitting and prone</title><rect width=\"1240\" height=\"655\" "
      "fill=\"#fff\"/>";
  svg += panel(BodyPosture::sitting, 0, 560) + panel(BodyPosture::prone, 570, 660) + "</svg>\n";
  const auto written = write_file(words[1], svg);
  if (!written) return std::fputs((written.error().message + "\n").c_str(), stderr), 2;
  return 0;
}
