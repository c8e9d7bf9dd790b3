// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "apps/cli/command_line.hpp"

namespace tuina::app {

// One file per verb; a verb that does not exist yet is absent here and so from --help.
std::unique_ptr<Verb> make_massage();
std::unique_ptr<Verb> make_serve();
std::unique_ptr<Verb> make_audit_check();
std::unique_ptr<Verb> make_report();
std::unique_ptr<Verb> make_record_show();
std::unique_ptr<Verb> make_config_show();
std::unique_ptr<Verb> make_config_check();
std::unique_ptr<Verb> make_tissue_fit();
std::unique_ptr<Verb> make_tissue_estimate();
std::unique_ptr<Verb> make_map();
std::unique_ptr<Verb> make_atlas_learn();
std::unique_ptr<Verb> make_atlas_record();
std::unique_ptr<Verb> make_atlas_show();
std::unique_ptr<Verb> make_camera();
std::unique_ptr<Verb> make_doctor();
std::unique_ptr<Verb> make_export_csv();
std::unique_ptr<Verb> make_export_urdf();
std::unique_ptr<Verb> make_export_mjcf();
std::unique_ptr<Verb> make_export_mount();
std::unique_ptr<Verb> make_robot_import();
std::unique_ptr<Verb> make_robot_show();
std::unique_ptr<Verb> make_robot_simulate();
std::unique_ptr<Verb> make_robot_armlink();
std::unique_ptr<Verb> make_robot_can();
std::unique_ptr<Verb> make_guard();
std::unique_ptr<Verb> make_line();
std::unique_ptr<Verb> make_calibrate();  // only where its room is built
std::unique_ptr<Verb> make_scan();
std::unique_ptr<Verb> make_plan();
std::unique_ptr<Verb> make_teach_record();
std::unique_ptr<Verb> make_teach_play();
std::unique_ptr<Verb> make_teach_show();
std::unique_ptr<Verb> make_teach_carry();
std::unique_ptr<Verb> make_history_show();
std::unique_ptr<Verb> make_history_export();
std::unique_ptr<Verb> make_history_forget();
std::unique_ptr<Verb> make_history_rebuild();
std::unique_ptr<Verb> make_history_note();
std::unique_ptr<Verb> make_fleet();

/// One line for --help about the verbs that begin with the same word.
std::string summary_of_group(std::string_view group);

/// In the order of a session, as --help shows them.
std::vector<std::unique_ptr<Verb>> make_verbs();

}  // namespace tuina::app
