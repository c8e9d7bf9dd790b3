// SPDX-License-Identifier: Apache-2.0
#include "apps/evaluation/control/trials.hpp"

#include <algorithm>
#include <mutex>

#include "tuina/core/parallel.hpp"

namespace tuina::app {

void ControlResult::add(const ContactOutcome& outcome) {
  add({.runs = 1,
       .stopped = outcome.stopped ? 1 : 0,
       .rmse_n = outcome.force.rmse_n,
       .overshoot_n = outcome.force.overshoot_n,
       .ripple_n = outcome.ripple_n,
       .highest_n = outcome.highest_n,
       .max_speed_m_per_s = outcome.max_speed_m_per_s,
       .second_impact_n = outcome.second_impact_n});
}

void ControlResult::add(const ControlResult& other) {
  runs += other.runs;
  stopped += other.stopped;
  for (double ControlResult::*value :
       {&ControlResult::rmse_n, &ControlResult::overshoot_n, &ControlResult::ripple_n,
        &ControlResult::highest_n, &ControlResult::max_speed_m_per_s,
        &ControlResult::second_impact_n}) {
    this->*value = std::max(this->*value, other.*value);
  }
}

bool ControlTarget::reached(const ControlResult& result) const {
  const auto within = [](const std::optional<double>& limit, double value) {
    return !limit || value <= *limit;
  };
  const bool ended = rmse_n && result.stopped > 0;  // the error of what was left out is not known
  return !ended && within(rmse_n, result.rmse_n) && within(overshoot_n, result.overshoot_n) &&
         within(highest_n, result.highest_n) &&
         within(max_speed_m_per_s, result.max_speed_m_per_s) &&
         within(second_impact_n, result.second_impact_n);
}

const std::string& ControlRow::label(const std::string& name) const {
  static const std::string none;
  const auto found = std::find_if(labels.begin(), labels.end(),
                                  [&](const auto& label) { return label.first == name; });
  return found == labels.end() ? none : found->second;
}

namespace {

/// One experiment of a row, and the name of its cell.
struct ControlJob {
  ControlRow* row;
  const ContactExperiment* experiment;
  std::string cell;
};

std::vector<ControlJob> jobs_of(std::vector<ControlTable>& tables) {
  std::vector<ControlJob> jobs;
  for (ControlTable& table : tables) {
    for (std::size_t i = 0; i < table.rows.size(); ++i) {
      ControlRow& row = table.rows[i];
      std::string name = fmt::format("{} {}", table.name, i + 1);
      for (const auto& [label, value] : row.labels) name += fmt::format(" {}={}", label, value);
      for (std::size_t k = 0; k < row.runs.size(); ++k)
        jobs.push_back({&row, &row.runs[k], fmt::format("{} run {}", name, k + 1)});
    }
  }
  return jobs;
}

}  // namespace

Result<void> run_tables(std::vector<ControlTable>& tables, Cells& cells, unsigned threads,
                        const Progress& progress) {
  const std::vector<ControlJob> jobs = jobs_of(tables);
  std::mutex guard;  // of the rows and of the first failure
  std::optional<Error> failure;
  const auto work = [&](std::size_t k) {
    const auto result = cells.at<ControlResult>(jobs[k].cell, [&]() -> Result<ControlResult> {
      const auto outcome = run_contact(*jobs[k].experiment);
      if (!outcome) return tl::unexpected(outcome.error());
      ControlResult one;
      one.add(*outcome);
      return one;
    });
    const std::lock_guard lock(guard);
    if (result) {
      jobs[k].row->result.add(*result);
    } else if (!failure) {
      failure = result.error();
    }
  };
  for_each_in_parallel(jobs.size(), work, progress, threads);
  if (failure) return tl::unexpected(*failure);
  return {};
}

ControlTable grouped(const ControlTable& table, const std::vector<std::string>& labels) {
  ControlTable groups{.name = table.name, .about = table.about, .rows = {}};
  for (const ControlRow& row : table.rows) {
    ControlRow group;
    for (const std::string& name : labels) group.labels.emplace_back(name, row.label(name));
    auto found = std::find_if(groups.rows.begin(), groups.rows.end(), [&](const ControlRow& other) {
      return other.labels == group.labels;
    });
    if (found == groups.rows.end()) found = groups.rows.insert(found, std::move(group));
    found->result.add(row.result);
  }
  return groups;
}

}  // namespace tuina::app
