// SPDX-License-Identifier: Apache-2.0
#include "tuina/massage/plan.hpp"

#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

#include "tuina/core/io/text_lines.hpp"
#include "tuina/core/units.hpp"
#include "tuina/massage/path_layer.hpp"
#include "tuina/massage/seen_skin.hpp"

namespace tuina::massage {
namespace {

Result<void> check_finite(std::span<const Acupoint> acupoints,
                          std::span<const Landmark> landmarks) {
  for (const Acupoint& point : acupoints) {
    if (!point.at_in_couch.allFinite() || !std::isfinite(point.uncertainty_m) ||
        point.uncertainty_m < 0.0) {
      return fail(Fault::bad_input, "the acupoint {} has no finite place and uncertainty",
                  point.name);
    }
  }
  for (const Landmark& landmark : landmarks) {
    if (!landmark.at_in_couch.allFinite()) {
      return fail(Fault::bad_input, "the landmark {} has no finite place", landmark.name);
    }
  }
  return {};
}

/// One point may lie where the scan shows no skin; where most of them do, they are of another scan.
Result<void> check_same_scan(std::span<const Acupoint> acupoints, const body::BackSurface& back) {
  std::size_t off = 0;
  std::string first;
  for (const Acupoint& point : acupoints) {
    const auto place = on_skin(back, point);
    if (place) continue;
    if (off++ == 0) first = place.error().message;
  }
  if (2 * off > acupoints.size()) return fail(Fault::bad_input, "{}", first);
  return {};
}

/// The smallest distance of two paths that run together.
double min_tool_distance_m(const std::vector<PlannedPath>& paths) {
  double nearest_m = 0.0;
  for (std::size_t i = 1; i < paths.size(); ++i) {
    if (paths[i].step != paths[i - 1].step) continue;
    const double apart_m = distance_between_m(paths[i - 1].path, paths[i].path);
    nearest_m = nearest_m == 0.0 ? apart_m : std::min(nearest_m, apart_m);
  }
  return nearest_m;
}

/// The points whose place is known less well than a press tolerates, in one sentence; each is
/// pressed all the same, where the map has it.
Sentence doubtful_places(std::span<const Acupoint> acupoints, std::span<const PlannedPath> paths) {
  std::vector<std::string> doubtful;
  for (const Acupoint& point : acupoints) {
    const bool pressed = std::any_of(paths.begin(), paths.end(), [&](const PlannedPath& planned) {
      return planned.path.technique == Technique::press &&
             planned.path.acupoints.front() == point.name;
    });
    if (pressed && point.uncertainty_m > contact_radius_m)
      doubtful.push_back(
          fmt::format("{} {:.0f}", point.name, std::ceil(to_mm(point.uncertainty_m))));
  }
  if (doubtful.empty()) return {};
  return sentence("note_places_unsure",
                  "the tool covers {:.0f} mm, and the places of these points are known less well "
                  "than that (95 %, mm): {}",
                  to_mm(contact_radius_m), fmt::format("{}", fmt::join(doubtful, ", ")));
}

/// An area that is to be kept free and in which the scan shows no skin, in one sentence: another
/// frame, another scan, or what lies out of view.
Sentence nowhere(const NoGo& entry, const body::BackSurface& back, const BackChart& chart,
                 std::span<const Acupoint> acupoints, std::span<const Landmark> landmarks) {
  const ZoneMap alone(chart, acupoints, landmarks, {&entry, 1});
  const bool somewhere = std::ranges::any_of(
      back.points().points, [&](const Vector3& at) { return alone.at(at) == Zone::no_go; });
  if (somewhere) return {};
  return sentence(
      "note_no_go_nowhere",
      "{} keeps no skin free that the scan shows: are its corners those of this scan, in "
      "metres, in couch?",
      entry.name);
}

bool other_side_of(const ContactPath& one, const ContactPath& other) {
  return std::equal(one.name.begin(), one.name.end(), other.name.begin(), other.name.end(),
                    [](char a, char b) { return a == b || (a == 'L' && b == 'R'); });
}

/// Adds the paths of a part in their order, or lets the two sides of a place take turns.
void add_in_turns(std::vector<WaitingPath>& waiting, const std::vector<WaitingPath>& of_part,
                  const Part& part) {
  constexpr int usual = 3;
  const int turns = part.alternating ? part.repeats.value_or(usual) : 1;
  for (std::size_t k = 0; k < of_part.size();) {
    const bool pair = part.alternating && k + 1 < of_part.size() &&
                      other_side_of(of_part[k].path, of_part[k + 1].path);
    const std::size_t end = k + (pair ? 2 : 1);
    for (int turn = 0; turn < turns; ++turn) {
      for (std::size_t m = k; m < end; ++m) {
        waiting.push_back(of_part[m]);
        waiting.back().together = part.together && !part.alternating;
      }
    }
    k = end;
  }
}

}  // namespace

Result<Plan> plan(const body::BackSurface& back, std::span<const Acupoint> acupoints,
                  std::span<const Landmark> landmarks, const Programme& programme,
                  const PlanOptions& options) {
  if (auto finite = check_finite(acupoints, landmarks); !finite) {
    return tl::unexpected(finite.error());
  }
  if (auto same = check_same_scan(acupoints, back); !same) return tl::unexpected(same.error());
  const auto chart = BackChart::from(acupoints, landmarks);
  if (!chart) return tl::unexpected(chart.error());
  const ZoneMap zones(*chart, acupoints, landmarks, options.no_go);
  PathLayer layer(back, *chart, zones, options,
                  options.force_scale * force_scale_of(programme.intensity));
  std::vector<WaitingPath> waiting;
  for (std::size_t i = 0; i < programme.parts.size(); ++i) {
    const auto targets = targets_of(programme.parts[i], *chart, acupoints);
    if (!targets) return tl::unexpected(targets.error());
    std::vector<WaitingPath> of_part;
    Part ordered = programme.parts[i];
    std::optional<double> pass_s;
    if (ordered.hand_over_hand) {
      pass_s = layer.hand_over_hand_s(ordered, *targets);
      ordered.alternating = !pass_s;
    }
    Part once = ordered;
    if (once.alternating) once.repeats = 1;
    for (const Target& target : *targets) {
      auto path = layer.lay(once, target, pass_s);
      if (!path) return tl::unexpected(path.error());
      if (!*path) continue;
      (*path)->part = static_cast<int>(i);
      of_part.push_back(std::move(**path));
    }
    add_in_turns(waiting, of_part, ordered);
  }
  if (waiting.empty()) {
    return fail(Fault::not_found, "nothing of the programme {} may be done on this back: {}",
                programme.name, listed(words_of(layer.notes()), "; "));
  }
  Plan result;
  result.programme = programme.name;
  result.paths = schedule(std::move(waiting), options.transfers);
  for (const PlannedPath& path : result.paths) {
    const double left_s = path.end_s() + options.transfers.retract_s();
    result.duration_s = std::max(result.duration_s, left_s);
  }
  result.min_tool_distance_m = min_tool_distance_m(result.paths);
  for (const Zone zone : layer.touched()) result.zones_touched.emplace_back(name_of(zone));
  result.notes = layer.notes();
  for (const NoGo& entry : options.no_go) {
    if (Sentence lost = nowhere(entry, back, *chart, acupoints, landmarks); !lost.empty())
      result.notes.push_back(std::move(lost));
  }
  if (Sentence doubt = doubtful_places(acupoints, result.paths); !doubt.empty())
    result.notes.push_back(std::move(doubt));
  return result;
}

bool tells_left_out(const Sentence& note) {
  constexpr std::array<std::string_view, 5> keys = {"note_place_unsure", "note_beyond_scan",
                                                    "note_zone_denied", "note_out_of_reach",
                                                    "note_arms_too_close"};
  return std::find(keys.begin(), keys.end(), note.key) != keys.end();
}

}  // namespace tuina::massage
