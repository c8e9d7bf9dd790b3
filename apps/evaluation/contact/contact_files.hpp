// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "apps/evaluation/contact/contact_experiment.hpp"

namespace tuina::app {

/// A row for each sample.
[[nodiscard]] std::string to_csv(const std::vector<ContactSample>& trace);
/// Likewise of what was felt, with the columns of a record of presses.
[[nodiscard]] std::string to_csv(const std::vector<tissue::TimedPress>& felt);
/// Target, true and measured force from the first touch on, SVG.
[[nodiscard]] std::string draw(const std::vector<ContactSample>& trace, const std::string& title);

}  // namespace tuina::app
