// SPDX-License-Identifier: Apache-2.0
#include "tuina/telemetry/report/tissue.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "tuina/core/units.hpp"
#include "tuina/telemetry/report/figures.hpp"

namespace tuina::telemetry {
namespace {

bool has_truth(const ReportData& data) {
  return std::any_of(data.tissue.begin(), data.tissue.end(),
                     [](const FeltTissue& f) { return f.truth.has_value(); });
}

Table tissue_table(const ReportData& data) {
  const bool truth = has_truth(data);
  const bool classes = std::any_of(data.tissue.begin(), data.tissue.end(),
                                   [](const FeltTissue& f) { return !f.tissue_class.empty(); });
  const Language& say = data.language;
  const auto only_if = [](bool wanted, const std::string& head) { return wanted ? head : ""; };
  Table table{
      .columns = {
          {.head = say("Point")},
          {.head = "α, N", .digits = 1},
          {.head = only_if(truth, say("true α (simulation only)")), .digits = 1, .truth = true},
          {.head = "β, 1/mm", .digits = 3},
          {.head = only_if(truth, say("true β (simulation only)")), .digits = 3, .truth = true},
          {.head = say("at {:.0f} N, N/mm", data.stiffness_force_n), .digits = 1},
          {.head = say("presses")},
          {.head = say("settled after, s"), .digits = 1},
          {.head = only_if(classes, say("felt like"))}}};
  const auto within = [](double half_width, int digits) {
    return fmt::format("± {:.{}f}", half_width, digits);
  };
  for (const FeltTissue& felt : data.tissue) {
    const TissueEstimate& e = felt.estimate;
    const auto& truly = felt.truth;
    table.add({figures::spoken(felt.name, say),
               {e.tissue.alpha_n, within(e.alpha_ci95_n, 1)},
               truly ? Cell(truly->alpha_n) : Cell(),
               {from_mm(e.tissue.beta_per_m), within(from_mm(e.beta_ci95_per_m), 3)},
               truly ? Cell(from_mm(truly->beta_per_m)) : Cell(),
               {felt.stiffness_n_per_mm, within(felt.stiffness_ci95_n_per_mm, 1)},
               e.presses,
               e.converged ? Cell(e.converged_after_s) : Cell(say("not settled")),
               felt.tissue_class.empty() || !e.converged
                   ? Cell()
                   : Cell(say(felt.tissue_class),
                          fmt::format("{:.0f} %", 100.0 * felt.class_probability))});
  }
  return table;
}

void add_before_and_after(Part& part, const ReportData& data) {
  if (data.changes.empty()) return;
  const Language& say = data.language;
  Table table{.columns = {{.head = say("Point")},
                          {.head = say("before, N/mm"), .digits = 2},
                          {.head = say("after, N/mm"), .digits = 2},
                          {.head = say("change")},
                          {.head = say("smallest change that can be told")},
                          {.head = say("so it is")}}};
  for (const StiffnessChange& place : data.changes) {
    const double change = place.after_n_per_mm / place.before_n_per_mm - 1.0;
    table.add({figures::spoken(place.name, say), place.before_n_per_mm, place.after_n_per_mm,
               fmt::format("{:+.1f} %", 100.0 * change),
               fmt::format("{:.1f} %", 100.0 * place.detectable),
               !place.detected ? say("no detectable change")
               : change < 0.0  ? say(Sentence{.words = "softer", .key = "became_softer"})
                               : say("stiffer")});
  }
  part.heading(say("Before and after"))
      .table(table)
      .note(say(
          "Stiffness under {:.0f} N in the first and the last presses of each point. A change "
          "counts when it is told from noise with 95 % at its own point; of twenty points that did "
          "not change, one may still seem to. Reported effects of massage on stiffness are small "
          "and gone within minutes, so no detectable change is the usual answer.",
          data.stiffness_force_n));
}

void add_condition(Part& part, const ReportData& data) {
  if (!data.condition) return;
  const Language& say = data.language;
  const BodyCondition& body = *data.condition;
  part.heading(say("Body condition"))
      .text(say(
          "What was felt is what one feels on a person of slim build with a probability of {:.0f} "
          "%, of medium build with {:.0f} %, of hefty build with {:.0f} %; on a woman with {:.0f} "
          "%.",
          100.0 * body.slim, 100.0 * body.medium, 100.0 * body.hefty, 100.0 * body.female))
      .note(say("With caution: seven people stand behind these numbers, one of them a woman, and "
                "neighbouring builds overlap."));
}

}  // namespace

void add_tissue(Page& page, const ReportData& data) {
  const Language& say = data.language;
  Part& part = page.section(
      say("What was felt"),
      say("From depth and force of each press the tissue under it is estimated: F = α tan(β x). α "
          "is its hardness; β is larger where the layer over the bone is thinner; their product is "
          "the stiffness at first touch."));
  if (data.tissue.empty()) {
    part.note(say("No tissue was estimated."));
    return;
  }
  const bool truth = has_truth(data);
  Part laws;
  laws.note(
      say("Colour is the stiffness of the tissue, smooth between the places that were pressed and "
          "paler the less it is known; plain grey is skin too far from any press to tell."));
  const std::string curves = figures::tissue_curves(data);
  if (!curves.empty()) {
    laws.heading(say("Force against depth")).html(curves);
    if (truth)
      laws.note(say(
          "Lines: as estimated, up to the strongest press. Dashed: the truth, simulation only."));
  }
  part.beside(Part().html(figures::tissue(data)), laws)
      .table(tissue_table(data))
      .note(
          say("± is the half-width of the 95 % interval.") +
          (truth
               ? say(" The shaded columns are the same law drawn through the first loading of the "
                     "simulated tissue; no part of tuina reads them.")
               : ""));
  add_before_and_after(part, data);
  add_condition(part, data);
}

}  // namespace tuina::telemetry
