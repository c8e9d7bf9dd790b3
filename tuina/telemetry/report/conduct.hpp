// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "tuina/telemetry/page.hpp"
#include "tuina/telemetry/report/report_data.hpp"

namespace tuina::telemetry {

/// The colours of the techniques that were used; with `moving` also what a timeline shows of an arm
/// that touches nobody.
[[nodiscard]] std::vector<KeyEntry> technique_key(const ReportData& data, bool moving = false);

/// The section about the order of the session: pictures, timelines of both arms, and how far they
/// stayed from each other and from the person.
void add_conduct(Page& page, const ReportData& data);

/// How many places got what was ordered; empty when the record does not say what was.
[[nodiscard]] std::string given_in_words(const ReportData& data);

/// The section about what was ordered at each place, what was given, and why they differ.
void add_given(Page& page, const ReportData& data);

/// The section about what the tissue decided, line by line with its reason; none when it decided
/// nothing.
void add_decisions(Page& page, const ReportData& data);

}  // namespace tuina::telemetry
