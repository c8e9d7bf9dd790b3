// SPDX-License-Identifier: Apache-2.0
#include "tuina/massage/programme.hpp"

#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "tuina/core/io/file.hpp"
#include "tuina/core/io/near_miss.hpp"
#include "tuina/core/io/toml_reader.hpp"
#include "tuina/core/units.hpp"
#include "tuina/massage/technique/contact_path.hpp"
#include "tuina/massage/technique_law.hpp"
#include "tuina/massage/zones.hpp"

namespace tuina::massage {
namespace {

using Words = TomlTable::Words;

const Words paired_points = {"SI11", "BL47", "BL50", "BL13", "BL15",
                             "BL17", "BL18", "BL20", "BL21", "BL23"};
const Words spine_points = {"GV2", "GV3", "GV4", "GV6", "GV9", "GV12", "GV14"};

constexpr std::array<NamedLine, 4> lines = {{
    {"bladder_inner", "1.5 cun beside the spine, from T3 to L4"},
    {"bladder_outer", "3 cun beside the spine, from T3 to L4"},
    {"scapula", "along the medial border of the shoulder blade, between it and the spine"},
    {"loin", "across the loin, from beside the spine outwards below the ribs"},
}};

Words keys_of_any() {
  Words all;
  for (const Technique technique : all_techniques) {
    const Words& keys = law_of(technique).keys;
    all.insert(all.end(), keys.begin(), keys.end());
  }
  std::sort(all.begin(), all.end());
  all.erase(std::unique(all.begin(), all.end()), all.end());
  return all;
}

void read_points(const TomlTable& table, Part& part) {
  if (!table.has("points")) return;
  const auto names = table.list("points");
  if (!names || names->empty()) {
    table.reject("points", "points is not a list of acupoints, like [\"BL47\", \"BL50_L\"]");
    return;
  }
  Words known = paired_points;
  for (const std::string& name : paired_points) {
    known.push_back(name + "_L");
    known.push_back(name + "_R");
  }
  known.insert(known.end(), spine_points.begin(), spine_points.end());
  for (const TomlValue& entry : *names) {
    const std::string name = entry.text().value_or("");
    if (std::find(known.begin(), known.end(), name) == known.end()) {
      table.reject(entry,
                   fmt::format("the point `{}` is unknown; {}", name, suggestion(name, known)));
    } else if (name.starts_with("GV") && (name != "GV4" || part.technique != Technique::press)) {
      table.reject(entry,
                   fmt::format("`{}` lies on the spine, where only GV4 may be touched, and only "
                               "be pressed",
                               name));
    } else {
      part.points.push_back(name);
    }
  }
}

/// [[aside, up], ...]: cun beside the spine, and the share of the way from GV4 to C7.
void read_places(const TomlTable& table, Part& part) {
  if (!table.has("places")) return;
  constexpr std::size_t max_places = 100;
  const auto list = table.list("places");
  if (!list || list->size() < 2 || list->size() > max_places) {
    table.reject("places", fmt::format("places is not a list of 2 to {} places, like [[3.0, 0.8], "
                                       "[3.0, 0.1]]: cun beside the spine, share of the way from "
                                       "GV4 to C7",
                                       max_places));
    return;
  }
  for (const TomlValue& entry : *list) {
    const auto pair = entry.numbers(2);
    const double aside = pair ? (*pair)[0] : 0.0;
    const double up = pair ? (*pair)[1] : 0.0;
    if (pair && aside >= 0.5 && aside <= 8.0 && up >= -0.5 && up <= 1.2) {
      part.places.push_back({aside, up});
    } else {
      table.reject(entry,
                   fmt::format("{}a place is two numbers: 0.5 to 8 cun beside the spine, -0.5 to "
                               "1.2 of the way from GV4 to C7",
                               pair ? fmt::format("[{}, {}]: ", aside, up) : ""));
    }
  }
}

bool names_one_side(const std::string& point) {
  return point.ends_with("_L") || point.ends_with("_R");
}

/// Taking turns, `alternating` or `hand_over_hand`, needs two sides and a number of turns.
void check_turns(const TomlTable& table, const Part& part, const char* key) {
  if (part.side != Side::both) {
    table.reject(key, fmt::format("{} needs both sides, side = \"both\"", key));
  } else if (std::any_of(part.points.begin(), part.points.end(), names_one_side)) {
    table.reject(key, fmt::format("{} needs points of both sides, without _L or _R", key));
  }
  if (table.has("together") && part.together == part.alternating) {
    table.reject(key, fmt::format("{} and together = {} exclude each other", key, part.together));
  }
  if (table.has("time_s")) {
    table.reject(
        key, fmt::format("{} needs repeats, how often each side has its turn, not time_s", key));
  }
}

/// A point that names its side must not lie on the other one.
void check_side(const TomlTable& table, const Part& part) {
  if (part.side == Side::both) return;
  const bool left = part.side == Side::left;
  const auto across = std::ranges::find_if(
      part.points, [&](const std::string& point) { return point.ends_with(left ? "_R" : "_L"); });
  if (across != part.points.end())
    table.reject("side",
                 fmt::format("{} does not lie on the {}", *across, left ? "left" : "right"));
}

/// A line keeps to its side: no tool slides across the spine.
void check_crossing(const TomlTable& table, const Part& part) {
  const auto any_ends = [&](const char* ending) {
    return std::ranges::any_of(part.points,
                               [&](const std::string& point) { return point.ends_with(ending); });
  };
  const bool of_both = part.side == Side::both && !std::ranges::all_of(part.points, names_one_side);
  const bool left = any_ends("_L"), right = any_ends("_R");
  if ((left && right) || (of_both && (left || right))) {
    table.reject("points",
                 fmt::format("{} between points of different sides would cross the spine, which no "
                             "tool may; a part for each side is needed",
                             name_of(part.technique)));
  }
}

/// The tool must not slide too fast round its circle.
void check_speed(const TomlTable& table, const Part& part) {
  const double speed = 2.0 * pi * part.radius_m * part.rate_hz;
  if (speed <= max_slide_m_per_s) return;
  table.reject(
      "rate_hz",
      fmt::format("a circle of radius {:.0f} mm at {} turns per second slides with "
                  "{:.0f} mm/s, {:.0f} allowed",
                  to_mm(part.radius_m), part.rate_hz, to_mm(speed), to_mm(max_slide_m_per_s)));
}

/// A force that beats must not change too fast, at the intensity of the programme.
void check_beat(const TomlTable& table, const Part& part, int intensity) {
  const double fastest = law_of(part.technique).max_beat_n_per_s;
  const double strongest_n = strongest_beat_n(part.rate_hz, fastest) / force_scale_of(intensity);
  if (part.force_n <= strongest_n) return;
  const std::string at_intensity =
      intensity == 3 ? "" : fmt::format(" and intensity {}", intensity);
  table.reject("force_n", fmt::format("{} times per second with {} N change the force faster than "
                                      "{:.0f} N/s; at this rate{} {:.1f} N are allowed",
                                      part.rate_hz, part.force_n, fastest, at_intensity,
                                      std::floor(10.0 * strongest_n) / 10.0));
}

/// Refuses keys that are right one by one and contradict each other.
void check_part(const TomlTable& table, const Part& part, int intensity) {
  if (table.has("repeats") && table.has("time_s")) {
    table.reject("time_s", "repeats and time_s exclude each other");
  }
  const int ways = static_cast<int>(table.has("points")) + static_cast<int>(table.has("line")) +
                   static_cast<int>(table.has("places"));
  if (ways != 1) {
    table.reject("", part.technique == Technique::stroke
                         ? "stroke needs either points, a line or places"
                         : fmt::format("{} needs points", name_of(part.technique)));
  } else if (part.technique == Technique::stroke && part.points.size() == 1) {
    table.reject("points", "a stroke needs two points at least");
  }
  check_side(table, part);
  if (part.alternating && part.hand_over_hand) {
    table.reject("hand_over_hand", "alternating and hand_over_hand exclude each other");
  } else if (part.alternating || part.hand_over_hand) {
    check_turns(table, part, part.alternating ? "alternating" : "hand_over_hand");
  }
  const TechniqueLaw& law = law_of(part.technique);
  if (law.circles) check_speed(table, part);
  if (law.along != nullptr && !law.circles) check_crossing(table, part);
  if (law.max_beat_n_per_s > 0.0) check_beat(table, part, intensity);
}

std::optional<Part> read_part(const TomlTable& table, int intensity) {
  const auto technique = table.word("technique", technique_names());
  if (!technique) {
    if (!table.has("technique")) {
      table.reject("technique",
                   fmt::format("a part needs a technique: {}", fmt::join(technique_names(), ", ")));
    }
    table.only(keys_of_any(), {}, "a part");
    return std::nullopt;
  }
  Part part;
  part.technique = all_techniques[*technique];
  const TechniqueLaw& law = law_of(part.technique);
  table.only(law.keys, {}, name_of(part.technique));
  read_points(table, part);
  read_places(table, part);
  Words line_names;
  for (const NamedLine& line : lines) line_names.emplace_back(line.name);
  if (const auto line = table.word("line", line_names)) part.line = line_names[*line];
  if (const auto side = table.word("side", {"both", "left", "right"})) {
    part.side = static_cast<Side>(*side);
  }
  if (const auto order = table.word("order", {"listed", "downward", "upward"})) {
    part.order = static_cast<Order>(*order);
  }
  part.together = table.flag("together").value_or(part.together);
  part.alternating = table.flag("alternating").value_or(part.alternating);
  part.hand_over_hand = table.flag("hand_over_hand").value_or(part.hand_over_hand);
  const double ceiling_n = rule_of(Zone::muscle).cap_n;
  part.force_n = table.number("force_n", kept_force_n, ceiling_n)
                     .value_or(row_of(part.technique).usual_force_n);
  part.repeats = table.whole("repeats", 1, 20);
  part.time_s = table.number("time_s", 1.0, 60.0);
  part.hold_s = table.number("hold_s", 0.2, 10.0).value_or(part.hold_s);
  part.rise_s = table.number("rise_s", 0.3, 5.0).value_or(part.rise_s);
  part.radius_m = from_mm(table.number("radius_mm", law.radius_mm.min, law.radius_mm.max)
                              .value_or(law.radius_mm.usual));
  part.spiral = table.flag("spiral").value_or(part.spiral);
  part.speed_m_per_s = from_mm(table.number("speed_mm_per_s", 10.0, to_mm(max_slide_m_per_s))
                                   .value_or(to_mm(part.speed_m_per_s)));
  part.rate_hz =
      table.number("rate_hz", law.rate_hz.min, law.rate_hz.max).value_or(law.rate_hz.usual);
  check_part(table, part, intensity);
  return part;
}

Programme read_programme(const TomlTable& table) {
  Programme programme;
  table.only({"name", "description", "intensity", "part"}, {}, "a programme");
  programme.name = table.text("name").value_or("");
  programme.description = table.text("description").value_or("");
  programme.intensity = table.whole("intensity", 1, 5).value_or(programme.intensity);
  if (!table.has("name")) table.reject("name", "a programme needs a name");
  const auto parts = table.tables("part");
  constexpr std::size_t max_parts = 100;
  if (parts.empty()) {
    table.reject("part", "a programme needs at least one [[part]]");
  } else if (parts.size() > max_parts) {
    table.reject("part", fmt::format("{} parts, {} allowed", parts.size(), max_parts));
    return programme;
  }
  for (const TomlTable& part : parts) {
    if (auto read = read_part(part, programme.intensity))
      programme.parts.push_back(std::move(*read));
  }
  return programme;
}

}  // namespace

std::span<const NamedLine> named_lines() {
  return lines;
}

Result<Programme> parse_programme(std::string_view text, std::string_view name) {
  Programme programme;
  const auto read = read_toml(text, name, Fault::config,
                              [&](const TomlTable& root) { programme = read_programme(root); });
  if (!read) return tl::unexpected(read.error());
  return programme;
}

Result<Programme> load_programme(const std::string& name_or_file) {
  Words names;
  for (const ShippedProgramme& shipped : shipped_programmes()) {
    if (shipped.name == name_or_file) {
      return parse_programme(shipped.toml, fmt::format("programme {}", shipped.name));
    }
    names.emplace_back(shipped.name);
  }
  const bool looks_like_file = name_or_file.find_first_of("./") != std::string::npos;
  if (!looks_like_file && !std::filesystem::exists(name_or_file)) {
    return fail(Fault::config, "no programme is called `{}`; {}", name_or_file,
                suggestion(name_or_file, names));
  }
  constexpr std::size_t max_bytes = 1 << 20;
  const auto text = read_file(name_or_file, max_bytes);
  if (!text) return tl::unexpected(text.error());
  return parse_programme(*text, name_or_file);
}

}  // namespace tuina::massage
