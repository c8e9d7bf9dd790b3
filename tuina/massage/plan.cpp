// SPDX-License-Identifier: Apache-2.0
#include "tuina/massage/plan.hpp"

#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "tuina/core/units.hpp"
#include "tuina/massage/contact_path.hpp"
#include "tuina/massage/press.hpp"
#include "tuina/massage/rub.hpp"
#include "tuina/massage/stroke.hpp"
#include "tuina/massage/tap.hpp"

namespace tuina::massage {
namespace {

constexpr double shortest_stroke_m = 60_mm;
constexpr double off_skin_m = 20_mm;  // an acupoint further from the scanned skin is not on it

/// A point or line of the programme with the side it is on: "BL47_L", or {"SI11_L", "BL47_L"}.
struct Target {
  std::string name;
  std::vector<Acupoint> points;  // empty for a named line
  double side = 1.0;             // 1: the person's left
};

/// Levels and distances beside the spine that make a named line, from its beginning.
std::vector<Place> places_of(const std::string& line, const BackChart& chart, double side) {
  const auto at = [&](double cun, double up_m) { return Place{side * cun * chart.cun_m(), up_m}; };
  const auto level = [&](Level name) { return chart.up_of(name); };
  std::vector<Place> places;
  if (line == "scapula") {
    for (const Level name : {Level::T3, Level::T7, Level::T9})
      places.push_back(at(2.2, level(name)));
  } else if (line == "loin") {
    const double l3_up = 0.5 * (level(Level::L2) + level(Level::L4));
    for (const double cun : {1.8, 3.2, 4.6}) places.push_back(at(cun, l3_up));
  } else {
    const double cun = line == "bladder_inner" ? 1.5 : 3.0;
    for (const Level name : {Level::T3, Level::T7, Level::T9, Level::T12, Level::L2, Level::L4}) {
      places.push_back(at(cun, level(name)));
    }
  }
  return places;
}

/// Everything that is fixed while one programme is laid on one back.
class Planner {
 public:
  Planner(const body::BackSurface& back, std::span<const Acupoint> acupoints, BackChart chart,
          ZoneMap zones, const PlanOptions& options, double force_scale)
      : back_(back),
        acupoints_(acupoints),
        chart_(std::move(chart)),
        zones_(std::move(zones)),
        options_(options),
        force_scale_(force_scale) {}

  Result<void> add(const Part& part, int number) {
    auto targets = part.technique == Technique::stroke ? lines_of(part) : points_of(part);
    if (!targets) return tl::unexpected(targets.error());
    for (const Target& target : *targets) {
      const std::string name = fmt::format("{} {}", name_of(part.technique), target.name);
      const bool slides = part.technique == Technique::rub || part.technique == Technique::stroke;
      auto path = slides ? sliding(part, target, name) : standing(part, target, name);
      if (!path) return tl::unexpected(path.error());
      if (!*path) continue;
      for (const Acupoint& point : target.points) (*path)->path.acupoints.push_back(point.name);
      (*path)->part = number;
      (*path)->together = part.together;
      paths_.push_back(std::move(**path));
    }
    return {};
  }

  Plan finish(const std::string& programme) && {
    Plan plan{.programme = programme,
              .paths = schedule(std::move(paths_), options_.transfers),
              .zones_touched = {},
              .notes = std::move(notes_)};
    for (std::size_t i = 0; i < plan.paths.size(); ++i) {
      plan.duration_s =
          std::max(plan.duration_s, plan.paths[i].end_s() + options_.transfers.retract_s());
      if (i == 0 || plan.paths[i].step != plan.paths[i - 1].step) continue;
      const double apart_m = distance_between_m(plan.paths[i - 1].path, plan.paths[i].path);
      const bool first = plan.min_tool_distance_m == 0.0;
      plan.min_tool_distance_m = first ? apart_m : std::min(plan.min_tool_distance_m, apart_m);
    }
    for (const Zone zone : touched_) plan.zones_touched.emplace_back(name_of(zone));
    return plan;
  }

