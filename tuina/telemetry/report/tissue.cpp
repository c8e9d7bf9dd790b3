// SPDX-License-Identifier: Apache-2.0
#include "tuina/telemetry/report/tissue.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "tuina/telemetry/plot/svg_plot.hpp"
#include "tuina/telemetry/report/figures.hpp"

namespace tuina::telemetry {
namespace {

bool has_truth(const ReportData& data) {
  return std::any_of(data.tissue.begin(), data.tissue.end(),
                     [](const FeltTissue& f) { return f.truth.has_value(); });
}

std::string tissue_table(const ReportData& data) {
  const bool truth = has_truth(data);
  const bool classes = std::any_of(data.tissue.begin(), data.tissue.end(),
                                   [](const FeltTissue& f) { return !f.tissue_class.empty(); });
  std::string html = "<div class=wide><table><thead><tr><th>Point<th>&alpha;, N";
  if (truth) html += "<th class=sim>true &alpha;<br>(simulation only)";
  html += "<th>&beta;, 1/mm";
  if (truth) html += "<th class=sim>true &beta;<br>(simulation only)";
  html += fmt::format("<th>at {:.0f} N,<br>N/mm<th>presses<th>settled<br>after, s",
                      data.stiffness_force_n);
  if (classes) html += "<th class=l>felt like";
  html += "</thead><tbody>";
  for (const FeltTissue& felt : data.tissue) {
    const TissueEstimate& e = felt.estimate;
    html += fmt::format("<tr><td>{}<td>{:.1f}<em>± {:.1f}</em>",
                        escaped(figures::spoken(felt.name)), e.tissue.alpha_n, e.alpha_ci95_n);
    if (truth)
      html +=
          felt.truth ? fmt::format("<td class=sim>{:.1f}", felt.truth->alpha_n) : "<td class=sim>";
    html += fmt::format("<td>{:.3f}<em>± {:.3f}</em>", e.tissue.beta_per_m * 1e-3,
                        e.beta_ci95_per_m * 1e-3);
    if (truth)
      html += felt.truth ? fmt::format("<td class=sim>{:.3f}", felt.truth->beta_per_m * 1e-3)
                         : "<td class=sim>";
    html += fmt::format("<td>{:.1f}<em>± {:.1f}</em><td>{}", felt.stiffness_n_per_mm,
                        felt.stiffness_ci95_n_per_mm, e.presses);
    html += e.converged ? fmt::format("<td>{:.1f}", e.converged_after_s) : "<td>not settled";
    if (classes)
      html += felt.tissue_class.empty()
                  ? "<td>"
                  : fmt::format("<td class=l>{}<em>{:.0f} %</em>", escaped(felt.tissue_class),
                                100.0 * felt.class_probability);
  }
  return html + "</tbody></table></div>";
}

std::string before_and_after(const ReportData& data) {
  if (data.changes.empty()) return "";
  std::string html = fmt::format(
      "<h3>Before and after</h3><div class=wide><table><thead><tr><th>Point<th>before, N/mm"
      "<th>after, N/mm<th>change<th>smallest change<br>that can be told<th class=l>so it is"
      "</thead><tbody>");
  for (const StiffnessChange& place : data.changes) {
    const double change = place.after_n_per_mm / place.before_n_per_mm - 1.0;
    html += fmt::format("<tr><td>{}<td>{:.2f}<td>{:.2f}<td>{:+.1f} %<td>{:.1f} %<td class=l>{}",
                        escaped(figures::spoken(place.name)), place.before_n_per_mm,
                        place.after_n_per_mm, 100.0 * change, 100.0 * place.detectable,
                        !place.detected ? "no detectable change"
                        : change < 0.0  ? "softer"
                                        : "stiffer");
  }
  return html + fmt::format(
                    "</tbody></table></div><p class=note>Stiffness under {:.0f} N in the first and "
                    "the last presses of each point. A change counts when it is told from noise "
                    "with 95 % at its own point; of twenty points that did not change, one may "
                    "still seem to. Reported effects of massage on stiffness are small and gone "
                    "within minutes, so no detectable change is the usual answer.</p>",
                    data.stiffness_force_n);
}

std::string condition(const ReportData& data) {
  if (!data.condition) return "";
  const BodyCondition& body = *data.condition;
  return fmt::format(
      "<h3>Body condition</h3><p>What was felt is what one feels on a person of slim build with a "
      "probability of {:.0f} %, of medium build with {:.0f} %, of hefty build with {:.0f} %; on a "
      "woman with {:.0f} %.</p><p class=note>With caution: seven people stand behind these "
      "numbers, "
      "one of them a woman, and neighbouring builds overlap.</p>",
      100.0 * body.slim, 100.0 * body.medium, 100.0 * body.hefty, 100.0 * body.female);
}

}  // namespace

std::string tissue_section(const ReportData& data) {
  std::string html =
      "<section class=long><h2>What was felt</h2><p>From depth and force of each press the tissue "
      "under it is estimated: <i>F</i> = &alpha; tan(&beta; <i>x</i>). "
      "&alpha; is its hardness; &beta; is larger where the layer over the bone is thinner; their "
      "product is the stiffness at first touch.</p>";
  if (data.tissue.empty()) return html + "<p class=note>No tissue was estimated.</p></section>";
  const std::string figure = figures::tissue(data);
  html +=
      "<div class=two><div>" + figure +
      "</div><div><p class=note>Colour is the stiffness of the tissue, smooth between the places "
      "that were pressed and paler the less it is known; plain grey is skin too far from any "
      "press to tell.</p>";
  const std::string curves = figures::tissue_curves(data);
  if (!curves.empty()) {
    html += "<h3>Force against depth</h3>" + curves;
    if (has_truth(data))
      html += "<p class=note>Lines: as estimated. Dashed: the truth, simulation only.</p>";
  }
  html += "</div></div>" + tissue_table(data) +
          "<p class=note>± is the half-width of the 95 % interval.";
  const bool truth = has_truth(data);
  if (truth)
    html +=
        " The shaded columns are the tissue that the simulated person was given; they exist in "
        "simulation only and no part of tuina reads them.";
  return html + "</p>" + before_and_after(data) + condition(data) + "</section>";
}

}  // namespace tuina::telemetry
