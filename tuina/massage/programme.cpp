// SPDX-License-Identifier: Apache-2.0
#include "tuina/massage/programme.hpp"

#include <fmt/ranges.h>

#include <toml++/toml.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <sstream>

#include "tuina/core/file.hpp"
#include "tuina/core/near_miss.hpp"
#include "tuina/core/units.hpp"
#include "tuina/massage/contact_path.hpp"
#include "tuina/massage/tap.hpp"
#include "tuina/massage/zones.hpp"

namespace tuina::massage {
namespace {

using Words = std::vector<std::string>;

const Words paired_points = {"SI11", "BL47", "BL50", "BL13", "BL15",
                             "BL17", "BL18", "BL20", "BL21", "BL23"};
const Words spine_points = {"GV2", "GV3", "GV4", "GV6", "GV9", "GV12", "GV14"};

constexpr std::array<NamedLine, 4> lines = {{
    {"bladder_inner", "1.5 cun beside the spine, from T3 to L4"},
    {"bladder_outer", "3 cun beside the spine, from T3 to L4"},
    {"scapula", "along the medial border of the shoulder blade, between it and the spine"},
    {"loin", "across the loin, from beside the spine outwards below the ribs"},
}};

const Words& keys_of(Technique technique) {
  static const std::array<Words, 4> keys = {{
      {"technique", "points", "side", "order", "together", "alternating", "force_n", "repeats",
       "time_s", "hold_s", "rise_s"},
      {"technique", "points", "side", "order", "together", "alternating", "force_n", "repeats",
       "time_s", "rate_hz", "radius_mm", "spiral"},
      {"technique", "points", "line", "places", "side", "together", "alternating", "hand_over_hand",
       "force_n", "repeats", "time_s", "speed_mm_per_s"},
      {"technique", "points", "side", "order", "together", "force_n", "time_s", "rate_hz"},
  }};
  return keys[static_cast<std::size_t>(technique)];
}

/// Reads the nodes of one file and collects what is wrong.
class Reader {
 public:
  explicit Reader(std::string_view file) : file_(file) {}
  [[nodiscard]] const Words& faults() const { return faults_; }

  void reject(const toml::node& node, std::string_view what) {
    faults_.push_back(fmt::format("{}:{}: {}", file_, node.source().begin.line, what));
  }
  void unknown_keys(const toml::table& table, const Words& known, std::string_view where) {
    for (const auto& [key, node] : table) {
      if (std::find(known.begin(), known.end(), key.str()) != known.end()) continue;
      reject(node,
             fmt::format("{} has no `{}`; {}", where, key.str(), suggestion(key.str(), known)));
    }
  }
  std::optional<double> number(const toml::table& table, std::string_view key, double low,
                               double high) {
    const toml::node* node = table.get(key);
    if (node == nullptr) return std::nullopt;
    const auto given = node->value<double>();
    // Written so that NaN is outside.
    if (node->is_number() && given && *given >= low && *given <= high) return given;
    reject(*node,
           fmt::format("{} = {} is not a number from {} to {}", key, shown(*node), low, high));
    return std::nullopt;
  }
  std::optional<int> whole(const toml::table& table, std::string_view key, int low, int high) {
    const toml::node* node = table.get(key);
    if (node == nullptr) return std::nullopt;
    if (const auto* given = node->as_integer();
        given && given->get() >= low && given->get() <= high) {
      return static_cast<int>(given->get());
    }
    reject(*node, fmt::format("{} = {} is not a whole number from {} to {}", key, shown(*node), low,
                              high));
    return std::nullopt;
  }
  std::optional<bool> flag(const toml::table& table, std::string_view key) {
    const toml::node* node = table.get(key);
    if (node == nullptr) return std::nullopt;
    if (node->is_boolean()) return node->as_boolean()->get();
    reject(*node, fmt::format("{} = {} is not true or false", key, shown(*node)));
    return std::nullopt;
  }
  std::optional<std::string> text(const toml::table& table, std::string_view key) {
    const toml::node* node = table.get(key);
    if (node == nullptr) return std::nullopt;
    if (node->is_string()) return node->as_string()->get();
    reject(*node, fmt::format("{} = {} is not a text in quotes", key, shown(*node)));
    return std::nullopt;
  }
  /// The index of the word given, among the words allowed.
  std::optional<std::size_t> word(const toml::table& table, std::string_view key,
                                  const Words& words) {
    const auto given = text(table, key);
    if (!given) return std::nullopt;
    const auto found = std::find(words.begin(), words.end(), *given);
    if (found != words.end()) return static_cast<std::size_t>(found - words.begin());
    reject(*table.get(key),
           fmt::format("{} = \"{}\" is unknown; {}", key, *given, suggestion(*given, words)));
    return std::nullopt;
  }