 private:
  using MaybePath = Result<std::optional<WaitingPath>>;

  Result<Acupoint> point(const std::string& name) const {
    const auto found = std::find_if(acupoints_.begin(), acupoints_.end(),
                                    [&](const Acupoint& a) { return a.name == name; });
    if (found != acupoints_.end()) return *found;
    std::vector<std::string> known;
    for (const Acupoint& a : acupoints_) known.push_back(a.name);
    return fail(Fault::bad_input, "the programme wants {}, the map of this back has {}", name,
                fmt::join(known, ", "));
  }

  static std::vector<double> sides_of(Side side) {
    if (side == Side::left) return {1.0};
    if (side == Side::right) return {-1.0};
    return {1.0, -1.0};
  }

  Result<std::vector<Target>> points_of(const Part& part) const {
    std::vector<Target> targets;
    for (const std::string& name : part.points) {
      const bool whole_name =
          name.ends_with("_L") || name.ends_with("_R") || name.starts_with("GV");
      for (const double side : sides_of(whole_name ? Side::left : part.side)) {
        const auto found = point(whole_name ? name : name + (side > 0.0 ? "_L" : "_R"));
        if (!found) return tl::unexpected(found.error());
        targets.push_back({found->name, {*found}, chart_.place_of(found->at_in_couch).left_m});
      }
    }
    if (part.order != Order::listed) {
      const double sign = part.order == Order::downward ? -1.0 : 1.0;
      std::stable_sort(targets.begin(), targets.end(), [&](const Target& a, const Target& b) {
        // Within 20 mm of height two points count as level, so that pairs stay together.
        const auto rank = [&](const Target& t) {
          return std::round(sign * chart_.place_of(t.points[0].at_in_couch).up_m / 20_mm);
        };
        return rank(a) < rank(b);
      });
    }
    return targets;
  }

  Result<std::vector<Target>> lines_of(const Part& part) const {
    std::vector<Target> targets;
    for (const double side : sides_of(part.side)) {
      const std::string end = side > 0.0 ? "_L" : "_R";
      Target target{part.line + end, {}, side};
      for (const std::string& name : part.points) {
        const bool whole_name = name.ends_with("_L") || name.ends_with("_R");
        const auto found = point(whole_name ? name : name + end);
        if (!found) return tl::unexpected(found.error());
        target.points.push_back(*found);
      }
      if (!target.points.empty()) {
        target.name =
            fmt::format("{} to {}", target.points.front().name, target.points.back().name);
        target.side = chart_.place_of(target.points.front().at_in_couch).left_m;
        const bool repeated = !targets.empty() && targets.back().name == target.name;
        if (repeated) continue;  // all names carry their side, so the other side is the same line
      }
      targets.push_back(std::move(target));
    }
    return targets;
  }

