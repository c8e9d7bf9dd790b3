// SPDX-License-Identifier: Apache-2.0
#include "tuina/telemetry/plot/svg_parts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>

#include "tuina/telemetry/plot/colours.hpp"

namespace tuina::telemetry {

std::string escaped(std::string_view text) {
  std::string safe;
  for (const char letter : text) {
    switch (letter) {
      case '&':
        safe += "&amp;";
        break;
      case '<':
        safe += "&lt;";
        break;
      case '>':
        safe += "&gt;";
        break;
      case '"':
        safe += "&quot;";
        break;
      case '\'':
        safe += "&#39;";
        break;
      default:
        // XML knows no control letters but these three, not even written as a number.
        if (static_cast<unsigned char>(letter) >= 0x20 || letter == '\n' || letter == '\t' ||
            letter == '\r')
          safe += letter;
    }
  }
  return safe;
}

std::string open_svg(int width, int height, std::string_view title) {
  constexpr const char* font =
      "font-family=\"Inter,system-ui,-apple-system,'Segoe UI',Helvetica,Arial,sans-serif\"";
  return fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0} {1}\" width=\"{0}\" "
      "height=\"{1}\" role=\"img\" "
      "aria-label=\"{2}\" {3} font-size=\"11.5\" fill=\"{4}\"><title>{2}</title>",
      width, height, escaped(title), font, css(palette::ink));
}

std::vector<double> ticks(double low, double high, int wanted) {
  assert(high > low && wanted > 0);
  const double rough = (high - low) / wanted;
  const double decade = std::pow(10.0, std::floor(std::log10(rough)));
  double step = 10.0 * decade;
  for (const double nice : {1.0, 2.0, 5.0}) {
    if (nice * decade >= rough * 0.999) {
      step = nice * decade;
      break;
    }
  }
  std::vector<double> at;
  for (double k = std::ceil(low / step - 1e-9); k * step <= high + 1e-9 * step; ++k)
    at.push_back(k * step);
  return at;
}

std::vector<double> whole_ticks(double low, double high, int wanted) {
  return ticks(low, high, std::clamp(static_cast<int>(high - low), 1, wanted));
}

std::string tick_text(double value, const std::vector<double>& at) {
  const double step = at.size() > 1 ? at[1] - at[0] : 1.0;
  const int decimals = std::clamp(static_cast<int>(std::ceil(-std::log10(step) - 1e-9)), 0, 6);
  // A tick that is zero but for rounding must not read "-0".
  return fmt::format("{:.{}f}", std::abs(value) < 1e-9 * step ? 0.0 : value, decimals);
}

}  // namespace tuina::telemetry
