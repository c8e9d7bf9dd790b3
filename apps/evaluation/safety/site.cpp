// SPDX-License-Identifier: Apache-2.0
#include "apps/evaluation/safety/site.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <iterator>
#include <optional>

#include "tuina/body/back_surface.hpp"
#include "tuina/core/parallel.hpp"
#include "tuina/core/units.hpp"
#include "tuina/motion/ready_plan.hpp"
#include "tuina/motion/startle.hpp"
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

/// A press of a few seconds as a plan has it; the force is what the zone bears.
massage::PlannedPath press_at(const Site& site, massage::Zone zone, int step) {
  constexpr double lasts_s = 5.0;
  massage::PlannedPath planned{.arm = site.arm, .step = step, .zone = zone, .cap_n = site.force_n};
  planned.path.name = site.name;
  for (const double time_s : {0.0, lasts_s})
    planned.path.points.push_back({time_s, site.at_in_couch, site.normal_in_couch, site.force_n});
  return planned;
}

/// The arm above its place and beside it, as it gets there from the configuration that a plan has
/// for the place.
Result<void> place_arm(Site& site, const robot::ArmModel& model, const JointVector& planned_rad) {
  constexpr double posture_share = 0.3, max_error_m = 5_mm;
  const Transform& base_from_couch = site.mount.base_from_couch;
  motion::JointPath passed, touching;
  motion::Rollout rollout(model, site.rail_m, planned_rad, posture_share);
  const auto reach = [&](const Vector3& at_in_couch, motion::JointPath& way) {
    rollout.transfer(
        {base_from_couch * at_in_couch, base_from_couch.linear() * site.normal_in_couch},
        planned_rad, way);
    rollout.settle(planned_rad, way);
    return rollout.tool_error_m() < max_error_m;
  };
  bool reached = reach(site.at_in_couch, passed);
  touching.q_rad = {rollout.q_rad()};
  touching.poses = {model.kinematics(rollout.q_rad(), site.rail_m)};
  site.apparent_mass_kg = motion::max_apparent_mass_kg(model, site.rail_m, touching);
  reached = reach(site.above_in_couch(start_height_m), passed) && reached;
  site.above_rad = rollout.q_rad();
  if (!reached) return fail(Fault::not_found, "{}: the arm does not get there", site.name);
  // Away from the other arm, which is to the person's left for the left arm; else along the spine.
  const Vector3 across = site.along_in_couch.cross(site.normal_in_couch);
  const Vector3 away = (across.x() > 0.0) == (site.arm == Arm::left) ? across : Vector3(-across);
  for (const Vector3& way : {away, site.along_in_couch, Vector3(-site.along_in_couch)}) {
    if (!reach(site.above_in_couch(aside_height_m) + aside_m * way, passed)) continue;
    site.aside_rad = rollout.q_rad();
    return {};
  }
  return fail(Fault::not_found, "{}: the arm does not get beside it", site.name);
}