 private:
  [[nodiscard]] static std::string shown(const toml::node& node) {
    std::ostringstream text;
    if (node.is_value()) {
      node.visit([&](const auto& value) { text << value; });
    } else {
      text << (node.is_array() ? "[...]" : "{...}");
    }
    return text.str();
  }

  std::string_view file_;
  Words faults_;
};

void read_points(Reader& reader, const toml::table& table, Part& part) {
  const toml::node* node = table.get("points");
  if (node == nullptr) return;
  const toml::array* names = node->as_array();
  if (names == nullptr || names->empty()) {
    reader.reject(*node, "points is not a list of acupoints, like [\"BL47\", \"BL50_L\"]");
    return;
  }
  Words known = paired_points;
  for (const std::string& name : paired_points) {
    known.push_back(name + "_L");
    known.push_back(name + "_R");
  }
  known.insert(known.end(), spine_points.begin(), spine_points.end());
  for (const toml::node& entry : *names) {
    const std::string name = entry.value_or<std::string>("");
    if (std::find(known.begin(), known.end(), name) == known.end()) {
      reader.reject(entry,
                    fmt::format("the point `{}` is unknown; {}", name, suggestion(name, known)));
    } else if (name.starts_with("GV") && (name != "GV4" || part.technique != Technique::press)) {
      reader.reject(entry,
                    fmt::format("`{}` lies on the spine, where only GV4 may be touched, and only "
                                "be pressed (massage/zones.hpp)",
                                name));
    } else {
      part.points.push_back(name);
    }
  }
}

/// [[aside, up], ...]: cun beside the spine, and the share of the way from GV4 to C7.
void read_places(Reader& reader, const toml::table& table, Part& part) {
  const toml::node* node = table.get("places");
  if (node == nullptr) return;
  constexpr std::size_t most = 100;
  const toml::array* list = node->as_array();
  if (list == nullptr || list->size() < 2 || list->size() > most) {
    reader.reject(*node, fmt::format("places is not a list of 2 to {} places, like [[3.0, 0.8], "
                                     "[3.0, 0.1]]: cun beside the spine, share of the way from GV4 "
                                     "to C7",
                                     most));
    return;
  }
  for (const toml::node& entry : *list) {
    const toml::array* pair = entry.as_array();
    const bool two = pair != nullptr && pair->size() == 2;
    const auto aside = two ? (*pair)[0].value<double>() : std::nullopt;
    const auto up = two ? (*pair)[1].value<double>() : std::nullopt;
    // Written so that NaN is outside.
    if (aside && up && *aside >= 0.5 && *aside <= 8.0 && *up >= -0.5 && *up <= 1.2) {
      part.places.push_back({*aside, *up});
    } else {
      reader.reject(entry,
                    "a place is two numbers: 0.5 to 8 cun beside the spine, -0.5 to 1.2 of "
                    "the way from GV4 to C7");
    }
  }
}

bool names_one_side(const std::string& point) {
  return point.ends_with("_L") || point.ends_with("_R");
}

/// Taking turns, `alternating` or `hand_over_hand`, needs two sides and a number of turns.
void check_turns(Reader& reader, const toml::table& table, const Part& part, const char* key) {
  const toml::node& node = *table.get(key);
  if (part.side != Side::both) {
    reader.reject(node, fmt::format("{} needs both sides, side = \"both\"", key));
  } else if (std::any_of(part.points.begin(), part.points.end(), names_one_side)) {
    reader.reject(node, fmt::format("{} needs points of both sides, without _L or _R", key));
  }
  if (table.contains("together") && part.together == part.alternating) {
    reader.reject(node, fmt::format("{} and together = {} exclude each other", key, part.together));
  }
  if (table.contains("time_s")) {
    reader.reject(
        node, fmt::format("{} needs repeats, how often each side has its turn, not time_s", key));
  }
}

/// What single keys cannot say wrongly but several together can.
void check_part(Reader& reader, const toml::table& table, const Part& part) {
  if (table.contains("repeats") && table.contains("time_s")) {
    reader.reject(*table.get("time_s"), "repeats and time_s exclude each other");
  }
  const int ways = static_cast<int>(table.contains("points")) +
                   static_cast<int>(table.contains("line")) +
                   static_cast<int>(table.contains("places"));
  if (ways != 1) {
    reader.reject(table, part.technique == Technique::stroke
                             ? "stroke needs either points, a line or places"
                             : fmt::format("{} needs points", name_of(part.technique)));
  } else if (part.technique == Technique::stroke && part.points.size() == 1) {
    reader.reject(*table.get("points"), "a stroke needs two points at least");
  }
  if (part.alternating && part.hand_over_hand) {
    reader.reject(*table.get("hand_over_hand"),
                  "alternating and hand_over_hand exclude each other");
  } else if (part.alternating || part.hand_over_hand) {
    check_turns(reader, table, part, part.alternating ? "alternating" : "hand_over_hand");
  }
  const double speed = 2.0 * pi * part.radius_m * part.rate_hz;
  if (part.technique == Technique::rub && speed > fastest_slide_m_per_s) {
    const toml::node* node = table.contains("rate_hz") ? table.get("rate_hz") : &table;
    reader.reject(*node,
                  fmt::format("a circle of radius {:.0f} mm at {} turns per second slides with "
                              "{:.0f} mm/s, {:.0f} allowed",
                              to_mm(part.radius_m), part.rate_hz, to_mm(speed),
                              to_mm(fastest_slide_m_per_s)));
  }
  if (part.technique == Technique::tap && part.force_n > strongest_tap_n(part.rate_hz)) {
    const toml::node* node = table.contains("force_n") ? table.get("force_n") : &table;
    reader.reject(*node,
                  fmt::format("{} taps per second with {} N change the force faster than {:.0f} "
                              "N/s; at this rate {:.1f} N are allowed",
                              part.rate_hz, part.force_n, fastest_force_n_per_s,
                              strongest_tap_n(part.rate_hz)));
  }
}

std::optional<Part> read_part(Reader& reader, const toml::table& table) {
  if (!table.contains("technique")) {
    reader.reject(table, "a part needs a technique: press, rub, stroke, tap");
    return std::nullopt;
  }
  const auto technique = reader.word(table, "technique", {"press", "rub", "stroke", "tap"});
  if (!technique) return std::nullopt;
  Part part;
  part.technique = static_cast<Technique>(*technique);
  // A default each that suits the technique; pressing is the strongest.
  constexpr std::array<double, 4> usual_force_n = {22.0, 15.0, 12.0, 10.0};
  part.force_n = usual_force_n[*technique];
  if (part.technique == Technique::tap) part.rate_hz = 3.0;
  reader.unknown_keys(table, keys_of(part.technique), name_of(part.technique));
  read_points(reader, table, part);
  read_places(reader, table, part);
  Words line_names;
  for (const NamedLine& line : lines) line_names.emplace_back(line.name);
  if (const auto line = reader.word(table, "line", line_names)) part.line = line_names[*line];
  if (const auto side = reader.word(table, "side", {"both", "left", "right"})) {
    part.side = static_cast<Side>(*side);
  }
  if (const auto order = reader.word(table, "order", {"listed", "downward", "upward"})) {
    part.order = static_cast<Order>(*order);
  }
  part.together = reader.flag(table, "together").value_or(part.together);
  part.alternating = reader.flag(table, "alternating").value_or(part.alternating);
  part.hand_over_hand = reader.flag(table, "hand_over_hand").value_or(part.hand_over_hand);
  const double ceiling_n = rule_of(Zone::muscle).cap_n;
  part.force_n = reader.number(table, "force_n", kept_force_n, ceiling_n).value_or(part.force_n);
  part.repeats = reader.whole(table, "repeats", 1, 20);
  part.time_s = reader.number(table, "time_s", 1.0, 60.0);
  part.hold_s = reader.number(table, "hold_s", 0.2, 10.0).value_or(part.hold_s);
  part.rise_s = reader.number(table, "rise_s", 0.3, 5.0).value_or(part.rise_s);
  part.radius_m =
      from_mm(reader.number(table, "radius_mm", 10.0, 50.0).value_or(to_mm(part.radius_m)));
  part.spiral = reader.flag(table, "spiral").value_or(part.spiral);
  part.speed_m_per_s =
      from_mm(reader.number(table, "speed_mm_per_s", 10.0, to_mm(fastest_slide_m_per_s))
                  .value_or(to_mm(part.speed_m_per_s)));
  const bool taps = part.technique == Technique::tap;
  part.rate_hz =
      reader.number(table, "rate_hz", taps ? slowest_tap_hz : 0.1, taps ? fastest_tap_hz : 1.0)
          .value_or(part.rate_hz);
  check_part(reader, table, part);
  return part;
}

Programme read_programme(Reader& reader, const toml::table& table) {
  Programme programme;
  reader.unknown_keys(table, {"name", "description", "intensity", "part"}, "a programme");
  programme.name = reader.text(table, "name").value_or("");
  programme.description = reader.text(table, "description").value_or("");
  programme.intensity = reader.whole(table, "intensity", 1, 5).value_or(programme.intensity);
  if (!table.contains("name")) reader.reject(table, "a programme needs a name");
  const toml::node* parts = table.get("part");
  if (parts == nullptr || !parts->is_array_of_tables()) {
    reader.reject(parts == nullptr ? table : *parts, "a programme needs at least one [[part]]");
    return programme;
  }
  constexpr std::size_t most_parts = 100;
  if (parts->as_array()->size() > most_parts) {
    reader.reject(*parts,
                  fmt::format("{} parts, {} allowed", parts->as_array()->size(), most_parts));
    return programme;
  }
  for (const toml::node& part : *parts->as_array()) {
    if (auto read = read_part(reader, *part.as_table()))
      programme.parts.push_back(std::move(*read));
  }
  return programme;
}

}  // namespace

std::span<const NamedLine> named_lines() {
  return lines;
}

Result<Programme> parse_programme(std::string_view text, std::string_view name) {
  try {
    const toml::table table = toml::parse(text, std::string(name));
    Reader reader(name);
    Programme programme = read_programme(reader, table);
    if (!reader.faults().empty())
      return fail(Fault::config, "{}", fmt::join(reader.faults(), "\n"));
    return programme;
  } catch (const toml::parse_error& error) {
    return fail(Fault::config, "{}:{}: {}", name, error.source().begin.line, error.description());
  }
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
  constexpr std::size_t largest_bytes = 1 << 20;
  const auto text = read_file(name_or_file, largest_bytes);
  if (!text) return tl::unexpected(text.error());
  return parse_programme(*text, name_or_file);
}

}  // namespace tuina::massage
