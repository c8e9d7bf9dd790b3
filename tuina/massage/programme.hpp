// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "tuina/core/contact.hpp"
#include "tuina/core/result.hpp"
#include "tuina/massage/back_chart.hpp"

namespace tuina::massage {

/// Sides of the body on which points without _L or _R are served.
enum class Side : std::uint8_t { both, left, right };
/// In which order the points of a part are served.
enum class Order : std::uint8_t { listed, downward, upward };

/// One technique at some points. What a technique does not use keeps its default.
struct Part {
  Technique technique = Technique::press;
  /// Acupoints, `BL47` for both sides or `BL47_L` for one. Stroking goes through them in their
  /// order; the other techniques serve one after the other.
  std::vector<std::string> points;
  std::string line;  ///< Named line of the back, which a stroke may have instead of points.
  /// Line of its own, which a stroke may have instead, for either side, from its beginning.
  std::vector<RelativePlace> places;
  Side side = Side::both;
  Order order = Order::listed;
  /// The sides take turns, one press, turn or stroke each: hand after hand.
  bool alternating = false;
  /// The sides stroke in turn, and one hand takes over before the other has left.
  bool hand_over_hand = false;
  bool together =
      true;  ///< Both arms work at once where they stay apart, else one after the other.
  double force_n = 20.0;
  std::optional<int> repeats;    ///< Number of presses, turns or strokes.
  std::optional<double> time_s;  ///< Time at each point, instead of repeats.
  double hold_s = 2.0;           ///< Time of a press at its full force.
  double rise_s = 0.9;           ///< Time in which a press gains its force.
  double radius_m = 0.030;       ///< Radius of a rub or a knead.
  bool spiral = false;           ///< A rub winds out to the radius and in again.
  double rate_hz = 0.35;         ///< Turns or taps a second.
  double speed_m_per_s = 0.060;  ///< Speed of a stroke.
};

/// A massage as the therapist orders it.
struct Programme {
  std::string name;
  std::string description;  ///< Two lines for people.
  int intensity = 3;        ///< 1 to 5; 3 leaves the forces as written.
  std::vector<Part> parts;
};

/// Factor of an intensity on every force of a programme.
[[nodiscard]] constexpr double force_scale_of(int intensity) {
  return 0.4 + 0.2 * intensity;
}

/// The lines of the back that stroking knows, see docs/massage.md.
struct NamedLine {
  const char* name;
  const char* meaning;
};
/// All lines that a stroke may name.
[[nodiscard]] std::span<const NamedLine> named_lines();

/// Reads a programme. Everything wrong is in the one message, a line each with file, line, key,
/// value and what would be right; near misses are suggested.
[[nodiscard]] Result<Programme> parse_programme(std::string_view text, std::string_view name);

/// A shipped programme by its name, or a programme file by its path.
[[nodiscard]] Result<Programme> load_programme(const std::string& name_or_file);

/// The programmes that are built in, from config/programmes.
struct ShippedProgramme {
  std::string_view name;
  std::string_view toml;
};
/// All programmes that are built in.
[[nodiscard]] std::span<const ShippedProgramme> shipped_programmes();

}  // namespace tuina::massage