  /// Pressing and tapping: one place, one zone.
  MaybePath standing(const Part& part, const Target& target, const std::string& name) {
    const auto place = on_skin(target.points.front());
    if (!place) return tl::unexpected(place.error());
    const Zone zone = zones_.at(place->at_in_couch);
    const double force_n = allowed(part, zone, name);
    if (force_n <= 0.0) return left_out(name, zone);
    WaitingPath waiting{.path = {}, .zone = zone, .cap_n = cap(part.technique, zone), .arm = arm_of(*place)};
    const double longest_s = rule_of(zone).longest_s;
    if (part.technique == Technique::tap) {
      const double time_s = std::min(part.time_s.value_or(4.0), longest_s - 2.0 * landing_s);
      waiting.path =
          plan_tap(*place, {.force_n = force_n, .rate_hz = part.rate_hz, .time_s = time_s}, name);
    } else {
      PressOptions press{.force_n = force_n,
                         .window = {.edge_s = part.rise_s, .hold_s = part.hold_s}};
      const double cycle_s = press.window.length_s() + press.pause_s;
      press.repeats = part.repeats.value_or(
          std::max(1, static_cast<int>(part.time_s.value_or(2.0 * cycle_s) / cycle_s)));
      const int wanted = press.repeats;
      waiting.path = plan_press(*place, press, name);
      while (waiting.path.duration_s() > longest_s) {
        if (press.repeats > 1) {
          --press.repeats;
        } else {
          press.window.hold_s *= 0.8;
        }
        waiting.path = plan_press(*place, press, name);
      }
      if (press.repeats < wanted) {
        notes_.push_back(fmt::format("{}: {} instead of {} presses, {} bears {:.0f} s of contact",
                                     name, press.repeats, wanted, name_of(zone), longest_s));
      } else if (press.window.hold_s < part.hold_s) {
        notes_.push_back(
            fmt::format("{}: held for {:.1f} s instead of {:.1f} s, {} bears {:.0f} s of contact",
                        name, press.window.hold_s, part.hold_s, name_of(zone), longest_s));
      }
    }
    touched_.insert(zone);
    return waiting;
  }

  /// Rubbing and stroking: a curve through zones, the strictest of which counts for all of it.
  MaybePath sliding(const Part& part, const Target& target, const std::string& name) {
    double bent_m = 0.0;
    const Bend bend = [&](const Vector3& guide) {
      const Vector3 moved = zones_.around_denied(guide, target.side);
      bent_m = std::max(bent_m, (moved - guide).norm());
      return moved;
    };
    auto curve =
        part.technique == Technique::rub ? circle(part, target, bend) : line(part, target, bend);
    if (!curve)
      return tl::unexpected(Error{curve.error().fault, name + ": " + curve.error().message});
    if (bent_m > 1_mm) {
      notes_.push_back(fmt::format("{}: bent by up to {:.0f} mm around what must not be touched",
                                   name, to_mm(bent_m)));
    }
    Zone denied = Zone::muscle;
    const auto kept = allowed_stretch(*curve, part.technique, denied);
    if (kept.second - kept.first < curve->length_m() - 1_mm) {
      const double kept_m = kept.second - kept.first;
      if (curve->closed() || kept_m < shortest_stroke_m) return left_out(name, denied);
      notes_.push_back(fmt::format("{}: cut from {:.0f} to {:.0f} mm at {}", name,
                                   to_mm(curve->length_m()), to_mm(kept_m), name_of(denied)));
      curve = stretch_of(*curve, kept.first, kept.second);
    }
    const Zone zone = strictest(*curve, part.technique);
    const double force_n = allowed(part, zone, name);
    WaitingPath waiting{.path = {}, .zone = zone,
                        .cap_n = cap(part.technique, zone),
                        .arm = arm_of(curve->at(0.5 * curve->length_m()))};
    const double longest_s = rule_of(zone).longest_s;
    const auto repeats_in = [&](double one_s, int usual) {
      const double most = std::max(1.0, (longest_s - 3.0) / one_s);
      const double wanted = part.repeats  ? *part.repeats
                            : part.time_s ? std::round(*part.time_s / one_s)
                                          : usual;
      if (wanted > most) {
        notes_.push_back(
            fmt::format("{}: {:.0f} instead of {:.0f} times, {:.0f} s are allowed at one place",
                        name, std::floor(most), wanted, longest_s));
      }
      return static_cast<int>(std::clamp(wanted, 1.0, most));
    };
    if (part.technique == Technique::rub) {
      const RubOptions rub{
          .force_n = force_n, .rate_hz = part.rate_hz, .turns = repeats_in(1.0 / part.rate_hz, 4)};
      waiting.path = plan_rub(*curve, rub, name);
    } else {
      const double one_s = 2.0 * (curve->length_m() / part.speed_m_per_s + 0.5);
      const StrokeOptions stroke{
          .force_n = force_n, .speed_m_per_s = part.speed_m_per_s, .repeats = repeats_in(one_s, 2)};
      waiting.path = plan_stroke(*curve, stroke, name);
    }
    return waiting;
  }

