// SPDX-License-Identifier: Apache-2.0
#include "apps/cli/mark_names.hpp"

#include <algorithm>
#include <limits>

#include "tuina/core/units.hpp"

namespace tuina::app {
namespace {

constexpr double level_gap_m = 12_mm;  // a therapist sets the two stickers of a pair askew by less
constexpr double pair_gap_m = 20_mm;
constexpr double never_m = 60_mm;  // four times the largest error of the shipped atlas

std::map<std::string, Vector3> places_of(const body::Mapping& mapping) {
  std::map<std::string, Vector3> places;
  for (const auto& point : mapping.acupoints) places[point.name] = point.at_in_couch;
  for (const auto& landmark : mapping.landmarks) places[landmark.name] = landmark.at_in_couch;
  return places;
}

/// Directions on the person, from pairs and midline points of the atlas.
struct PersonAxes {
  Vector3 to_left = Vector3::Zero();
  Vector3 to_head = Vector3::Zero();
};

PersonAxes axes_of(const std::map<std::string, Vector3>& places) {
  PersonAxes axes;
  for (const auto& [name, place] : places) {
    if (!name.ends_with("_L")) continue;
    const auto right = places.find(name.substr(0, name.size() - 1) + "R");
    if (right != places.end()) axes.to_left += place - right->second;
  }
  axes.to_left.normalize();
  axes.to_head = places.at("BL47_L") + places.at("BL47_R") - 2.0 * places.at("GV4");
  axes.to_head = (axes.to_head - axes.to_head.dot(axes.to_left) * axes.to_left).normalized();
  return axes;
}

std::string where(const Vector3& place) {
  return fmt::format("x {:.0f}, y {:.0f}, z {:.0f} mm", to_mm(place.x()), to_mm(place.y()),
                     to_mm(place.z()));
}

/// Points of a group that have no sticker of its colour anywhere near.
std::string without_sticker(const StickerGroup& group,
                            const std::vector<scanner::Sticker>& of_colour,
                            const std::map<std::string, Vector3>& expected) {
  std::string names;
  for (const auto& level : group.levels) {
    for (const std::string& name : level) {
      const auto place = expected.find(name);
      if (place == expected.end()) continue;
      const bool near =
          std::any_of(of_colour.begin(), of_colour.end(), [&](const scanner::Sticker& s) {
            return (s.at_in_couch - place->second).norm() < 0.5 * never_m;
          });
      if (!near) names += (names.empty() ? "" : ", ") + name;
    }
  }
  return names;
}

Result<void> check_count(const StickerGroup& group, const std::vector<scanner::Sticker>& of_colour,
                         const std::map<std::string, Vector3>& expected) {
  const std::size_t wanted = group.count();
  if (of_colour.size() == wanted) return {};
  const char* colour = scanner::name_of(group.colour);
  if (of_colour.size() > wanted) {
    std::string places;
    for (const auto& sticker : of_colour) places += "\n  " + where(sticker.at_in_couch);
    return fail(Fault::bad_input, "{} {} stickers are seen and {} points are named for them:{}",
                of_colour.size(), colour, wanted, places);
  }
  const std::string missing = without_sticker(group, of_colour, expected);
  const bool dim =
      group.colour == scanner::StickerColour::blue || group.colour == scanner::StickerColour::green;
  return fail(Fault::bad_input, "{} of {} {} stickers are seen{}{}", of_colour.size(), wanted,
              colour,
              missing.empty() ? std::string("; is one hidden, or do two touch?")
                              : fmt::format("; there is none near {}", missing),
              dim ? "; magenta and yellow send back more of a red line" : "");
}

}  // namespace

Result<std::map<std::string, scanner::Sticker>> name_stickers(
    const std::vector<scanner::Sticker>& stickers, const std::vector<StickerGroup>& groups,
    const body::Mapping& expected) {
  const auto places = places_of(expected);
  const PersonAxes axes = axes_of(places);
  std::map<std::string, scanner::Sticker> named;
  for (const StickerGroup& group : groups) {
    const char* colour = scanner::name_of(group.colour);
    std::vector<scanner::Sticker> of_colour;
    std::copy_if(stickers.begin(), stickers.end(), std::back_inserter(of_colour),
                 [&](const scanner::Sticker& s) { return s.colour == group.colour; });
    if (auto right = check_count(group, of_colour, places); !right) {
      return tl::unexpected(right.error());
    }
    const auto height = [&](const scanner::Sticker& s) { return axes.to_head.dot(s.at_in_couch); };
    std::sort(of_colour.begin(), of_colour.end(),
              [&](const auto& a, const auto& b) { return height(a) > height(b); });
    auto next = of_colour.begin();
    for (const auto& level : group.levels) {
      const auto end = next + static_cast<std::ptrdiff_t>(level.size());
      if (end != of_colour.end() && height(*(end - 1)) - height(*end) < level_gap_m) {
        return fail(
            Fault::bad_input,
            "two {} stickers are {:.0f} mm apart along the spine ({} and {}): which of them "
            "is {} cannot be told; give one of them another colour",
            colour, to_mm(height(*(end - 1)) - height(*end)), where((end - 1)->at_in_couch),
            where(end->at_in_couch), level.back());
      }
      // The left of a pair first.
      std::sort(next, end, [&](const auto& a, const auto& b) {
        return axes.to_left.dot(a.at_in_couch - b.at_in_couch) > 0.0;
      });
      if (level.size() == 2 &&
          axes.to_left.dot(next->at_in_couch - (next + 1)->at_in_couch) < pair_gap_m) {
        return fail(
            Fault::bad_input,
            "the {} stickers of {} and {} lie above each other ({} and {}): is the list from "
            "the head to the feet?",
            colour, level[0], level[1], where(next->at_in_couch), where((next + 1)->at_in_couch));
      }
      for (const std::string& name : level) named[name] = *next++;
    }
  }
  for (const auto& [name, sticker] : named) {
    const auto place = places.find(name);
    if (place == places.end()) continue;
    const double off = (sticker.at_in_couch - place->second).norm();
    if (off > never_m) {
      return fail(
          Fault::bad_input,
          "the {} sticker at {} would be {}, which the atlas expects {:.0f} mm away: is the "
          "list from the head to the feet, and the colour right?",
          scanner::name_of(sticker.colour), where(sticker.at_in_couch), name, to_mm(off));
    }
  }
  return named;
}

}  // namespace tuina::app
