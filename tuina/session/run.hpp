// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "tuina/body/acupoints.hpp"
#include "tuina/body/atlas.hpp"
#include "tuina/core/result.hpp"
#include "tuina/link/supervisor.hpp"
#include "tuina/massage/plan.hpp"
#include "tuina/massage/programme.hpp"
#include "tuina/motion/ready_plan.hpp"
#include "tuina/robot/robot.hpp"
#include "tuina/robot/robot_model.hpp"
#include "tuina/scanner/camera.hpp"
#include "tuina/scanner/sweep.hpp"
#include "tuina/scanner/turntable.hpp"
#include "tuina/session/config.hpp"
#include "tuina/session/consent.hpp"
#include "tuina/session/earlier/by_hand.hpp"
#include "tuina/session/earlier/known_tissue.hpp"
#include "tuina/session/live_command.hpp"
#include "tuina/session/massage_step.hpp"
#include "tuina/session/observer.hpp"
#include "tuina/session/robot_pose.hpp"

namespace tuina::session {

/// What a session is given to see and to touch with.
struct Devices {
  scanner::Camera& camera;
  scanner::Turntable& turntable;
  robot::Robot& robot;
  link::Supervisor* supervisor = nullptr;  ///< null: the guard runs in this process
  double lag_s = 0.0;  ///< by which arms that take places, and their force, follow; torques: 0
};

/// What is known and wanted before a session begins.
struct Order {
  Consent consent;  ///< every question was answered with no
  massage::Programme programme;
  massage::PlanOptions plan_options;
  body::Atlas atlas;
  body::Method method = body::Method::surface;
  std::optional<BodyPosture>
      position;  ///< position of the person; nothing: recognised from the scan
  scanner::ScannerCalibration calibration;
  robot::RobotModel robot;
  PlacedRobot placed;  ///< measured place of the robot
  /// What was said by hand of this person in a session before. Where it does not fit the back that
  /// is seen, it is left out and a note says so to who reviews the plan; without a `review` it is
  /// refused, for a place that was ruled out must not be lost unseen.
  Said said;
  std::vector<body::PalpatedPoint> fixed;  ///< points that a finger has shown on this scan
  bool adaptive = true;                    ///< presses follow the tissue that was felt
  double intensity = 1.0;  ///< on every force, as the session begins; wishes change it
  /// What an earlier session of this person has felt; used where the scan shows the same person.
  KnownTissue known;
  /// Asked before the first arm moves, and again with every plan that a change gave; it may wait
  /// for somebody who looks. `refused` says why a change could not be made, and is empty otherwise;
  /// the plan is then the one before. Empty: no need to ask.
  std::function<Review(const motion::ReadyPlan&, const std::string& refused)> review;
  /// Asked in every millisecond for a command of the therapist; it must not wait.
  std::function<std::optional<LiveCommand>(double time_s)> commands;
};

/// What a session saw, believed, planned and did. After a person has moved, scan, map and plan are
/// the newest; the plan's paths begin with those of earlier plans that were performed.
struct Session {
  scanner::Scan scan;
  body::Mapping located;
  robot::RobotPlacement placement;
  motion::ReadyPlan ready;
  Transform base_from_couch = Transform::Identity();  ///< pose that the session believes
  Said said;                                          ///< by hand, in the end
  std::vector<KnownPlace> known;                      ///< of earlier sessions, as it was used
  double intensity = 1.0;                             ///< as the wishes have left it
  bool paused = false;                                ///< somebody has asked to, and not to go on
  double locate_ms = 0.0;                             ///< computing time
  double plan_ms = 0.0;

  std::vector<Performed> performed;
  std::vector<Decision> decisions;
  std::vector<std::pair<double, LiveCommand>> commands;  ///< time and command
  std::vector<Stop> stops;
  std::vector<double> rescans_s;  ///< times at which the person had moved and was scanned again
  double massage_s = 0.0;         ///< robot time at the end
  double compute_s = 0.0;         ///< wall time of the massage
};

/// The method: scan, map, plan, massage; once more after a person has moved. It knows neither which
/// devices it drives nor who watches. Fails with the cause when a device fails, when no plan can be
/// made, or when the massage takes far longer than planned; a stop for safety is no failure and
/// stands in `stops`.
[[nodiscard]] Result<Session> run(Devices devices, const Order& order, const Config& config,
                                  Observer& observer);

/// At which end of the couch the head of a mapped person lies.
[[nodiscard]] bool head_at_plus_y(std::span<const Acupoint> acupoints);

}  // namespace tuina::session