  Result<SurfaceCurve> circle(const Part& part, const Target& target, const Bend& bend) const {
    const auto centre = on_skin(target.points.front());
    if (!centre) return tl::unexpected(centre.error());
    // Both hands begin outside and go round as mirror images of each other.
    const bool left = target.side >= 0.0;
    const Vector3 outside = left ? chart_.left() : Vector3(-chart_.left());
    return circle_on(back_, *centre, part.radius_m, outside, left, bend);
  }

  Result<SurfaceCurve> line(const Part& part, const Target& target, const Bend& bend) const {
    std::vector<Vector3> places;
    for (const Acupoint& point : target.points) places.push_back(point.at_in_couch);
    if (places.empty()) {
      for (const Place& place : places_of(part.line, chart_, target.side)) {
        const Vector3 flat = zones_.around_denied(chart_.in_couch(place), target.side);
        constexpr double above_m = 250_mm;
        const auto met = back_.along(flat + above_m * chart_.out(), -chart_.out());
        if (!met) {
          return fail(Fault::not_found,
                      "the scan shows no skin {:.0f} mm beside the spine, {:.0f} mm above GV4",
                      to_mm(std::abs(place.left_m)), to_mm(place.up_m));
        }
        places.push_back(met->at_in_couch);
      }
    }
    return line_through(back_, places, bend);
  }

  Result<body::SurfacePoint> on_skin(const Acupoint& point) const {
    body::SurfacePoint place = back_.nearest(point.at_in_couch);
    const double off_m = (place.at_in_couch - point.at_in_couch).norm();
    if (!(off_m <= off_skin_m)) {
      return fail(Fault::bad_input,
                  "{} lies {:.0f} mm off the scanned skin, {:.0f} allowed; do scan and acupoints "
                  "belong together?",
                  point.name, to_mm(off_m), to_mm(off_skin_m));
    }
    // A person lies with the skin, not with the noise of the scan: the normal is that of the disc
    // which the tool presses on.
    constexpr double disc_m = 12_mm;
    Vector3 sum = place.normal_in_couch;
    const Vector3 first = place.normal_in_couch.unitOrthogonal();
    const Vector3 second = place.normal_in_couch.cross(first);
    for (int i = 0; i < 8; ++i) {
      const double theta = 2.0 * pi * i / 8;
      const Vector3 beside =
          place.at_in_couch + disc_m * (std::cos(theta) * first + std::sin(theta) * second);
      sum += back_.nearest(beside).normal_in_couch;
    }
    place.normal_in_couch = sum.normalized();
    return place;
  }

  std::optional<Arm> arm_of(const body::SurfacePoint& at) const {
    constexpr double either_m = 15_mm;
    const double left_m = chart_.place_of(at.at_in_couch).left_m;
    if (std::abs(left_m) < either_m) return std::nullopt;
    // The left arm stands on the side of the couch's positive x, wherever the person's left is.
    return left_m * chart_.left().x() > 0.0 ? Arm::left : Arm::right;
  }

  double cap(Technique technique, Zone zone) const {
    const double of_zone = cap_n(zone, technique);
    const double of_muscle = zone == Zone::muscle ? options_.muscle_cap_n : of_zone;
    return std::min({of_zone, of_muscle, options_.force_ceiling_n});
  }

  double allowed(const Part& part, Zone zone, const std::string& name) {
    const double wanted_n = part.force_n * force_scale_;
    const double most_n = cap(part.technique, zone);
    if (most_n > 0.0 && wanted_n > most_n) {
      notes_.push_back(fmt::format("{}: {:.1f} N lowered to {:.1f} N ({})", name, wanted_n, most_n,
                                   name_of(zone)));
    }
    return std::min(wanted_n, most_n);
  }

