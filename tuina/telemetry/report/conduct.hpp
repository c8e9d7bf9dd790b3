// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "tuina/telemetry/report/report_data.hpp"

namespace tuina::telemetry {

/// The colours of the techniques that were used; with `moving` also what a timeline shows of an arm
/// that touches nobody.
[[nodiscard]] std::string technique_key(const ReportData& data, bool moving = false);

/// The section about the order of the session: pictures, timelines of both arms, and how far they
/// stayed from each other and from the person.
[[nodiscard]] std::string conduct_section(const ReportData& data);

/// The section about what the tissue decided, line by line with its reason; empty when it decided
/// nothing.
[[nodiscard]] std::string decisions_section(const ReportData& data);

}  // namespace tuina::telemetry
