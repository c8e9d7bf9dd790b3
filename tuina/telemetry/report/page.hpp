// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "tuina/telemetry/report/report_data.hpp"

namespace tuina::telemetry {

/// The report of one session as one self-contained HTML page: no network, no script, below 3 MB,
/// for screens and for paper. Whatever the data lack is said on the page instead of shown. Where
/// `back_svg` is not null it is given `back_picture`, which is not drawn once more for it.
[[nodiscard]] std::string report_page(const ReportData& data, std::string* back_svg = nullptr);

/// The picture of the page that shows the back with its acupoints and paths, as one SVG file.
[[nodiscard]] std::string back_picture(const ReportData& data);

}  // namespace tuina::telemetry