  MaybePath left_out(const std::string& name, Zone zone) {
    notes_.push_back(fmt::format("{}: left out, it may not be done on {}", name, name_of(zone)));
    return std::optional<WaitingPath>{};
  }

  static constexpr double check_m = 2_mm;

  std::pair<double, double> allowed_stretch(const SurfaceCurve& curve, Technique technique,
                                            Zone& denied) const {
    std::pair<double, double> longest{0.0, 0.0};
    double start_m = 0.0;
    const int steps = static_cast<int>(std::ceil(curve.length_m() / check_m));
    for (int i = 0; i <= steps; ++i) {
      const double way_m = std::min(i * check_m, curve.length_m());
      const Zone zone = zones_.at(curve.at(way_m).at_in_couch);
      if (cap(technique, zone) <= 0.0) {
        denied = zone;
        start_m = way_m + check_m;
      } else if (way_m - start_m > longest.second - longest.first) {
        longest = {start_m, way_m};
      }
    }
    return longest;
  }

  static SurfaceCurve stretch_of(const SurfaceCurve& curve, double from_m, double to_m) {
    std::vector<body::SurfacePoint> points;
    const int steps = static_cast<int>(std::ceil((to_m - from_m) / check_m));
    for (int i = 0; i <= steps; ++i)
      points.push_back(curve.at(from_m + (to_m - from_m) * i / steps));
    return SurfaceCurve(points, false);
  }

  Zone strictest(const SurfaceCurve& curve, Technique technique) {
    Zone found = Zone::muscle;
    const int steps = static_cast<int>(std::ceil(curve.length_m() / check_m));
    for (int i = 0; i <= steps; ++i) {
      const Zone zone = zones_.at(curve.at(std::min(i * check_m, curve.length_m())).at_in_couch);
      touched_.insert(zone);
      if (cap(technique, zone) < cap(technique, found)) found = zone;
    }
    return found;
  }

  const body::BackSurface& back_;
  std::span<const Acupoint> acupoints_;
  BackChart chart_;
  ZoneMap zones_;
  const PlanOptions& options_;
  double force_scale_;
  std::vector<WaitingPath> paths_;
  std::set<Zone> touched_;
  std::vector<std::string> notes_;
};

}  // namespace

Result<Plan> plan(const body::BackSurface& back, std::span<const Acupoint> acupoints,
                  std::span<const Landmark> landmarks, const Programme& programme,
                  const PlanOptions& options) {
  for (const Acupoint& point : acupoints) {
    const bool sane = point.at_in_couch.allFinite() && std::isfinite(point.uncertainty_m) &&
                      point.uncertainty_m >= 0.0;
    if (!sane) return fail(Fault::bad_input, "the acupoint {} has no finite place", point.name);
  }
  for (const Landmark& landmark : landmarks) {
    if (!landmark.at_in_couch.allFinite()) {
      return fail(Fault::bad_input, "the landmark {} has no finite place", landmark.name);
    }
  }
  auto chart = BackChart::from(acupoints, landmarks);
  if (!chart) return tl::unexpected(chart.error());
  const ZoneMap zones(*chart, acupoints, landmarks);
  Planner planner(back, acupoints, *chart, zones, options,
                  options.force_scale * force_scale_of(programme.intensity));
  for (std::size_t i = 0; i < programme.parts.size(); ++i) {
    if (auto added = planner.add(programme.parts[i], static_cast<int>(i)); !added) {
      return tl::unexpected(added.error());
    }
  }
  Plan result = std::move(planner).finish(programme.name);
  if (result.paths.empty()) {
    return fail(Fault::not_found, "nothing of the programme {} may be done on this back: {}",
                programme.name, fmt::join(result.notes, "; "));
  }
  return result;
}

}  // namespace tuina::massage
