// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "tuina/core/result.hpp"
#include "tuina/massage/plan.hpp"
#include "tuina/motion/ready_plan.hpp"
#include "tuina/robot/obstacle.hpp"

namespace tuina::record {

/// A plan with what a robot makes of it, as plan.json holds it.
struct PlanFile {
  massage::Plan plan;
  bool reachable = false;           ///< every path of the programme by the arm that it is given to
  double min_arm_distance_m = 0.0;  ///< between the surfaces of the two arms
  robot::Clearances clear = {};  ///< distances of the arms from the couch and the robot's own body
  double rail_m = 0.0;           ///< place of the linear base
  double compute_ms = 0.0;
};

/// What plan.json says of a plan.
[[nodiscard]] PlanFile plan_file_of(const motion::ReadyPlan& ready, double compute_ms);

/// The JSON object of plan.json; places in `couch`, in metres.
[[nodiscard]] std::string to_json(const PlanFile& file);

/// @{
/// Reads plan.json. Fails with file, path of the field and value; `name` stands for the file.
[[nodiscard]] Result<PlanFile> read_plan(const std::filesystem::path& file);
[[nodiscard]] Result<PlanFile> parse_plan(std::string_view text, std::string_view name);
/// @}

}  // namespace tuina::record
