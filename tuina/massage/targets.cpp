// SPDX-License-Identifier: Apache-2.0
#include "tuina/massage/targets.hpp"

#include <algorithm>
#include <cmath>

#include "tuina/core/io/text_lines.hpp"
#include "tuina/core/units.hpp"
#include "tuina/massage/technique_law.hpp"

namespace tuina::massage {
namespace {

bool names_its_side(const std::string& name) {
  return name.ends_with("_L") || name.ends_with("_R") || name.starts_with("GV");
}

std::string on_side(const std::string& name, double side) {
  return names_its_side(name) ? name : name + (side > 0.0 ? "_L" : "_R");
}

std::vector<double> sides_of(Side side) {
  if (side == Side::left) return {1.0};
  if (side == Side::right) return {-1.0};
  return {1.0, -1.0};
}

Result<Acupoint> point_of(const std::string& name, std::span<const Acupoint> acupoints) {
  const auto found = std::find_if(acupoints.begin(), acupoints.end(),
                                  [&](const Acupoint& a) { return a.name == name; });
  if (found != acupoints.end()) return *found;
  std::vector<std::string> known;
  for (const Acupoint& a : acupoints) known.push_back(a.name);
  return fail(Fault::bad_input, "the programme wants {}, the map of this back has {}", name,
              listed(known));
}

const std::string own_line = "own_line";

/// One stroke a side.
Result<std::vector<Target>> lines_of(const Part& part, const BackChart& chart,
                                     std::span<const Acupoint> acupoints) {
  std::vector<Target> targets;
  for (const double side : sides_of(part.side)) {
    const std::string& name_of_line = part.places.empty() ? part.line : own_line;
    Target target{name_of_line + (side > 0.0 ? "_L" : "_R"), {}, side};
    for (const std::string& name : part.points) {
      const auto found = point_of(on_side(name, side), acupoints);
      if (!found) return tl::unexpected(found.error());
      target.points.push_back(*found);
    }
    if (!target.points.empty()) {
      target.name = fmt::format("{} to {}", target.points.front().name, target.points.back().name);
      target.side = chart.place_of(target.points.front().at_in_couch).left_m;
    }
    targets.push_back(std::move(target));
    const bool both_are_one =
        !part.points.empty() && std::all_of(part.points.begin(), part.points.end(), names_its_side);
    if (both_are_one) break;
  }
  return targets;
}

/// One target a point and side.
Result<std::vector<Target>> points_of(const Part& part, const BackChart& chart,
                                      std::span<const Acupoint> acupoints) {
  std::vector<Target> targets;
  for (const std::string& name : part.points) {
    for (const double side : sides_of(names_its_side(name) ? Side::left : part.side)) {
      const auto found = point_of(on_side(name, side), acupoints);
      if (!found) return tl::unexpected(found.error());
      targets.push_back({found->name, {*found}, chart.place_of(found->at_in_couch).left_m});
    }
  }
  if (part.order == Order::listed) return targets;
  const double sign = part.order == Order::downward ? -1.0 : 1.0;
  // Points of one level count as equally high, so that the two sides stay next to each other.
  constexpr double one_level_m = 20_mm;
  const auto rank = [&](const Target& target) {
    const double up_m = chart.place_of(target.points.front().at_in_couch).up_m;
    return std::round(sign * up_m / one_level_m);
  };
  std::stable_sort(targets.begin(), targets.end(),
                   [&](const Target& a, const Target& b) { return rank(a) < rank(b); });
  return targets;
}

}  // namespace

Result<std::vector<Target>> targets_of(const Part& part, const BackChart& chart,
                                       std::span<const Acupoint> acupoints) {
  const bool along_a_line = slides(part.technique) && !law_of(part.technique).circles;
  return along_a_line ? lines_of(part, chart, acupoints) : points_of(part, chart, acupoints);
}

std::vector<Place> places_of(const Part& stroke, const BackChart& chart, double side) {
  const double cun_m = (side > 0.0 ? 1.0 : -1.0) * chart.cun_m();
  const auto level = [&](Level name) { return chart.up_of(name); };
  std::vector<Place> places;
  for (const RelativePlace& place : stroke.places) places.push_back(chart.place_at(place, side));
  if (!places.empty()) return places;
  const std::string& line = stroke.line;
  if (line == "scapula") {
    for (const Level name : {Level::T3, Level::T7, Level::T9}) {
      places.push_back({2.2 * cun_m, level(name)});
    }
  } else if (line == "loin") {
    const double l3_up_m = 0.5 * (level(Level::L2) + level(Level::L4));
    for (const double cun : {1.8, 3.2, 4.6}) places.push_back({cun * cun_m, l3_up_m});
  } else {
    const double cun = line == "bladder_inner" ? 1.5 : 3.0;
    for (const Level name : {Level::T3, Level::T7, Level::T9, Level::T12, Level::L2, Level::L4}) {
      places.push_back({cun * cun_m, level(name)});
    }
  }
  return places;
}

}  // namespace tuina::massage
