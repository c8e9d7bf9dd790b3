// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "tuina/telemetry/report/report_data.hpp"

namespace tuina::telemetry {

/// What one arm did, or both at once.
struct Moment {
  double begin_s = 0.0;
  double end_s = 0.0;
  std::vector<const PerformedPath*> paths;  ///< paths in the data, at most one of each arm
};

/// The session in the order of time. Paths of the two arms that ran together for most of the
/// shorter one are one moment.
[[nodiscard]] std::vector<Moment> moments_of(const ReportData& data);

inline constexpr std::size_t max_pictures = 12;

/// The session as rows of small pictures, from the first path to the last: the back, what has been
/// done, what is being done and the arms that do it. At most `max_pictures` of its moments, evenly
/// picked; empty when there is no scan or no path.
[[nodiscard]] std::string session_strip(const ReportData& data);

}  // namespace tuina::telemetry
