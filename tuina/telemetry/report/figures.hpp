// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "tuina/telemetry/page.hpp"
#include "tuina/telemetry/report/report_data.hpp"

/// The drawings of the report page, each an `<svg>` element; empty when the data hold nothing to
/// draw.
namespace tuina::telemetry::figures {

/// The scanned back with acupoints, their uncertainty and every path: drawn once, and once more
/// with the key beneath it.
struct BackFigure {
  std::string plain, with_key;
};
/// Draws both.
[[nodiscard]] BackFigure back(const ReportData& data, const std::vector<KeyEntry>& key);

/// The scanned back, coloured by the stiffness map, plain where it is blank. The scale ends at the
/// hardest place, or at `scale_n_per_mm` where that is more, so that maps can be compared.
[[nodiscard]] std::string tissue(const ReportData& data, double scale_n_per_mm = 1e-9);

/// The last that was felt at each point.
[[nodiscard]] std::vector<FeltTissue> last_felt(const ReportData& data);
/// The end of the scale of stiffness, N/mm: a round number at or above everything felt.
[[nodiscard]] double hardest_shown(const ReportData& data, double at_least_n_per_mm = 1e-9);

/// The tangent law at each point up to the strongest press there, both sides of the back in one
/// small drawing: as estimated, and dashed as it is in truth.
[[nodiscard]] std::string tissue_curves(const ReportData& data);

/// Both arms over the session, a row each: paths by their colour, thin lines for ways through the
/// air.
[[nodiscard]] std::string timeline(const ReportData& data);

/// Target, true and measured force of one technique over its time in contact.
[[nodiscard]] std::string force(const ReportData& data, Technique technique);

/// Force and depth of the first press, close up.
[[nodiscard]] std::string first_press_force(const ReportData& data);
/// Likewise: its depth.
[[nodiscard]] std::string first_press_depth(const ReportData& data);

/// "Pressing" of "pressing".
[[nodiscard]] std::string capital(std::string text);

/// "BL47 left".
[[nodiscard]] std::string spoken(const std::string& acupoint, const Language& say = {});
/// "SI11 left to BL50 left", or of a named line "bladder inner left".
[[nodiscard]] std::string place_of(const ContactPath& path, const Language& say = {});
/// "stroke SI11 left to BL50 left".
[[nodiscard]] std::string said_path(const ContactPath& path, const Language& say = {});
/// The acupoint's Chinese name in Latin letters.
[[nodiscard]] std::string chinese_name(const std::string& acupoint);

}  // namespace tuina::telemetry::figures
