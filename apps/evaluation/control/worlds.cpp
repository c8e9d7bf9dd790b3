// SPDX-License-Identifier: Apache-2.0
#include "apps/evaluation/control/worlds.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace tuina::app {

std::vector<Choice> numbers(const std::vector<double>& values,
                            const std::function<void(ContactExperiment&, double)>& set) {
  std::vector<Choice> choices;
  choices.reserve(values.size());
  for (const double value : values)
    choices.push_back({fmt::format("{:g}", value), [=](auto& run) { set(run, value); }});
  return choices;
}

std::vector<Choice> forces(const std::vector<double>& forces_n) {
  return numbers(forces_n, [](auto& run, double force_n) { run.force_n = force_n; });
}

std::vector<Choice> all_tissues() {
  std::vector<Choice> choices;
  choices.reserve(std::size(tissues));
  for (const NamedTissue& named : tissues)
    choices.push_back({named.name, [named](auto& run) { run.tissue = named.tissue; }});
  return choices;
}

const std::vector<Choice>& torsos() {
  static const std::vector<Choice> all = {
      {"35 N/mm", [](auto& run) { run.torso_n_per_m = 35'000.0; }},
      {"rigid", [](auto& run) { run.torso_n_per_m = sim::rigid; }}};
  return all;
}

std::vector<ControlRow> varied(const std::vector<ControlRow>& rows, const std::string& label,
                               const std::vector<Choice>& choices) {
  std::vector<ControlRow> all;
  for (const ControlRow& row : rows) {
    for (const Choice& choice : choices) {
      ControlRow& one = all.emplace_back(row);
      const auto known = std::find_if(one.labels.begin(), one.labels.end(),
                                      [&](const auto& pair) { return pair.first == label; });
      if (known == one.labels.end()) {
        one.labels.emplace_back(label, choice.name);
      } else {
        known->second = choice.name;
      }
      for (ContactExperiment& run : one.runs) choice.set(run);
    }
  }
  return all;
}

ContactExperiment wrong_world(double force_n, std::uint64_t seed) {
  ContactExperiment experiment;
  experiment.force_n = force_n;
  experiment.seed = seed;
  experiment.surface_error_m = seed % 2 == 0 ? 3_mm : -3_mm;
  experiment.mass_scale = seed % 4 < 2 ? 1.1 : 0.9;
  experiment.duration_s = 5.0;
  return experiment;
}

sim::Shift person_moves(double outward_mm, double m_per_s, double m_per_s2) {
  sim::Shift shift{.start_s = 2.0,
                   .by_in_couch = Vector3(0.0, from_mm(outward_mm), 0.0),
                   .speed_m_per_s = m_per_s};
  if (m_per_s2 > 0.0) shift.acceleration_m_per_s2 = m_per_s2;
  return shift;
}

ControlRow on_all_tissues(double force_n, int seeds, std::uint64_t first_seed) {
  ControlRow row{.labels = {{"what", ""}}, .runs = {}};
  for (const NamedTissue& named : tissues) {
    for (int k = 0; k < seeds; ++k) {
      row.runs.push_back(wrong_world(force_n, first_seed + row.runs.size()));
      row.runs.back().tissue = named.tissue;
    }
  }
  return row;
}

}  // namespace tuina::app
