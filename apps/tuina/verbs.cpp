// SPDX-License-Identifier: Apache-2.0
#include "apps/tuina/verbs.hpp"

#include <fmt/format.h>

namespace tuina::app {

std::string summary_of_group(std::string_view group) {
  if (group == "audit") return "the log of what was asked of `tuina serve`";
  if (group == "atlas") return "labelled backs: record them, learn a file from them, look at it";
  if (group == "teach")
    return "motions that a hand shows to an arm: record, play, look at them, carry them to others";
  if (group == "history") return "people over time: show, notes, export, forget, rebuild";
  if (group == "tissue") return "what a record of presses says about the tissue";
  if (group == "export")
    return "for other programs: a record as CSV, the robot as URDF or MJCF; the scanner's mount to "
           "print";
  if (group == "robot")
    return "robots: show a table, make one from a URDF file, simulate one as a process, near or "
           "over UDP";
  if (group == "record") return "session.mcap, the record of a session: what it holds";
  if (group == "config") return "the settings, their limits and a file of them";
  return fmt::format("see `tuina {} --help`", group);
}

std::vector<std::unique_ptr<Verb>> make_verbs() {
  std::vector<std::unique_ptr<Verb>> verbs;
  verbs.push_back(make_massage());
  verbs.push_back(make_serve());
  verbs.push_back(make_audit_check());
  verbs.push_back(make_report());
  verbs.push_back(make_record_show());
  verbs.push_back(make_scan());
  verbs.push_back(make_line());
#ifdef TUINA_CALIBRATION
  verbs.push_back(make_calibrate());
#endif
  verbs.push_back(make_plan());
  verbs.push_back(make_map());
  verbs.push_back(make_atlas_record());
  verbs.push_back(make_atlas_learn());
  verbs.push_back(make_atlas_show());
  verbs.push_back(make_tissue_fit());
  verbs.push_back(make_tissue_estimate());
  verbs.push_back(make_teach_record());
  verbs.push_back(make_teach_play());
  verbs.push_back(make_teach_show());
  verbs.push_back(make_teach_carry());
  verbs.push_back(make_history_show());
  verbs.push_back(make_history_note());
  verbs.push_back(make_history_export());
  verbs.push_back(make_history_forget());
  verbs.push_back(make_history_rebuild());
  verbs.push_back(make_fleet());
  verbs.push_back(make_config_show());
  verbs.push_back(make_config_check());
  verbs.push_back(make_export_csv());
  verbs.push_back(make_export_urdf());
  verbs.push_back(make_export_mjcf());
  verbs.push_back(make_export_mount());
  verbs.push_back(make_robot_show());
  verbs.push_back(make_robot_import());
  verbs.push_back(make_robot_simulate());
  verbs.push_back(make_robot_armlink());
  verbs.push_back(make_robot_can());
  verbs.push_back(make_guard());
  verbs.push_back(make_camera());
  verbs.push_back(make_doctor());
  return verbs;
}

}  // namespace tuina::app
