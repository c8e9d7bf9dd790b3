// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "tuina/massage/plan.hpp"
#include "tuina/record/session_file.hpp"
#include "tuina/robot/arm_model.hpp"
#include "tuina/robot/robot_model.hpp"
#include "tuina/telemetry/mcap/reader.hpp"

namespace tuina::app {

/// Place in the plan of the path of that name, or -1.
[[nodiscard]] int index_of(const massage::Plan& plan, std::string_view path);

/// Messages of a record, taken one after the other, become what a page is shown of a running
/// session, only seldomer: at most `max_frames` frames and `max_rows` rows of forces.
class RecordPlayer {
 public:
  static constexpr std::size_t max_frames = 6000, max_rows = 24000;
  /// `file` and `plan` outlive this object.
  RecordPlayer(const record::SessionFile& file, const massage::Plan& plan,
               const robot::RobotPlacement& placement);
  void take(const telemetry::mcap::Contents& contents, const telemetry::mcap::Message& message);

  /// As the messages `live` of a running session, without `forces`.
  [[nodiscard]] const nlohmann::json& frames() const { return frames_; }
  /// Time, and of each arm the force asked for and the force felt.
  [[nodiscard]] const nlohmann::json& forces() const { return forces_; }
  /// At `session::reference_force_n`, for each performed path; 0: it felt none.
  [[nodiscard]] const std::vector<double>& stiffness_n_per_m() const { return stiffness_n_per_m_; }

 private:
  void take_arm(const nlohmann::json& told, double time_s);
  void take_tissue(const nlohmann::json& told, double time_s);
  void take_joints(const std::vector<double>& q, double time_s);

  const record::SessionFile& file_;
  const massage::Plan& plan_;
  PerArm<robot::ArmModel> arms_;
  Transform couch_from_base_;
  double frame_every_s_, row_every_s_;
  double next_frame_s_ = 0.0, next_row_s_ = 0.0;
  std::array<nlohmann::json, 2> now_;
  nlohmann::json frames_ = nlohmann::json::array(), forces_ = nlohmann::json::array();
  std::vector<double> stiffness_n_per_m_;
};

}  // namespace tuina::app
