// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "tuina/core/colour.hpp"

namespace tuina {

/// What a tool does on the skin.
enum class Technique : std::uint8_t { press, rub, stroke, tap, knead };

/// Everything that is said of a technique in more than one room. A new technique is an enumerator
/// and a row here, a row of `massage/technique_law.cpp`, and its law, a file of
/// `massage/technique`.
struct TechniqueRow {
  Technique technique;
  const char* name;      ///< "rub": in programmes, in files and on the command line.
  const char* doing;     ///< "rubbing", for people.
  const char* did;       ///< "rubbed in circles around", before a number of points, for people.
  bool slides = false;   ///< The tool moves along the skin.
  bool strikes = false;  ///< The force beats, which only a zone that allows tapping bears.
  double usual_force_n;  ///< Force where a programme names none.
  double overshoot_n;    ///< Newtons kept below the cap of a zone for the error of control.
  Colour colour;         ///< Colour in every picture and plot.
};

// Pressing is the strongest. By how much the true force comes to be over the largest one asked for,
// each contact of a session tells (`true_peak_n` against `ordered_n` of session.json).
inline constexpr std::array technique_table = {
    TechniqueRow{.technique = Technique::press,
                 .name = "press",
                 .doing = "pressing",
                 .did = "pressed",
                 .usual_force_n = 22.0,
                 .overshoot_n = 2.0,
                 .colour = {200, 52, 44}},
    TechniqueRow{.technique = Technique::rub,
                 .name = "rub",
                 .doing = "rubbing",
                 .did = "rubbed in circles around",
                 .slides = true,
                 .usual_force_n = 15.0,
                 .overshoot_n = 3.0,
                 .colour = {24, 104, 178}},
    TechniqueRow{.technique = Technique::stroke,
                 .name = "stroke",
                 .doing = "stroking",
                 .did = "stroked along",
                 .slides = true,
                 .usual_force_n = 12.0,
                 .overshoot_n = 3.0,
                 .colour = {16, 132, 106}},
    TechniqueRow{.technique = Technique::tap,
                 .name = "tap",
                 .doing = "tapping",
                 .did = "tapped",
                 .strikes = true,
                 .usual_force_n = 10.0,
                 .overshoot_n = 2.0,
                 .colour = {122, 72, 160}},
    TechniqueRow{.technique = Technique::knead,
                 .name = "knead",
                 .doing = "kneading",
                 .did = "kneaded",
                 .slides = true,
                 .usual_force_n = 18.0,
                 .overshoot_n = 3.0,
                 .colour = {0, 158, 196}},
};

inline constexpr auto all_techniques = [] {
  std::array<Technique, technique_table.size()> all{};
  for (std::size_t i = 0; i < all.size(); ++i) all[i] = technique_table[i].technique;
  return all;
}();
static_assert(
    [] {
      for (std::size_t i = 0; i < all_techniques.size(); ++i) {
        if (static_cast<std::size_t>(all_techniques[i]) != i) return false;
      }
      return static_cast<std::size_t>(Technique::knead) + 1 == all_techniques.size();
    }(),
    "each technique has its row, in the order of the enumerators");

/// Row of the table of techniques.
[[nodiscard]] constexpr const TechniqueRow& row_of(Technique technique) {
  return technique_table[static_cast<std::size_t>(technique)];
}
/// "press", "rub", "stroke", "tap" or "knead".
[[nodiscard]] constexpr const char* name_of(Technique technique) {
  return row_of(technique).name;
}
/// Whether the tool moves along the skin while it presses.
[[nodiscard]] constexpr bool slides(Technique technique) {
  return row_of(technique).slides;
}

/// The technique of a name; nothing where no technique is called so.
[[nodiscard]] constexpr std::optional<Technique> parse_technique(std::string_view name) {
  for (const TechniqueRow& row : technique_table) {
    if (name == row.name) return row.technique;
  }
  return std::nullopt;
}

/// Names of all techniques, in their order.
[[nodiscard]] inline std::vector<std::string> technique_names() {
  std::vector<std::string> names;
  names.reserve(technique_table.size());
  for (const TechniqueRow& row : technique_table) names.emplace_back(row.name);
  return names;
}

}  // namespace tuina
