// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "tuina/telemetry/report/report_data.hpp"

namespace tuina::telemetry {

/// How far acupoints were found from their true places.
struct MeanError {
  double mean_m = 0.0;
  std::size_t points = 0;
};

/// Over the seven points of the thesis, as session.json counts it; over all if none of those is
/// there; nothing where no truth is known.
[[nodiscard]] std::optional<MeanError> mean_error(const ReportData& data);

/// The largest true force of the session; the largest measured one where the truth is not known.
[[nodiscard]] double peak_force_n(const ReportData& data);

/// What happened, for somebody who treats people and has no use for a plot.
[[nodiscard]] std::string summary(const ReportData& data);

}  // namespace tuina::telemetry
