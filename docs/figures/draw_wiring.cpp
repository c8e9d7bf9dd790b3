// SPDX-License-Identifier: Apache-2.0
// Draws how the parts of the scanner are wired. Usage: draw_wiring OUT.svg
#include <fmt/format.h>

#include <cstdio>

#include "tuina/core/geometry.hpp"
#include "tuina/core/io/file.hpp"
#include "tuina/telemetry/plot/svg_plot.hpp"

using namespace tuina;

namespace {

constexpr int width_px = 760, height_px = 470;

std::string word(double x, double y, const std::string& text, const char* style = "") {
  return fmt::format("<text x=\"{:.0f}\" y=\"{:.0f}\" {}>{}</text>", x, y, style,
                     telemetry::escaped(text));
}

constexpr const char* middle = "text-anchor=\"middle\"";
constexpr const char* right = "text-anchor=\"end\"";

std::string box(double x, double y, double width, double height, const std::string& name) {
  return fmt::format(
             "<rect x=\"{:.0f}\" y=\"{:.0f}\" width=\"{:.0f}\" height=\"{:.0f}\" rx=\"5\" "
             "fill=\"#eef2f6\" stroke=\"#1f232a\"/>",
             x, y, width, height) +
         word(x + 0.5 * width, y + 20.0, name, "text-anchor=\"middle\" font-weight=\"600\"");
}

/// A wire by the steps of an SVG path.
std::string wire(const char* path, const char* colour = "#1f232a") {
  return fmt::format("<path d=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"1.8\"/>", path,
                     colour);
}

std::string joint(double x, double y) {
  return fmt::format("<circle cx=\"{:.0f}\" cy=\"{:.0f}\" r=\"3.2\"/>", x, y);
}

/// A resistor that stands upright, 36 px high, or lies.
std::string resistor(double x, double y, bool lies, const std::string& ohms) {
  return fmt::format(
             "<rect x=\"{:.0f}\" y=\"{:.0f}\" width=\"{}\" height=\"{}\" fill=\"#fff\" "
             "stroke=\"#1f232a\" stroke-width=\"1.6\"/>",
             lies ? x : x - 6.0, lies ? y - 6.0 : y, lies ? 36 : 12, lies ? 12 : 36) +
         (lies ? word(x + 18.0, y - 11.0, ohms, middle) : word(x + 12.0, y + 22.0, ohms));
}

std::string ground(double x, double y) {
  return fmt::format(
      "<path d=\"M{0:.0f} {1:.0f}v8m-11 0h22m-18 5h14m-10 5h6\" fill=\"none\" stroke=\"#1f232a\" "
      "stroke-width=\"1.8\"/>",
      x, y);
}

constexpr const char* red = "#d8232f";
constexpr const char* blue = "#2258c8";

/// The motor's one wire: sent to through a diode, pulled up, heard.
std::string motor_line() {
  std::string svg = box(560, 60, 160, 120, "AX-12A");
  svg += word(570, 105, "data") + word(570, 135, "12 V") + word(570, 165, "ground");
  svg += wire("M220 75H300", blue) + wire("M330 75H420V100H560", blue);
  // A Schottky diode whose cathode is at TX1: it can only pull the wire down.
  svg += fmt::format(
      "<path d=\"M330 66v18l-28 -9z\" fill=\"{0}\"/><path d=\"M302 64v22\" stroke=\"{0}\" "
      "stroke-width=\"2.4\"/>",
      blue);
  svg += word(316, 58, "Schottky", middle);
  svg += wire("M220 125H420V100", blue) + joint(420, 100);
  svg += wire("M470 100V82M470 46V30H440") + joint(470, 100) + resistor(470, 46, false, "1 kΩ");
  svg += word(434, 34, "5 V of the Mega", right);
  svg += wire("M560 130H540V212H600", red) + wire("M560 160H528V236H600") + ground(528, 236);
  svg += box(600, 194, 120, 56, "") + word(660, 219, "12 V supply", middle) +
         word(660, 237, "2 A", middle);
  return svg;
}

/// The switch below the laser.
std::string laser_switch() {
  std::string svg = wire("M220 300H262M298 300H380");
  svg += resistor(262, 300, true, "220 Ω");
  svg += wire("M345 300V322M345 358V392") + joint(345, 300) + resistor(345, 322, false, "10 kΩ") +
         ground(345, 392);
  // An N-channel transistor: gate, channel, drain above, source below.
  svg += wire("M380 282V318M390 278V322M390 284H430V262M390 316H430V392") + ground(430, 392);
  svg += word(492, 290, "N-channel transistor,") + word(492, 306, "logic level, such as IRLZ44N");
  svg += box(500, 370, 220, 70, "line laser, class 2");
  svg += wire("M430 262V254H480V420H500") + wire("M500 396H490V352", red);
  svg += word(540, 346, "5 V of the Mega", middle) + word(510, 400, "+", "fill=\"#d8232f\"") +
         word(510, 425, "-");
  return svg;
}

}  // namespace

int main(int count, char** arguments) {
  if (count != 2) return 1;
  std::string svg = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0} {1}\" width=\"{0}\" "
      "height=\"{1}\" role=\"img\" aria-label=\"how the scanner is wired\" "
      "font-family=\"Inter,system-ui,-apple-system,'Segoe UI',Helvetica,Arial,sans-serif\" "
      "font-size=\"13\" fill=\"#1f232a\"><title>How the scanner is wired</title>"
      "<rect width=\"{0}\" height=\"{1}\" fill=\"#fff\"/>",
      width_px, height_px);
  svg += box(60, 30, 160, 410, "Arduino Mega 2560");
  svg += word(210, 80, "TX1 (18)", right) + word(210, 130, "RX1 (19)", right) +
         word(210, 305, "pin 8", right) + word(210, 386, "ground", right) +
         word(140, 428, "USB to this machine", middle);
  svg += motor_line() + laser_switch();
  svg += wire("M220 381H262V392") + ground(262, 392);
  svg += word(380, 462, "all grounds are one", "text-anchor=\"middle\" fill=\"#707680\"");
  svg += "</svg>\n";
  const auto written = write_file(arguments[1], svg);
  if (!written) std::fprintf(stderr, "%s\n", written.error().message.c_str());
  return written ? 0 : 1;
}
