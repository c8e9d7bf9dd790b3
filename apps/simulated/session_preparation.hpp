// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "apps/cli/command_line.hpp"
#include "tuina/body/acupoints.hpp"
#include "tuina/body/atlas.hpp"
#include "tuina/massage/plan.hpp"
#include "tuina/massage/programme.hpp"
#include "tuina/motion/ready_plan.hpp"
#include "tuina/robot/robot_model.hpp"
#include "tuina/scanner/sweep.hpp"
#include "tuina/session/config.hpp"
#include "tuina/session/live_command.hpp"
#include "tuina/session/robot_pose.hpp"
#include "tuina/sim/person/person.hpp"
#include "tuina/tissue/body_condition.hpp"

namespace tuina::app {

struct SessionOrder {
  std::string person = "phantom:medium";
  std::optional<Position> position;
  std::string programme = "relax";
  std::string robot = "thesis";  ///< a shipped robot or the file of its table
  body::Method method = body::Method::surface;
  std::string atlas;       ///< a file or a labelled body; empty: the shipped one
  std::string no_go;       ///< a file with what the therapist rules out; empty: nothing
  std::string consent;     ///< a file with answers; empty: the simulated person answers
  std::string robot_pose;  ///< a file of `calibrate --robot`; empty: as good a one
  bool adaptive = true;
  tissue::BodyFacts facts;
  bool keys = false;  ///< live commands from standard input
  /// Commands as they were given in a session before, and when; instead of keys.
  std::vector<std::pair<double, session::LiveCommand>> commands;
  bool real_time = false;
};

/// How the config and the therapist want a plan.
[[nodiscard]] Result<massage::PlanOptions> plan_options(const session::Config& config,
                                                        const std::string& no_go_file);

/// What a session is given, read and judged before anyone is touched.
struct SessionSetting {
  SessionOrder order;
  session::Config config;
  CommonOptions common;
  massage::Programme programme;
  massage::PlanOptions plan_options;
  body::Atlas atlas;
  std::optional<session::PlacedRobot> robot;  ///< as measured
  robot::RobotModel model;
};
[[nodiscard]] Result<SessionSetting> read_setting(const SessionOrder& order,
                                                  const session::Config& config,
                                                  const CommonOptions& common);

/// At which end of the couch the head of a mapped person lies.
[[nodiscard]] bool head_at_plus_y(std::span<const Acupoint> acupoints);

/// From the person on the couch to a plan that two arms can carry out.
struct Preparation {
  scanner::Scan scan;
  double scan_error_m = 0.0;  ///< RMS distance from the true surface
  body::Mapping located;
  std::vector<double> acupoint_errors_m;  ///< per point of `located`, against the truth
  double locate_ms = 0.0;
  robot::RobotPlacement placement;
  motion::ReadyPlan ready;
  double plan_ms = 0.0;
  Transform base_from_couch = Transform::Identity();  ///< as the session believes it
};

/// What a massage that was broken off has left: where the base stands, and the names of the paths
/// that are done.
struct Resumed {
  double rail_m = 0.0;
  std::vector<std::string> done;
};

/// Scan, map, plan, for a person who lies where `person` says.
[[nodiscard]] Result<Preparation> prepare(const SessionSetting& setting, const sim::Person& person,
                                          const std::optional<Resumed>& resumed = std::nullopt);

/// Where the session believes the couch to be: as the robot was measured, or else 2 mm and 0.3
/// degrees from the truth.
[[nodiscard]] Transform believed_base_from_couch(const SessionSetting& setting,
                                                 const robot::RobotMount& mount);

}  // namespace tuina::app
