// SPDX-License-Identifier: Apache-2.0
#include "apps/evaluation/scanner/light.hpp"

#include <cmath>

#include "apps/evaluation/scanner/outcome_fields.hpp"
#include "apps/simulated/session_order.hpp"
#include "tuina/core/units.hpp"
#include "tuina/session/realism.hpp"

namespace tuina::app {
namespace {

using sim::Lamp;
using sim::LaserLight;

// A lamp so bright that the red scanner has little room left for its line, of 255 DN.
constexpr double lit_room_dn = 230.0;

struct Place {
  const char* name;
  Lamp lamp;
  double room_light_dn;
  double dark_share;  ///< of the skin
};
constexpr std::array places = {
    Place{"light skin", Lamp::led, 10.0, 0.1},
    Place{"medium skin", Lamp::led, 10.0, 0.4},
    Place{"dark skin", Lamp::led, 10.0, 0.7},
    Place{"medium skin, room lit by LEDs", Lamp::led, lit_room_dn, 0.4},
    Place{"medium skin, daylight", Lamp::daylight, lit_room_dn, 0.4},
    Place{"medium skin, incandescent lamps", Lamp::incandescent, lit_room_dn, 0.4}};
constexpr std::array lights = {LaserLight::red, LaserLight::infrared};

std::string name_of(LaserLight light) {
  return fmt::format("{:.0f} nm", sim::wavelength_nm(light));
}

ScanConditions conditions_of(const Place& place, LaserLight light) {
  session::Config config;
  config.simulation.realism = "usual";
  session::set_realism(config.simulation);
  sim::LaserScannerOptions red{.room_light_dn = place.room_light_dn, .flaws = scan_flaws(config)};
  red.flaws.dark_share = place.dark_share;
  red.flaws.flicker_share = red.flaws.readout_s = 0.0;
  return {.options = sim::lit_by(light, place.lamp, red)};
}

Result<RangeTrial> range_trial(const CalibrateLit& calibrate, LaserLight light) {
  const auto scanners = calibrate(sim::line_share(light));
  if (!scanners) return tl::unexpected(scanners.error());
  const auto rms = [&](double depth_m) {
    double squares = 0.0;
    for (const BuiltScanner& built : *scanners)
      squares += std::pow(sim::range_error_m(built.truth, built.believed, depth_m), 2);
    return std::sqrt(squares / static_cast<double>(scanners->size()));
  };
  return RangeTrial{.near_m = rms(0.65), .middle_m = rms(1.0), .far_m = rms(1.75)};
}

}  // namespace

Result<LightProof> prove_light(int people, const CalibrateLit& calibrate, Cells& cells,
                               std::uint64_t seed, const Progress& progress) {
  LightProof proof;
  const double all = static_cast<double>(lights.size() * places.size());
  for (const Place& place : places) {
    for (const LaserLight light : lights) {
      const auto back = cells.at<BackTrial>(
          fmt::format("light {} {}", place.name, name_of(light)), [&]() -> Result<BackTrial> {
            return back_trial(conditions_of(place, light), people, seed);
          });
      if (!back) return tl::unexpected(back.error());
      proof.rows.push_back({place.name, light, *back});
      if (progress) progress(static_cast<double>(proof.rows.size()) / all);
    }
  }
  for (const LaserLight light : lights) {
    if (!calibrate) break;
    const auto range = cells.at<RangeTrial>("calibration " + name_of(light),
                                            [&] { return range_trial(calibrate, light); });
    if (!range) return tl::unexpected(range.error());
    proof.calibrated.push_back({light, *range});
  }
  return proof;
}

telemetry::Table light_table(const LightProof& proof) {
  telemetry::Table table{.title = "A back at 1.1 m in red and in infrared light",
                         .columns = {{.head = "skin and room", .key = "name"},
                                     {.head = "light", .key = "light"},
                                     {.head = "RMS, mm", .key = "rms_mm", .digits = 2},
                                     {.head = "bias, mm", .key = "bias_mm", .digits = 2},
                                     {.head = "rows found, %", .key = "seen_percent", .digits = 1},
                                     {.head = "false, %", .key = "false_percent", .digits = 3},
                                     {.key = "refused"},
                                     {.head = " "}}};
  for (const auto& [name, light, back] : proof.rows) {
    if (back.refused) {
      table.add({name, name_of(light), {}, {}, {}, {}, true, "refused"});
      continue;
    }
    table.add({name,
               name_of(light),
               to_mm(back.rms_m),
               to_mm(back.bias_m),
               100.0 * back.seen_share,
               100.0 * back.outlier_share,
               {},
               {}});
  }
  return table;
}

telemetry::Table lit_calibration_table(const LightProof& proof) {
  telemetry::Table table{.title = "Calibrated in that light: systematic error of a range",
                         .columns = {{.head = "light", .key = "light"},
                                     {.head = "line, of red", .key = "line_share", .digits = 2},
                                     {.head = "at 0.65 m, mm", .key = "near_mm", .digits = 2},
                                     {.head = "at 1.0 m, mm", .key = "middle_mm", .digits = 2},
                                     {.head = "at 1.75 m, mm", .key = "far_mm", .digits = 2}}};
  for (const auto& [light, range] : proof.calibrated)
    table.add({name_of(light), sim::line_share(light), to_mm(range.near_m), to_mm(range.middle_m),
               to_mm(range.far_m)});
  return table;
}

}  // namespace tuina::app
