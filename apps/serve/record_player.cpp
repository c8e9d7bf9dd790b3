// SPDX-License-Identifier: Apache-2.0
#include "apps/serve/record_player.hpp"

#include <algorithm>
#include <cmath>

#include "apps/serve/shown_arm.hpp"
#include "tuina/session/steering.hpp"
#include "tuina/telemetry/mcap/cdr.hpp"
#include "tuina/telemetry/mcap/ros_messages.hpp"
#include "tuina/tissue/tangent_model.hpp"

namespace tuina::app {
namespace {

namespace mcap = telemetry::mcap;
using nlohmann::json;

// As often as the record tells the poses and forces that viewers draw, or as the limits allow.
constexpr double frame_every_s = 0.08, row_every_s = 0.05;

double every_s(double usual_s, double duration_s, std::size_t limit) {
  return std::max(usual_s, duration_s / static_cast<double>(limit));
}

std::string text_in(const json& object, const char* key) {
  const auto found = object.find(key);
  return found != object.end() && found->is_string() ? found->get<std::string>() : "";
}

double number_in(const json& object, const char* key) {
  const auto found = object.find(key);
  return found != object.end() && found->is_number() ? found->get<double>() : 0.0;
}

json waiting() {
  return {{"phase", "waiting"}, {"path", -1},    {"probing", false},
          {"target_n", 0.0},    {"felt_n", 0.0}, {"links", json::array()}};
}

}  // namespace

int index_of(const massage::Plan& plan, std::string_view path) {
  const auto found = std::find_if(plan.paths.begin(), plan.paths.end(),
                                  [&](const auto& one) { return one.path.name == path; });
  return found == plan.paths.end() ? -1 : static_cast<int>(found - plan.paths.begin());
}

RecordPlayer::RecordPlayer(const record::SessionFile& file, const massage::Plan& plan,
                           const robot::RobotPlacement& placement)
    : file_(file),
      plan_(plan),
      arms_(robot::both_models(placement.arm, placement.mount)),
      couch_from_base_(file.base_from_couch.inverse()),
      frame_every_s_(every_s(frame_every_s, file.massage.duration_s, max_frames)),
      row_every_s_(every_s(row_every_s, file.massage.duration_s, max_rows)),
      now_({waiting(), waiting()}),
      stiffness_n_per_m_(file.massage.performed.size(), 0.0) {}

void RecordPlayer::take(const mcap::Contents& contents, const mcap::Message& message) {
  const std::string& topic = contents.channels.at(message.channel_id).topic;
  const double time_s = 1e-9 * static_cast<double>(message.log_time_ns);
  if (topic == "/tuina/arms" || topic == "/tuina/tissue") {
    const json told = json::parse(message.data, nullptr, false);
    if (!told.is_object()) return;
    return topic == "/tuina/arms" ? take_arm(told, time_s) : take_tissue(told, time_s);
  }
  if (topic != "/joint_states" || time_s < next_frame_s_ || frames_.size() == max_frames) return;
  if (const auto joints = telemetry::ros::from_cdr<telemetry::ros::JointState>(message.data))
    take_joints(joints->position, time_s);
}

void RecordPlayer::take_arm(const json& told, double time_s) {
  constexpr double per_n = 100.0, per_s = 100.0;
  const bool right = text_in(told, "arm") == name_of(Arm::right);
  json& arm = now_[right ? 1 : 0];
  arm["phase"] = text_in(told, "phase");
  arm["path"] = index_of(plan_, text_in(told, "path"));
  arm["target_n"] = rounded(number_in(told, "target_n"), per_n);
  arm["felt_n"] = rounded(number_in(told, "measured_n"), per_n);
  // The right arm is told after the left one, of the same millisecond.
  if (!right || time_s < next_row_s_ || forces_.size() == max_rows) return;
  next_row_s_ = time_s + row_every_s_ - 1e-3;
  forces_.push_back({rounded(time_s, per_s), now_[0]["target_n"], now_[0]["felt_n"],
                     now_[1]["target_n"], now_[1]["felt_n"]});
}

// A path may be performed twice: what was felt belongs to the contact that ended with the message.
void RecordPlayer::take_tissue(const json& told, double time_s) {
  constexpr double same_s = 0.1;
  const std::string path = text_in(told, "path");
  const TangentTissue tissue{.alpha_n = number_in(told, "alpha_n"),
                             .beta_per_m = 1e3 * number_in(told, "beta_per_mm")};
  const auto& performed = file_.massage.performed;
  for (std::size_t i = 0; i < performed.size(); ++i) {
    if (performed[i].name == path && std::abs(performed[i].end_s - time_s) < same_s)
      stiffness_n_per_m_[i] = tissue::stiffness_at_force(tissue, session::reference_force_n);
  }
}

// The rail first, then the joints of the left and of the right arm.
void RecordPlayer::take_joints(const std::vector<double>& q, double time_s) {
  const int joints = arms_[Arm::left].joints();
  const bool known =
      q.size() == 1 + 2 * static_cast<std::size_t>(joints) &&
      std::all_of(q.begin(), q.end(), [](double value) { return std::isfinite(value); });
  if (!known) return;
  next_frame_s_ = time_s + frame_every_s_ - 1e-3;
  for (const Arm arm : both_arms) {
    const auto at = static_cast<std::size_t>(arm);
    const Eigen::Map<const Eigen::VectorXd> own(
        q.data() + 1 + at * static_cast<std::size_t>(joints), joints);
    now_[at]["links"] = shown_links(arms_[arm], JointVector(own), q.front(), couch_from_base_);
  }
  const auto& performed = file_.massage.performed;
  const auto ended = std::count_if(performed.begin(), performed.end(),
                                   [&](const auto& one) { return one.end_s <= time_s; });
  frames_.push_back(
      {{"time_s", rounded(time_s, 1e3)}, {"performed", ended}, {"arms", {now_[0], now_[1]}}});
}

}  // namespace tuina::app
