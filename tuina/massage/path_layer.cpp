// SPDX-License-Identifier: Apache-2.0
#include "tuina/massage/path_layer.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "tuina/core/units.hpp"
#include "tuina/massage/seen_skin.hpp"
#include "tuina/massage/technique/contact_path.hpp"
#include "tuina/massage/technique/press.hpp"
#include "tuina/massage/technique/rub.hpp"
#include "tuina/massage/technique/tap.hpp"
#include "tuina/massage/technique_law.hpp"
#include "tuina/massage/zone_walk.hpp"

namespace tuina::massage {
namespace {

constexpr double min_kept_m = 60_mm;         // of a stroke that zones cut
constexpr double min_stroke_m = 30_mm;       // less is within the width of a tool, and a press
constexpr double max_uncertainty_m = 50_mm;  // a tool sent farther off may come down anywhere

}  // namespace

PathLayer::PathLayer(const body::BackSurface& back, const BackChart& chart, const ZoneMap& zones,
                     const PlanOptions& options, double force_scale)
    : back_(back), chart_(chart), zones_(zones), options_(options), force_scale_(force_scale) {}

std::optional<double> PathLayer::hand_over_hand_s(const Part& part, std::span<const Target> lines) {
  constexpr double every_m = 10_mm;
  double pass_s = 0.0, nearest_m = std::numeric_limits<double>::infinity();
  std::vector<SurfaceCurve> laid;
  for (const Target& target : lines) {
    const auto bend = [&](const Vector3& guide) {
      return zones_.around_denied(guide, target.side);
    };
    auto curve = line(part, target, bend);
    if (!curve) return std::nullopt;  // `lay` will say why the line is left out
    pass_s = std::max(pass_s, hand_over_hand_pass_s(curve->length_m(), part.speed_m_per_s));
    laid.push_back(std::move(*curve));
  }
  for (int i = 0; laid.size() == 2 && i * every_m <= laid[0].length_m(); ++i) {
    const Vector3 at = laid[0].at(i * every_m).at_in_couch;
    for (int k = 0; k * every_m <= laid[1].length_m(); ++k)
      nearest_m = std::min(nearest_m, (laid[1].at(k * every_m).at_in_couch - at).norm());
  }
  if (laid.size() == 2 && nearest_m >= closest_tools_m) return pass_s;
  name_ = fmt::format("{} {}", name_of(part.technique), lines.front().name);
  note("note_hand_after_hand",
       "hand after hand, not hand over hand: the tools would come within {:.0f} mm, {:.0f} are "
       "needed",
       to_mm(nearest_m), to_mm(closest_tools_m));
  return std::nullopt;
}

Result<std::optional<WaitingPath>> PathLayer::lay(const Part& part, const Target& target,
                                                  std::optional<double> pass_s) {
  name_ = fmt::format("{} {}", name_of(part.technique), target.name);
  for (const Acupoint& point : target.points) {
    if (point.uncertainty_m <= max_uncertainty_m) continue;
    note("note_place_unsure",
         "left out, the place of {} is known to {:.0f} mm only, {:.0f} mm at most are allowed",
         point.name, to_mm(point.uncertainty_m), to_mm(max_uncertainty_m));
    return std::optional<WaitingPath>{};
  }
  auto waiting =
      slides(part.technique) ? lay_sliding(part, target, pass_s) : lay_standing(part, target);
  if (!waiting && waiting.error().fault == Fault::not_found) {
    // The scan ends before the path does; the rest of the programme can still be given.
    note("note_beyond_scan", "left out, {}", waiting.error().message);
    return std::optional<WaitingPath>{};
  }
  if (!waiting) {
    return tl::unexpected(Error{waiting.error().fault, name_ + ": " + waiting.error().message});
  }
  if (*waiting && !is_shown(back_, (*waiting)->path)) {
    note("note_beyond_scan", "left out, the scan shows no skin along all of it");
    return std::optional<WaitingPath>{};
  }
  if (*waiting) {
    for (const Acupoint& point : target.points) (*waiting)->path.acupoints.push_back(point.name);
    (*waiting)->together = part.together;
  }
  return waiting;
}

/// Pressing and tapping: one place, one zone.
PathLayer::MaybePath PathLayer::lay_standing(const Part& part, const Target& target) {
  const auto place = on_skin(back_, target.points.front());
  if (!place) return tl::unexpected(place.error());
  const Zone zone = zones_.at(place->at_in_couch);
  const bool perhaps_spine = zones_.perhaps_spine(place->at_in_couch);
  WaitingPath path = waiting(part, zone, perhaps_spine);
  const double force_n = std::min(path.programme_n, path.cap_n);
  if (force_n <= 0.0) return left_out(zone);
  touched_.insert(zone);
  path.arm = arm_of(place->at_in_couch);
  if (part.technique == Technique::press) {
    path.path = pressed(*place, part, zone, force_n);
  } else {
    const double max_s = rule_of(zone).max_duration_s - 2.0 * landing_s;
    const double time_s = std::min(part.time_s.value_or(4.0), max_s);
    const double strongest_n = strongest_tap_n(part.rate_hz);
    if (force_n > strongest_n) {
      note("note_taps_lowered", "{:.1f} N lowered to {:.1f} N, the most at {} taps a second",
           force_n, strongest_n, part.rate_hz);
      path.lowered_by = sentence("by_taps", "{} taps a second", part.rate_hz);
    }
    path.path =
        plan_tap(*place, {.force_n = force_n, .rate_hz = part.rate_hz, .time_s = time_s}, name_);
  }
  return path;
}

/// The presses ordered, fewer or shorter where the zone does not bear them for so long.
ContactPath PathLayer::pressed(const body::SurfacePoint& place, const Part& part, Zone zone,
                               double force_n) {
  PressOptions press{.force_n = force_n, .window = {.edge_s = part.rise_s, .hold_s = part.hold_s}};
  const double cycle_s = press.window.length_s() + press.pause_s;
  const double in_time = part.time_s.value_or(2.0 * cycle_s) / cycle_s;
  const int wanted = part.repeats.value_or(std::max(1, static_cast<int>(std::lround(in_time))));
  press.repeats = wanted;
  const double max_duration_s = rule_of(zone).max_duration_s;
  ContactPath path = plan_press(place, press, name_);
  while (path.duration_s() > max_duration_s) {
    if (press.repeats > 1) {
      --press.repeats;
    } else {
      press.window.hold_s *= 0.9;
      press.window.edge_s *= 0.9;
    }
    path = plan_press(place, press, name_);
  }
  if (press.repeats < wanted) {
    note("note_fewer_presses", "{} instead of {} presses, {} bears {:.0f} s of contact",
         press.repeats, wanted, name_of(zone), max_duration_s);
  }
  if (press.window.hold_s < part.hold_s) {
    note("note_held_shorter", "held for {:.1f} s instead of {:.1f} s, {} bears {:.0f} s of contact",
         press.window.hold_s, part.hold_s, name_of(zone), max_duration_s);
  }
  return path;
}

/// Rubbing and stroking: a curve through zones, the strictest of which counts for all of it.
PathLayer::MaybePath PathLayer::lay_sliding(const Part& part, const Target& target,
                                            std::optional<double> pass_s) {
  double bent_m = 0.0;
  const Bend bend = [&](const Vector3& guide) {
    Vector3 moved = zones_.around_denied(guide, target.side);
    bent_m = std::max(bent_m, (moved - guide).norm());
    return moved;
  };
  const TechniqueLaw& law = law_of(part.technique);
  auto curve = law.circles ? circle(part, target, bend) : line(part, target, bend);
  if (!curve) return tl::unexpected(curve.error());
  if (bent_m > 1_mm)
    note("note_bent", "bent by up to {:.0f} mm around what must not be touched", to_mm(bent_m));

  ZoneWalk zones = walk(*curve, zones_, part.technique);
  if (zones.denied != Zone::muscle) {
    const double kept_m = zones.to_m - zones.from_m;
    if (law.circles || kept_m < min_kept_m) return left_out(zones.denied);
    note("note_cut", "cut from {:.0f} to {:.0f} mm at {}", to_mm(curve->length_m()), to_mm(kept_m),
         name_of(zones.denied));
    curve = stretch_of(*curve, zones.from_m, zones.to_m);
    zones = walk(*curve, zones_, part.technique);
    if (zones.denied != Zone::muscle) return left_out(zones.denied);
  }
  touched_.insert(zones.touched.begin(), zones.touched.end());
  WaitingPath path = waiting(part, zones.strictest, zones.perhaps_spine);
  const double force_n = std::min(path.programme_n, path.cap_n);
  path.arm = arm_of(curve->at(0.5 * curve->length_m()).at_in_couch);
  SlidingOrder order{.part = part, .force_n = force_n};
  if (pass_s) order.turn = HandOverHand{.pass_s = *pass_s, .second = target.side < 0.0};
  order.repeats = repeats_of(part, law.once_s(*curve, order), zones.strictest);
  path.path = law.along(*curve, order, name_);
  return path;
}

int PathLayer::repeats_of(const Part& part, double one_s, Zone zone) {
  constexpr double usual = 3.0;
  constexpr double ramps_s = 3.0;  // landing, gaining speed and leaving take no longer
  const double max_duration_s = rule_of(zone).max_duration_s;
  const double max_repeats = std::max(1.0, std::floor((max_duration_s - ramps_s) / one_s));
  double wanted = usual;
  if (part.repeats) wanted = *part.repeats;
  if (part.time_s) wanted = std::max(1.0, std::round(*part.time_s / one_s));
  if (wanted > max_repeats) {
    note("note_fewer_times", "{:.0f} instead of {:.0f} times, {:.0f} s are allowed at one place",
         max_repeats, wanted, max_duration_s);
  }
  return static_cast<int>(std::min(wanted, max_repeats));
}

Result<SurfaceCurve> PathLayer::circle(const Part& part, const Target& target,
                                       const Bend& bend) const {
  const auto centre = on_skin(back_, target.points.front());
  if (!centre) return tl::unexpected(centre.error());
  // Both hands begin outside and go round as mirror images of each other.
  const bool left = target.side >= 0.0;
  const Vector3 outside = left ? chart_.left() : Vector3(-chart_.left());
  const Vector3 first = law_of(part.technique).begins_at_spine ? Vector3(-outside) : outside;
  const auto curve_on = part.spiral ? spiral_on : circle_on;
  return curve_on(back_, *centre, part.radius_m, first, left, bend);
}

Result<SurfaceCurve> PathLayer::line(const Part& part, const Target& target,
                                     const Bend& bend) const {
  std::vector<Vector3> places;
  for (const Acupoint& point : target.points) places.push_back(point.at_in_couch);
  if (places.empty()) {
    for (const Place& place : places_of(part, chart_, target.side)) {
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
  auto curve = line_through(back_, places, bend);
  if (curve && curve->length_m() < min_stroke_m) {
    return fail(Fault::not_found, "the stroke is {:.0f} mm long: {:.0f} at least",
                to_mm(curve->length_m()), to_mm(min_stroke_m));
  }
  return curve;
}

std::optional<Arm> PathLayer::arm_of(const Vector3& in_couch) const {
  constexpr double either_m = 15_mm;
  const double left_m = chart_.place_of(in_couch).left_m;
  if (std::abs(left_m) < either_m) return std::nullopt;
  // The left arm stands on the side of the couch's positive x, wherever the person's left is.
  return left_m * chart_.left().x() > 0.0 ? Arm::left : Arm::right;
}

double PathLayer::cap_of(Technique technique, Zone zone, bool perhaps_spine) const {
  const double of_zone_n = cap_n(zone, technique);
  const double of_muscle_n = zone == Zone::muscle ? options_.muscle_cap_n : of_zone_n;
  const double of_spine_n = perhaps_spine ? perhaps_spine_n(technique) : of_zone_n;
  return std::min({of_zone_n, of_muscle_n, of_spine_n, options_.force_ceiling_n});
}

/// A path of the part in that zone, still without its points.
WaitingPath PathLayer::waiting(const Part& part, Zone zone, bool perhaps_spine) {
  WaitingPath path{.path = {},
                   .zone = zone,
                   .cap_n = cap_of(part.technique, zone, perhaps_spine),
                   .programme_n = part.force_n * force_scale_};
  if (path.cap_n > 0.0 && path.programme_n > path.cap_n) {
    path.lowered_by = perhaps_spine
                          ? sentence("by_zone_perhaps_spine", "{}, perhaps spine", name_of(zone))
                          : sentence("by_zone", "{}", name_of(zone));
    note(perhaps_spine ? "note_lowered_perhaps_spine" : "note_lowered",
         "{:.1f} N lowered to {:.1f} N ({})", path.programme_n, path.cap_n, path.lowered_by.words);
    notes_.back().values.back() = name_of(zone);
  }
  return path;
}

PathLayer::MaybePath PathLayer::left_out(Zone zone) {
  note("note_zone_denied", "left out, it may not be done on {}", name_of(zone));
  return std::optional<WaitingPath>{};
}

template <typename... Args>
void PathLayer::note(const char* key, fmt::format_string<Args...> words, const Args&... args) {
  Sentence& added = notes_.emplace_back(sentence(key, words, args...));
  added.words = name_ + ": " + added.words;
  added.values.insert(added.values.begin(), name_);
}

}  // namespace tuina::massage
