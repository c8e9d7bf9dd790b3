// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "tuina/core/progress.hpp"
#include "tuina/core/result.hpp"
#include "tuina/telemetry/page.hpp"

namespace tuina::app {

/// [thesis] 6.3.2 again: the seven subjects of Table 6-2 as simulated bodies, each pressed over
/// bone, hard and soft muscle for a minute by the simulated arm. `figures` is what Figs. 6-9, 6-10
/// and 6-12 show.
struct ThesisSubjects {
  telemetry::Table presses, people;
  telemetry::Part figures;
};
[[nodiscard]] Result<ThesisSubjects> press_thesis_subjects(std::uint64_t seed,
                                                           const Progress& progress);

}  // namespace tuina::app
