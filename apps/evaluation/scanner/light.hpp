// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "apps/evaluation/cells.hpp"
#include "apps/evaluation/scanner/trials.hpp"
#include "tuina/core/progress.hpp"
#include "tuina/sim/scanner/laser_light.hpp"
#include "tuina/telemetry/table.hpp"

namespace tuina::app {

/// Systematic error of a range that a scanner has after it was calibrated, RMS over its picture.
struct RangeTrial {
  double near_m = 0.0, middle_m = 0.0, far_m = 0.0;  ///< at 0.65, 1.0 and 1.75 m
};
template <typename Outcome, typename Visit>
requires std::is_same_v<std::remove_const_t<Outcome>, RangeTrial>
void visit_fields(Outcome& range, const Visit& visit) {
  visit("near_m", range.near_m);
  visit("middle_m", range.middle_m);
  visit("far_m", range.far_m);
}

/// What differs between a red and an infrared scanner.
struct LightProof {
  struct Row {
    std::string name;
    sim::LaserLight light = sim::LaserLight::red;
    BackTrial back;
  };
  struct Calibrated {
    sim::LaserLight light = sim::LaserLight::red;
    RangeTrial range;
  };
  std::vector<Row> rows = {};
  std::vector<Calibrated> calibrated = {};  ///< empty where the room `calibration` is not built
};

/// Calibrates scanners whose line on the board is so many times as bright as that of a red laser.
using CalibrateLit = std::function<Result<std::vector<BuiltScanner>>(double line_share)>;

/// Skin of three tones, and rooms lit by three kinds of lamps, each in both lights; all are cells.
[[nodiscard]] Result<LightProof> prove_light(int people, const CalibrateLit& calibrate,
                                             Cells& cells, std::uint64_t seed,
                                             const Progress& progress);

[[nodiscard]] telemetry::Table light_table(const LightProof& proof);
[[nodiscard]] telemetry::Table lit_calibration_table(const LightProof& proof);

}  // namespace tuina::app
