// SPDX-License-Identifier: Apache-2.0
#include "tuina/scanner/line/colours.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <type_traits>

#include "tuina/scanner/line/line_rows.hpp"

namespace tuina::scanner {
namespace {

constexpr double darkest = 0.12, brightest = 0.98;  // shares of the range that tell a ratio

template <typename Sample>
BasicImage<Sample> channel(const BasicImage<Sample>& colours, std::size_t which) {
  if (colours.channels == 1) return colours;
  BasicImage<Sample> one(colours.width, colours.height);
  const auto take = [&](auto channels) {
    for (std::size_t i = 0; i < one.data.size(); ++i)
      one.data[i] = colours.data[i * channels + which];
  };
  // Compilers make vectors only of steps that they know.
  if (colours.channels == 3) {
    take(std::integral_constant<std::size_t, 3>());
  } else {
    take(static_cast<std::size_t>(colours.channels));
  }
  return one;
}

struct Scene {
  float red_to_green = 1.0F;  // the median over the picture, of which a laser line lights little
  bool lit = false;           // enough of it is seen for colours to tell something
};

template <typename Sample>
Scene scene_in(const BasicImage<Sample>& colours, double saturated_dn) {
  constexpr std::size_t sampled = 20000;
  constexpr double lit_share = 0.05;
  const auto channels = static_cast<std::size_t>(colours.channels);
  // A step that has no divisor in common with the width meets all columns.
  std::size_t step = colours.data.size() / channels / sampled + 1;
  while (std::gcd(step, static_cast<std::size_t>(colours.width)) != 1) ++step;
  const double least = darkest * saturated_dn, most = brightest * saturated_dn;
  std::vector<float> ratios;
  for (std::size_t i = 0; i < colours.data.size(); i += step * channels) {
    const double red = colours.data[i], green = colours.data[i + 1];
    if (std::min(red, green) > least && std::max(red, green) < most)
      ratios.push_back(static_cast<float>(red / green));
  }
  if (ratios.empty()) return {};
  const auto middle = ratios.begin() + static_cast<std::ptrdiff_t>(ratios.size() / 2);
  std::nth_element(ratios.begin(), middle, ratios.end());
  const double all =
      static_cast<double>(colours.data.size()) / static_cast<double>(step * channels);
  return {.red_to_green = *middle, .lit = static_cast<double>(ratios.size()) > lit_share * all};
}

template <typename Sample>
BasicImage<Sample> without_laser(const BasicImage<Sample>& colours, float ratio,
                                 double saturated_dn) {
  const auto most = static_cast<float>(saturated_dn);
  BasicImage<Sample> red = channel(colours, 1);
  for (Sample& value : red.data)
    value = static_cast<Sample>(std::min(ratio * static_cast<float>(value) + 0.5F, most));
  return red;
}

/// False when the light of a line is as white as red, in the median over its rows: green rises
/// there with red. Rows in which a colour is clipped tell nothing.
template <typename Sample>
bool is_red(const BasicImage<Sample>& colours, const LaserLine& line, double saturated_dn) {
  constexpr double max_green_share = 0.6;
  constexpr std::size_t min_rows = 10;
  const auto channels = static_cast<std::size_t>(colours.channels);
  const int beside = static_cast<int>(std::ceil(4.0F * line.width_px)) + 1;
  std::vector<double> shares;
  for (const LinePoint& point : line.points) {
    const int at = static_cast<int>(std::lround(point.column_px));
    if (at - beside < 0 || at + beside >= colours.width) continue;
    const auto value = [&](int column, std::size_t channel) {
      return static_cast<double>(
          colours.row(point.row)[static_cast<std::size_t>(column) * channels + channel]);
    };
    if (std::max(value(at, 0), value(at, 1)) >= saturated_dn) continue;
    const auto rise = [&](std::size_t channel) {
      return value(at, channel) - 0.5 * (value(at - beside, channel) + value(at + beside, channel));
    };
    if (rise(0) > 0.0) shares.push_back(rise(1) / rise(0));
  }
  if (shares.size() < min_rows) return true;
  const auto middle = shares.begin() + static_cast<std::ptrdiff_t>(shares.size() / 2);
  std::nth_element(shares.begin(), middle, shares.end());
  return *middle < max_green_share;
}

template <typename Sample>
LaserLine find(const BasicImage<Sample>& colours, const LineOptions& options) {
  const double saturated_dn =
      options.saturated_dn > 0.0 ? options.saturated_dn : std::numeric_limits<Sample>::max();
  const Scene scene = scene_in(colours, saturated_dn);
  const auto seen = [&](LaserLine line) {
    if (!is_red(colours, line, saturated_dn)) line.points.clear();
    return line;
  };
  const auto beyond_scene = [&] {
    return seen(find_laser_line(LineRows<Sample>(colours, scene.red_to_green, options.saturated_dn),
                                options));
  };
  const auto in_red_alone = [&] {
    return seen(find_laser_line(BasicImageView<Sample>(channel(colours, 0)), options));
  };
  const auto clear_rows = [](const LaserLine& line) {
    return static_cast<int>(line.points.size()) - line.ambiguous_rows;
  };
  // First what is likelier to be clear, which mostly spares the other.
  LaserLine first = scene.lit ? beyond_scene() : in_red_alone();
  if (clear_rows(first) == colours.height) return first;
  // In a lit scene red alone would take anything bright for a line. It is asked only where the
  // middle of a line is clipped in all colours: its flanks are red then.
  const auto flanks = static_cast<int>(first.points.size()) + first.ambiguous_rows;
  if (scene.lit && 2 * flanks < colours.height) return first;
  LaserLine second = scene.lit ? in_red_alone() : beyond_scene();
  return clear_rows(second) > clear_rows(first) ? second : first;
}

}  // namespace

Image red_of(const Image& colours) {
  return channel(colours, 0);
}
Image16 red_of(const Image16& colours) {
  return channel(colours, 0);
}

Image green_of(const Image& colours) {
  return channel(colours, 1);
}

Image red_without_laser(const Image& colours) {
  constexpr double saturated_dn = std::numeric_limits<std::uint8_t>::max();
  return without_laser(colours, scene_in(colours, saturated_dn).red_to_green, saturated_dn);
}

LaserLine find_red_line(const Image& colours, const LineOptions& options) {
  return find(colours, options);
}
LaserLine find_red_line(const Image16& colours, const LineOptions& options) {
  return find(colours, options);
}

}  // namespace tuina::scanner
