// SPDX-License-Identifier: Apache-2.0
#include "apps/evaluation/acupoints/bad_scan_trials.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "apps/evaluation/acupoints/scores.hpp"
#include "apps/simulated/bad_scans.hpp"
#include "apps/simulated/labelled_phantom.hpp"
#include "tuina/body/acupoints.hpp"
#include "tuina/core/units.hpp"

namespace tuina::app {
namespace {

using nlohmann::json;

/// The answers to one kind of bad scan.
struct Kind {
  int people = 0;
  int answered = 0;
  int points = 0;
  int wrong = 0;
  double error_mm = 0.0;  // sum
  double largest_mm = 0.0;
  double radius_mm = 0.0;  // sum
  double min_radius_mm = 0.0;
  json remarks = json::array();

  void add(const body::LabelledBody& person, const body::Atlas& atlas) {
    ++people;
    const auto back = body::fit_back(person.scan_in_couch);
    const auto found = back ? body::locate_acupoints(*back, atlas) : tl::unexpected(back.error());
    if (!found) {
      remarks.push_back(found.error().message);
      return;
    }
    ++answered;
    for (std::size_t i = 0; i < seven_acupoints.size(); ++i) {
      const Acupoint& point = found->acupoints[i];
      const double off_mm = to_mm(place_error_m(point, person.acupoints[i]));
      const double said_mm = to_mm(point.uncertainty_m);
      min_radius_mm = points == 0 ? said_mm : std::min(min_radius_mm, said_mm);
      ++points;
      error_mm += off_mm;
      largest_mm = std::max(largest_mm, off_mm);
      radius_mm += said_mm;
      if (!wrong_and_sure(point, person.acupoints[i])) continue;
      ++wrong;
      remarks.push_back(
          fmt::format("{} is {:.0f} mm off, {:.0f} said; {:.0f} % seen, {:.1f} times "
                      "as unusual as usual, misfit {:.1f} mm",
                      point.name, off_mm, said_mm, 100.0 * found->coverage,
                      found->mahalanobis2_per_mode, to_mm(found->rms_residual_m)));
    }
  }
};

json to_json(const char* name, BodyPosture position, const Kind& kind) {
  const auto mean = [&](double sum) { return kind.points > 0 ? json(sum / kind.points) : json(); };
  return {{"kind", name},
          {"position", name_of(position)},
          {"people", kind.people},
          {"answered", kind.answered},
          {"mean_mm", mean(kind.error_mm)},
          {"max_mm", kind.largest_mm},
          {"radius_mm", mean(kind.radius_mm)},
          {"min_radius_mm", kind.min_radius_mm},
          {"wrong_and_sure", kind.wrong},
          {"remarks", kind.remarks}};
}

}  // namespace

json judge_bad_scans(int phantoms, std::uint64_t seed, const body::Atlas& atlas,
                     const Progress& progress) {
  json judged = json::array();
  const auto kinds = bad_scans();
  for (const BodyPosture position : {BodyPosture::sitting, BodyPosture::prone}) {
    std::vector<body::LabelledBody> people;
    for (int i = 0; i < phantoms; ++i) {
      // Seeds that the shipped atlas has not drawn.
      const auto shape = sim::draw_phantom(seed * 1000000007ULL + static_cast<std::uint64_t>(i));
      people.push_back(labelled(sim::make_phantom(shape, position)));
    }
    for (const BadScan& bad : kinds) {
      Kind kind;
      for (const auto& person : people) kind.add(spoilt(person, bad), atlas);
      judged.push_back(to_json(bad.name, position, kind));
      if (progress)
        progress(static_cast<double>(judged.size()) / static_cast<double>(2 * kinds.size()));
    }
  }
  return judged;
}

std::string bad_scans_text(const json& judged) {
  telemetry::Table table{.note =
                             "the seven points along the skin, mm; wrong and sure: more than "
                             "15 mm and more than the radius off",
                         .columns = {{.head = "what spoils the scan"},
                                     {.head = "position"},
                                     {.head = "answered"},
                                     {.head = "of"}}};
  for (const char* head : {"mean", "largest", "radius", "min. radius"})
    table.columns.push_back({.head = head, .digits = 0});
  table.columns.push_back({.head = "wrong and sure"});
  int wrong = 0;
  int points = 0;
  for (const json& row : judged) {
    const bool any = row["answered"].get<int>() > 0;
    const auto cell = [&](const char* key) {
      return any ? number_in(row, key) : telemetry::Cell(std::nan(""));
    };
    table.add({row["kind"].get<std::string>(), row["position"].get<std::string>(),
               row["answered"].get<int>(), row["people"].get<int>(), cell("mean_mm"),
               cell("max_mm"), cell("radius_mm"), cell("min_radius_mm"),
               row["wrong_and_sure"].get<int>()});
    wrong += row["wrong_and_sure"].get<int>();
    points += row["answered"].get<int>() * static_cast<int>(seven_acupoints.size());
  }
  return to_text(table) + fmt::format("wrong and sure: {} of {} points", wrong, points);
}

}  // namespace tuina::app
