// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "tuina/core/acupoint.hpp"
#include "tuina/core/arm.hpp"
#include "tuina/core/result.hpp"
#include "tuina/massage/back_chart.hpp"
#include "tuina/robot/arm_table.hpp"
#include "tuina/safety/limits.hpp"

namespace tuina::session {

/// One moment as the hand has shown it.
struct TaughtSample {
  double time_s = 0.0;
  JointVector q_rad;
  double force_n = 0.0;  ///< force that the tool felt, out of the skin
};

/// A motion of one arm that a hand has shown it, [thesis] 3.5.3: a sequence in joint space, with
/// the force that was felt.
struct TaughtMotion {
  std::string name;
  BodyPosture position = BodyPosture::sitting;
  std::string robot = "thesis";  ///< whose arm: a shipped robot or the file of its table
  Arm arm = Arm::left;
  double rail_m = 0.0;
  safety::Zone zone = safety::Zone::muscle;  ///< most delicate zone that it touches
  std::vector<TaughtSample> samples;         ///< evenly spaced, from zero
  std::vector<massage::RelativePlace> line;  ///< line of a stroke, on the back it was taught on
  double force_n = 0.0;                      ///< usual force along that line
  double speed_m_per_s = 0.0;                ///< usual speed along that line

  [[nodiscard]] double duration_s() const { return samples.empty() ? 0.0 : samples.back().time_s; }

  /// What the arm does at one time of the motion.
  struct Moment {
    JointVector q_rad;
    JointVector dq_rad_per_s;
    double force_n = 0.0;
  };
  /// Between the samples by cubic Hermite interpolation; at rest before the first and after the
  /// last. Allocates nothing.
  [[nodiscard]] Moment at(double time_s) const noexcept;
};

/// Without the tremor of the hand: a Gaussian of this standard deviation in time, which shifts
/// nothing, and a sample every `step_s`.
[[nodiscard]] TaughtMotion smoothed(const TaughtMotion& motion, double sd_s = 0.05,
                                    double step_s = 0.01);

/// FILE.toml, and the samples as FILE.csv beside it: time_s, q1_deg ..., force_n.
[[nodiscard]] Result<void> write_taught(const TaughtMotion& motion,
                                        const std::filesystem::path& file);
/// A programme that strokes along the taught line, on anybody and on both sides: TOML. Fails,
/// with the value, when it is no line that a stroke could follow or programmes do not take it.
[[nodiscard]] Result<std::string> programme_of(const TaughtMotion& motion);

/// Refused by file and line: robots that are not there, keys and columns that are missing or
/// unknown, times that are not even, joints beyond their ends or faster than 1.5 rad/s, forces
/// below zero or beyond the trip of the zone.
[[nodiscard]] Result<TaughtMotion> read_taught(const std::filesystem::path& file);

}  // namespace tuina::session