/// Linear base, configurations and forces are those of a plan with a press at every place of one
/// person: the low ones are reached with a folded arm, and pressed with less where it is heavy.
Result<void> place_arms(std::vector<Site>& sites, std::vector<massage::PlannedPath> paths,
                        const body::BackSurface& back) {
  constexpr double standoff_m = 40_mm;
  const robot::RobotMount mount = robot::mount_for(back.position());
  const PerArm<robot::ArmModel> models = robot::both_models(robot::thesis_arm(), mount);
  const auto ready = motion::make_ready({.programme = "campaign", .paths = std::move(paths)}, back,
                                        mount, models, mount.base_from_couch, standoff_m);
  if (!ready) return tl::unexpected(ready.error());
  if (!ready->reachable)
    return fail(Fault::not_found, "{}", fmt::join(words_of(ready->plan.notes), "; "));
  for (const Arm arm : both_arms) {
    for (const motion::ArmJob& job : ready->jobs[arm]) {
      if (job.path < 0) continue;
      const massage::PlannedPath& planned = ready->plan.paths[static_cast<std::size_t>(job.path)];
      Site& site = *std::find_if(sites.begin(), sites.end(),
                                 [&](const Site& one) { return one.name == planned.path.name; });
      site.mount = mount;
      site.ready_rad = ready->ready_rad;
      site.rail_m = ready->rail_m;
      site.force_n = planned.cap_n;
      if (auto placed = place_arm(site, models[arm], job.posture_rad); !placed) return placed;
    }
  }
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

Result<Site> make_site(const sim::Person& person, const massage::BackChart& chart, const Spot& spot,
                       Arm arm) {
  const auto place = place_of(person, chart, spot, arm);
  if (!place) return tl::unexpected(place.error());
  const sim::TissueLaws laws = sim::tissue_laws_of(person.body_type, person.woman);
  Site site{.name = fmt::format("{} {}, {}, {} arm", name_of(person.position),
                                name_of(person.body_type), spot.name, name_of(arm)),
            .spot = spot.name,
            .position = person.position,
            .body_type = person.body_type,
            .arm = arm,
            .at_in_couch = *place,
            .tissue = laws.*spot.tissue,
            .bone = laws.bone,
            .skin_in_couch = cut_out(person.skin_in_couch, *place, around_m)};
  site.normal_in_couch = mean_normal(cut_out(person.skin_in_couch, *place, flat_m));
  const Vector3& up = chart.up();
  site.along_in_couch = (up - up.dot(site.normal_in_couch) * site.normal_in_couch).normalized();
  return site;
}

/// Both arms at every spot of one person.
Result<std::vector<Site>> sites_on(const sim::Person& person) {
  const auto chart = massage::BackChart::from(person.acupoints, person.landmarks);
  if (!chart) return tl::unexpected(chart.error());
  PointCloud skin_in_couch;
  skin_in_couch.points = person.skin_in_couch.vertices;
  const auto back = body::fit_back(skin_in_couch, {.position = person.position});
  if (!back) return tl::unexpected(back.error());
  // As the session tells it to the guard; the scan is perfect.
  const auto field = session::zone_field(*back, person.acupoints, person.landmarks, {},
                                         robot::mount_for(person.position).base_from_couch);
  if (!field) return tl::unexpected(field.error());
  const massage::ZoneMap zones(*chart, person.acupoints, person.landmarks);
  std::vector<Site> sites;
  std::vector<massage::PlannedPath> paths;
  for (const Spot& spot : spots) {
    for (const Arm arm : both_arms) {
      auto site = make_site(person, *chart, spot, arm);
      if (!site) return tl::unexpected(site.error());
      const massage::Zone zone = zones.at(site->at_in_couch);
      site->zone = session::guarded_zone(zone);
      site->field = *field;
      site->force_n = safety::ceiling_of(site->zone).set_n - below_cap_n;
      if (site->force_n <= 0.0)
        return fail(Fault::not_found, "{} lies in the zone {}", site->name, name_of(site->zone));
      paths.push_back(press_at(*site, zone, static_cast<int>(paths.size())));
      sites.push_back(std::move(*site));
    }
  }
  if (auto placed = place_arms(sites, std::move(paths), *back); !placed)
    return tl::unexpected(placed.error());
  return sites;
}

}  // namespace

Result<std::vector<Site>> make_sites(std::uint64_t seed, const sim::WorldOptions& world) {
  struct Job {
    BodyPosture position;
    sim::BodyType type;
  };
  std::vector<Job> jobs;
  for (const BodyPosture position : {BodyPosture::sitting, BodyPosture::prone}) {
    for (const auto type : {sim::BodyType::slim, sim::BodyType::medium, sim::BodyType::hefty})
      jobs.push_back({position, type});
  }
  std::vector<Result<std::vector<Site>>> made(jobs.size());
  for_each_in_parallel(jobs.size(), [&](std::size_t k) {
    sim::Person person = sim::make_phantom(sim::draw_phantom(jobs[k].type, seed), jobs[k].position);
    person.body_type = jobs[k].type;
    made[k] = sites_on(person);
  });
  std::vector<Site> sites;
  for (Result<std::vector<Site>>& of_person : made) {
    if (!of_person) return tl::unexpected(of_person.error());
    std::move(of_person->begin(), of_person->end(), std::back_inserter(sites));
  }
  for (Site& site : sites) site.world = world;
  return sites;
}

}  // namespace tuina::app
