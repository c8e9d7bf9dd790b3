// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <vector>

#include "apps/cli/command_line.hpp"

namespace tuina::app {

// The verbs that are experiments; `evaluate calibration` only where its room is built.
std::unique_ptr<Verb> make_press();
std::unique_ptr<Verb> make_evaluate_tissue();
std::unique_ptr<Verb> make_evaluate_scanner();
std::unique_ptr<Verb> make_evaluate_control();
std::unique_ptr<Verb> make_evaluate_armlink();
std::unique_ptr<Verb> make_evaluate_all();
std::unique_ptr<Verb> make_evaluate_massage();
std::unique_ptr<Verb> make_evaluate_teach();
std::unique_ptr<Verb> make_evaluate_robots();
std::unique_ptr<Verb> make_evaluate_history();
std::unique_ptr<Verb> make_evaluate_safety();
std::unique_ptr<Verb> make_evaluate_acupoints();
std::unique_ptr<Verb> make_evaluate_atlas();
std::unique_ptr<Verb> make_evaluate_calibration();
std::unique_ptr<Verb> make_evaluate_processes();
std::unique_ptr<Verb> make_evaluate_merge();

/// All of them, in the order in which `evaluate all` runs them.
std::vector<std::unique_ptr<Verb>> make_evaluations();

}  // namespace tuina::app
