// SPDX-License-Identifier: Apache-2.0
#include "apps/cli/mark_names.hpp"

#include <algorithm>
#include <limits>

#include "tuina/core/units.hpp"

namespace tuina::app {
namespace {

constexpr double level_gap_m = 12_mm;  // a therapist sets the two stickers of a pair askew by less
constexpr double pair_gap_m = 20_mm;
constexpr double near_m = 30_mm;

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

/// Points of a group that have no mark of its kind anywhere near.
std::string without_mark(const MarkGroup& group, const std::vector<SkinMark>& of_kind,
                         const std::map<std::string, Vector3>& expected) {
  std::string names;
  for (const auto& level : group.levels) {
    for (const std::string& name : level) {
      const auto place = expected.find(name);
      if (place == expected.end()) continue;
      const bool near = std::any_of(of_kind.begin(), of_kind.end(), [&](const SkinMark& s) {
        return (s.at_in_couch - place->second).norm() < near_m;
      });
      if (!near) names += (names.empty() ? "" : ", ") + name;
    }
  }
  return names;
}

std::string marks_of(const std::string& kind) {
  return kind == bump_kind ? "bumps" : kind + " stickers";
}

Result<void> check_count(const MarkGroup& group, const std::vector<SkinMark>& of_kind,
                         const std::map<std::string, Vector3>& expected) {
  const std::size_t wanted = group.count();
  if (of_kind.size() == wanted) return {};
  if (of_kind.size() > wanted) {
    std::string places;
    for (const auto& mark : of_kind) places += "\n  " + where(mark.at_in_couch);
    return fail(Fault::bad_input, "{} {} are seen and {} points are named for them:{}",
                of_kind.size(), marks_of(group.kind), wanted, places);
  }
  const std::string missing = without_mark(group, of_kind, expected);
  const bool dim = group.kind == "blue" || group.kind == "green";
  return fail(Fault::bad_input, "{} of {} {} are seen{}{}", of_kind.size(), wanted,
              marks_of(group.kind),
              missing.empty() ? std::string("; is one hidden, or do two touch?")
                              : fmt::format("; there is none near {}", missing),
              dim ? "; magenta and yellow send back more of a red line" : "");
}

}  // namespace

Result<std::map<std::string, std::size_t>> name_marks(const std::vector<SkinMark>& marks,
                                                      const std::vector<MarkGroup>& groups,
                                                      const body::Mapping& expected,
                                                      double max_off_m) {
  const auto places = places_of(expected);
  const PersonAxes axes = axes_of(places);
  std::map<std::string, std::size_t> named;
  for (const MarkGroup& group : groups) {
    std::vector<SkinMark> of_kind;
    std::vector<std::size_t> order;
    for (std::size_t i = 0; i < marks.size(); ++i) {
      if (marks[i].kind != group.kind) continue;
      of_kind.push_back(marks[i]);
      order.push_back(i);
    }
    if (auto right = check_count(group, of_kind, places); !right)
      return tl::unexpected(right.error());
    const auto at = [&](std::size_t i) -> const Vector3& { return marks[i].at_in_couch; };
    const auto height = [&](std::size_t i) { return axes.to_head.dot(at(i)); };
    std::sort(order.begin(), order.end(),
              [&](std::size_t a, std::size_t b) { return height(a) > height(b); });
    auto next = order.begin();
    for (const auto& level : group.levels) {
      const auto end = next + static_cast<std::ptrdiff_t>(level.size());
      if (end != order.end() && height(*(end - 1)) - height(*end) < level_gap_m) {
        return fail(Fault::bad_input,
                    "two {} are {:.0f} mm apart along the spine ({} and {}): which of them is {} "
                    "cannot be told; {}",
                    marks_of(group.kind), to_mm(height(*(end - 1)) - height(*end)),
                    where(at(*(end - 1))), where(at(*end)), level.back(),
                    group.kind == bump_kind ? "is the list from the head to the feet?"
                                            : "give one another colour");
      }
      // The left of a pair first.
      std::sort(next, end, [&](std::size_t a, std::size_t b) {
        return axes.to_left.dot(at(a) - at(b)) > 0.0;
      });
      if (level.size() == 2 && axes.to_left.dot(at(*next) - at(*(next + 1))) < pair_gap_m) {
        return fail(Fault::bad_input,
                    "the {} of {} and {} lie above each other ({} and {}): is the list from the "
                    "head to the feet?",
                    marks_of(group.kind), level[0], level[1], where(at(*next)),
                    where(at(*(next + 1))));
      }
      for (const std::string& name : level) named[name] = *next++;
    }
  }
  for (const auto& [name, mark] : named) {
    const auto place = places.find(name);
    if (place == places.end()) continue;
    const double off_m = (marks[mark].at_in_couch - place->second).norm();
    if (off_m > max_off_m) {
      return fail(Fault::bad_input,
                  "of the {} that at {} would be {}, which the atlas expects {:.0f} mm away: is "
                  "the list from the head to the feet, and is it of what is on the skin?",
                  marks_of(marks[mark].kind), where(marks[mark].at_in_couch), name, to_mm(off_m));
    }
  }
  return named;
}

}  // namespace tuina::app
