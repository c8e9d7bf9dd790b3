// SPDX-License-Identifier: Apache-2.0
#include "apps/evaluation/safety/site.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "tuina/body/back_surface.hpp"
#include "tuina/core/parallel.hpp"
#include "tuina/core/units.hpp"
#include "tuina/robot/inverse_kinematics.hpp"
#include "tuina/session/guarded_field.hpp"
#include "tuina/session/guarded_zone.hpp"
#include "tuina/sim/person/phantom.hpp"

namespace tuina::app {
namespace {

constexpr double around_m = 150_mm;  // skin that a tool can reach in a trial
constexpr double flat_m = 25_mm;     // skin whose mean normal is pressed against
constexpr double start_height_m = 25_mm, aside_height_m = 60_mm, aside_m = 100_mm;
constexpr double below_cap_n = 2.0;  // what a controller may be over its set force

/// A place by a point that every labelled person has.
struct Spot {
  const char* name;
  const char* point;  ///< acupoint or landmark; _L and _R where it has two
  double aside_m;     ///< farther from the spine
  TangentTissue sim::TissueLaws::*tissue;
};
constexpr std::array<Spot, 5> spots = {{
    {"bone", "scapula_root", 0.0, &sim::TissueLaws::bone},
    {"hard", "BL18", 5_mm, &sim::TissueLaws::hard},
    {"soft", "SI11", 0.0, &sim::TissueLaws::soft},
    {"low", "L4", 40_mm, &sim::TissueLaws::hard},
    {"midline", "GV4", 0.0, &sim::TissueLaws::bone},
}};

std::optional<Vector3> point_of(const sim::Person& person, const std::string& name) {
  for (const Acupoint& point : person.acupoints)
    if (point.name == name) return point.at_in_couch;
  for (const Landmark& point : person.landmarks)
    if (point.name == name) return point.at_in_couch;
  return std::nullopt;
}

/// The triangles within a distance of a place.
Mesh cut_out(const Mesh& mesh, const Vector3& middle, double radius_m) {
  Mesh part;
  std::vector<int> renamed(mesh.vertices.size(), -1);
  for (const auto& triangle : mesh.triangles) {
    const bool inside = std::all_of(triangle.begin(), triangle.end(), [&](int corner) {
      return (mesh.vertices[static_cast<std::size_t>(corner)] - middle).norm() < radius_m;
    });
    if (!inside) continue;
    auto& kept = part.triangles.emplace_back();
    for (std::size_t i = 0; i < 3; ++i) {
      int& name = renamed[static_cast<std::size_t>(triangle[i])];
      if (name < 0) {
        name = static_cast<int>(part.vertices.size());
        part.vertices.push_back(mesh.vertices[static_cast<std::size_t>(triangle[i])]);
      }
      kept[i] = name;
    }
  }
  return part;
}

Vector3 mean_normal(const Mesh& mesh) {
  Vector3 sum = Vector3::Zero();
  for (const auto& t : mesh.triangles) {
    const Vector3& a = mesh.vertices[static_cast<std::size_t>(t[0])];
    sum += (mesh.vertices[static_cast<std::size_t>(t[1])] - a)
               .cross(mesh.vertices[static_cast<std::size_t>(t[2])] - a);
  }
  return sum.normalized();
}

/// The linear base stands where the arm reaches every place, as in a session; so the low ones are
/// reached with a folded arm.
Result<void> place_arm(Site& site, const std::vector<Vector3>& all_in_couch) {
  const robot::ArmTable table = robot::thesis_arm();
  site.mount = robot::mount_for(site.position);
  const PerArm<robot::ArmModel> models = robot::both_models(table, site.mount);
  site.ready_rad = robot::ready_posture(table, site.mount);
  const Transform& base_from_couch = site.mount.base_from_couch;
  const auto goal = [&](const Vector3& at_in_couch) {
    return robot::ContactGoal{base_from_couch * at_in_couch,
                              base_from_couch.linear() * site.normal_in_couch};
  };
  PerArm<std::vector<robot::ContactGoal>> goals;
  for (const Vector3& place_in_couch : all_in_couch)
    goals[site.arm].push_back(goal(place_in_couch));
  site.rail_m = robot::choose_rail({.of = {&models[Arm::left], &models[Arm::right]}}, site.mount,
                                   goals, site.ready_rad)
                    .value_or(0.0);
  const robot::ArmModel& model = models[site.arm];
  const auto touching =
      robot::find_posture(model, site.rail_m, goal(site.at_in_couch), site.ready_rad[site.arm]);
  const auto above = robot::find_posture(model, site.rail_m,
                                         goal(site.above_in_couch(start_height_m)), touching.q_rad);
  const auto aside =
      robot::find_posture(model, site.rail_m, goal(site.aside_in_couch()), touching.q_rad);
  for (const robot::ContactPosture* posture : {&touching, &above, &aside}) {
    if (posture->reach != robot::Reach::reached)
      return fail(Fault::not_found, "{}: {}", site.name, explain(posture->reach));
  }
  site.above_rad = above.q_rad;
  site.aside_rad = aside.q_rad;
  site.apparent_mass_kg = robot::apparent_mass_kg(
      model.evaluate(touching.q_rad, JointVector::Zero(model.joints()), site.rail_m),
      goal(site.at_in_couch).normal_in_base);
  return {};
}

/// The nearest point of the skin.
Result<Vector3> place_of(const sim::Person& person, const massage::BackChart& chart,
                         const Spot& spot, Arm arm) {
  const char* const side = arm == Arm::left ? "_L" : "_R";
  auto point = point_of(person, std::string(spot.point) + side);
  if (!point) point = point_of(person, spot.point);
  if (!point) return fail(Fault::not_found, "{} has no {}", person.name, spot.point);
  const Vector3 outward = arm == Arm::left ? chart.left() : Vector3(-chart.left());
  const Vector3 wanted = *point + spot.aside_m * outward;
  const auto& vertices = person.skin_in_couch.vertices;
  return *std::min_element(vertices.begin(), vertices.end(), [&](auto& a, auto& b) {
    return (a - wanted).squaredNorm() < (b - wanted).squaredNorm();
  });
}

Result<Site> make_site(const sim::Person& person, const Spot& spot, Arm arm) {
  const auto chart = massage::BackChart::from(person.acupoints, person.landmarks);
  if (!chart) return tl::unexpected(chart.error());
  std::vector<Vector3> all_in_couch;
  for (const Spot& one : spots) {
    const auto place = place_of(person, *chart, one, arm);
    if (!place) return tl::unexpected(place.error());
    all_in_couch.push_back(*place);
  }
  const Vector3& at_in_couch = all_in_couch[static_cast<std::size_t>(&spot - spots.data())];
  const sim::TissueLaws laws = sim::tissue_laws_of(person.body_type, person.woman);
  Site site{.name = fmt::format("{} {}, {}, {} arm", name_of(person.position),
                                name_of(person.body_type), spot.name, name_of(arm)),
            .spot = spot.name,
            .position = person.position,
            .body_type = person.body_type,
            .arm = arm,
            .at_in_couch = at_in_couch,
            .tissue = laws.*spot.tissue,
            .bone = laws.bone,
            .skin_in_couch = cut_out(person.skin_in_couch, at_in_couch, around_m)};
  site.normal_in_couch = mean_normal(cut_out(person.skin_in_couch, at_in_couch, flat_m));
  const Vector3& up = chart->up();
  site.along_in_couch = (up - up.dot(site.normal_in_couch) * site.normal_in_couch).normalized();
  const massage::ZoneMap zones(*chart, person.acupoints, person.landmarks);
  site.zone = session::guarded_zone(zones.at(site.at_in_couch));
  site.force_n = safety::ceiling_of(site.zone).set_n - below_cap_n;
  if (site.force_n <= 0.0)
    return fail(Fault::not_found, "{} lies in the zone {}", site.name, name_of(site.zone));
  if (auto placed = place_arm(site, all_in_couch); !placed) return tl::unexpected(placed.error());
  return site;
}

/// As the session tells it to the guard; the scan is perfect.
Result<safety::ZoneField> field_of(const sim::Person& person) {
  PointCloud skin_in_couch;
  skin_in_couch.points = person.skin_in_couch.vertices;
  const auto back = body::fit_back(skin_in_couch, {.position = person.position});
  if (!back) return tl::unexpected(back.error());
  return session::zone_field(*back, person.acupoints, person.landmarks, {},
                             robot::mount_for(person.position).base_from_couch);
}

}  // namespace

Vector3 Site::aside_in_couch() const {
  // Away from the other arm: couch x is to the person's left, where the left arm is.
  const Vector3 across = along_in_couch.cross(normal_in_couch);
  const bool to_left = (across.x() > 0.0) == (arm == Arm::left);
  return above_in_couch(aside_height_m) + (to_left ? aside_m : -aside_m) * across;
}

Result<std::vector<Site>> make_sites(std::uint64_t seed) {
  struct Job {
    BodyPosture position;
    sim::BodyType type;
  };
  std::vector<Job> jobs;
  for (const BodyPosture position : {BodyPosture::sitting, BodyPosture::prone}) {
    for (const auto type : {sim::BodyType::slim, sim::BodyType::medium, sim::BodyType::hefty})
      jobs.push_back({position, type});
  }
  std::vector<std::vector<Result<Site>>> made(jobs.size());
  for_each_in_parallel(jobs.size(), [&](std::size_t k) {
    sim::Person person = sim::make_phantom(sim::draw_phantom(jobs[k].type, seed), jobs[k].position);
    person.body_type = jobs[k].type;
    const auto field = field_of(person);
    for (const Spot& spot : spots) {
      for (const Arm arm : both_arms) {
        made[k].push_back(field ? make_site(person, spot, arm) : tl::unexpected(field.error()));
        if (made[k].back()) made[k].back()->field = *field;
      }
    }
  });
  std::vector<Site> sites;
  for (auto& of_person : made) {
    for (Result<Site>& site : of_person) {
      if (!site) return tl::unexpected(site.error());
      sites.push_back(std::move(*site));
    }
  }
  return sites;
}

}  // namespace tuina::app
