// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "apps/evaluation/control/reach_trials.hpp"
#include "apps/evaluation/control/reflex_bound.hpp"
#include "apps/evaluation/control/trials.hpp"
#include "tuina/telemetry/table.hpp"

namespace tuina::app {

/// One run over time, for a figure.
struct ControlTrace {
  std::string controller;
  std::vector<ContactSample> samples;
};

/// All that `evaluate control` has found.
struct ControlReport {
  bool full = false;
  std::uint64_t seed = 1;
  std::string realism = "ideal";  ///< of the world of contact
  std::vector<ControlTable> tables;
  std::vector<ControlTrace> presses;  ///< 30 N on soft muscle over a rigid torso
  std::vector<ControlTrace> rises;    ///< under 40 N on hard muscle a person rises
  std::vector<BeyondReach> beyond_reach;
  std::vector<ReflexBound> reflex_bounds;
  ForceAtTool force_at_tool;

  [[nodiscard]] const ControlTable* table(const std::string& name) const;
};

/// The tables as people see them; of `controllers` only the groups.
[[nodiscard]] telemetry::Table shown_table(const ControlTable& table);
[[nodiscard]] telemetry::Table beyond_reach_table(const ControlReport& report);
[[nodiscard]] telemetry::Table reflex_table(const ControlReport& report);
/// A sentence about the force that the drives hold.
[[nodiscard]] std::string force_sentence(const ForceAtTool& force);

[[nodiscard]] std::string to_json(const ControlReport& report);
[[nodiscard]] std::string to_text(const ControlReport& report);

/// File name without its ending, and the drawing.
[[nodiscard]] std::vector<std::pair<std::string, std::string>> figures_of(
    const ControlReport& report);

/// One self-contained page.
[[nodiscard]] std::string page_of(const ControlReport& report);

}  // namespace tuina::app
