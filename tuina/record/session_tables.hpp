// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "tuina/core/result.hpp"
#include "tuina/telemetry/report/report_data.hpp"

/// The tables in the folder of a session, written and read.
namespace tuina::record {

/// Every joint at one moment.
struct JointRow {
  double time_s = 0.0;
  double rail_m = 0.0;
  PerArm<JointVector> q_rad;
  PerArm<JointVector> torque_nm;  ///< torques that the motors were told
};

/// @{
/// The table as CSV, with a head that names units and frames.
[[nodiscard]] std::string csv_of(const std::vector<telemetry::TraceRow>& trace);
[[nodiscard]] std::string csv_of(const std::vector<JointRow>& joints);
[[nodiscard]] std::string csv_of(const std::vector<telemetry::ArmDistance>& distances);
/// @}

/// Refused, with file and line: what is not as it was written.
[[nodiscard]] Result<std::vector<telemetry::TraceRow>> read_trace(
    const std::filesystem::path& file);
/// @{
/// Likewise.
[[nodiscard]] Result<std::vector<JointRow>> read_joints(const std::filesystem::path& file);
[[nodiscard]] Result<std::vector<telemetry::ArmDistance>> read_distances(
    const std::filesystem::path& file);
/// @}

}  // namespace tuina::record
