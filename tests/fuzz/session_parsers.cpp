// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "tests/folder.hpp"
#include "tests/fuzz/parsers.hpp"
#include "tuina/core/io/file.hpp"
#include "tuina/core/units.hpp"
#include "tuina/massage/no_go.hpp"
#include "tuina/massage/programme.hpp"
#include "tuina/massage/technique_law.hpp"
#include "tuina/record/plan_file.hpp"
#include "tuina/record/session_file.hpp"
#include "tuina/robot/arm_model.hpp"
#include "tuina/robot/table/read_urdf.hpp"
#include "tuina/robot/table/robot_table.hpp"
#include "tuina/session/config.hpp"
#include "tuina/session/consent.hpp"
#include "tuina/session/robot_pose.hpp"
#include "tuina/session/taught_motion.hpp"
#include "tuina/telemetry/mcap/reader.hpp"
#include "tuina/telemetry/mcap/writer.hpp"

namespace tuina::test {
namespace {

bool accepts_programme(std::string_view content) {
  const auto programme = massage::parse_programme(content, "f.toml");
  if (!programme) return false;
  demand(!programme->parts.empty(), "a programme has parts");
  for (const massage::Part& part : programme->parts) {
    demand(part.force_n >= 3.0 && part.force_n <= 45.0, "a force lies between touch and ceiling");
    demand(!part.points.empty() || !part.line.empty() || part.places.size() > 1,
           "a part has a place");
    demand(part.repeats.value_or(1) >= 1 && part.time_s.value_or(1.0) >= 1.0, "it takes place");
    const bool circles = massage::law_of(part.technique).circles;
    demand(2.0 * pi * part.radius_m * part.rate_hz < 0.081 || !circles, "a tool slides slowly");
  }
  return true;
}

bool accepts_no_go(std::string_view content) {
  const auto entries = massage::parse_no_go(content, "f.toml");
  if (!entries) return false;
  demand(!entries->empty(), "something is ruled out");
  for (const massage::NoGo& entry : *entries) {
    demand(entry.corners_in_couch.size() >= 3 && !entry.name.empty(), "a polygon with a name");
    for (const Vector3& corner : entry.corners_in_couch) {
      demand(corner.cwiseAbs().maxCoeff() <= 3.0, "a corner is on the couch");
    }
  }
  return true;
}

/// Whatever is spoilt: nobody is touched unless every question still says no.
bool accepts_consent(std::string_view content) {
  const auto consent = session::parse_consent(content, "f.toml");
  if (!consent) return false;
  demand(!consent->answered_by.empty(), "somebody answered");
  std::size_t noes = 0;
  for (std::size_t at = content.find("no"); at != std::string_view::npos;
       at = content.find("no", at + 1)) {
    const auto quoted = [](char c) { return c == '"' || c == '\''; };
    noes += at > 0 && at + 2 < content.size() && quoted(content[at - 1]) && quoted(content[at + 2]);
  }
  demand(noes >= session::health_questions.size(), "every question says no");
  return true;
}

bool accepts_config(std::string_view content) {
  const auto config = session::parse_config(content, "f.toml");
  if (!config) return false;
  demand(config->safety.force_ceiling_n <= 45.0, "a file may not raise the ceiling");
  const auto again = session::parse_config(session::to_toml(*config), "again");
  demand(again && session::to_toml(*again) == session::to_toml(*config), "what is written is read");
  return true;
}

bool accepts_robot_pose(std::string_view content) {
  const auto robot = session::parse_robot_pose(content, "f.toml");
  if (!robot) return false;
  demand(std::abs(robot->base_from_couch.linear().determinant() - 1.0) < 1e-9, "a rotation");
  demand(robot->base_from_couch.translation().allFinite(), "a place");
  return true;
}

bool accepts_robot(std::string_view content) {
  const auto model = robot::parse_robot(content, "f.toml");
  if (!model) return false;
  demand(model->arm.joints == 6 || model->arm.joints == 7, "an arm of six or seven joints");
  for (const BodyPosture position : {BodyPosture::sitting, BodyPosture::prone}) {
    const robot::RobotPlacement there = robot::place_robot(*model, position);
    for (const robot::ArmModel& arm : robot::both_models(there.arm, there.mount).of) {
      const auto pose = arm.kinematics(JointVector::Zero(arm.joints()), 0.0);
      demand(pose.base_from_tool.matrix().allFinite(), "the tool is somewhere");
    }
  }
  const auto again = robot::parse_robot(robot::to_toml(*model), "again");
  demand(again && robot::to_toml(*again) == robot::to_toml(*model), "what is written is read");
  return true;
}

bool accepts_urdf(std::string_view content) {
  const auto arm = robot::read_urdf(content, "f.urdf", "rail", "left_tool");
  if (!arm) return false;
  demand(arm->table.joints == 6 || arm->table.joints == 7, "an arm of six or seven joints");
  const robot::ArmModel model(arm->table, {}, Arm::left);
  demand(model.base_from_tool(JointVector::Zero(model.joints()), 0.0).matrix().allFinite(),
         "the tool is somewhere");
  return true;
}

bool accepts_plan(std::string_view content) {
  const auto file = record::parse_plan(content, "plan.json");
  if (!file) return false;
  for (const auto& planned : file->plan.paths) {
    for (const ContactPoint& point : planned.path.points) {
      demand(point.at_in_couch.allFinite() && std::isfinite(point.force_n), "numbers are finite");
    }
  }
  return true;
}

record::PlanFile some_plan() {
  record::PlanFile file;
  file.plan.programme = "mine";
  file.plan.zones_touched = {"muscle"};
  file.plan.notes = {{.words = "press BL47_L: 22.0 N lowered to 13.0 N (ribs)"}};
  massage::PlannedPath planned;
  planned.path.name = "press BL47_L";
  planned.path.acupoints = {"BL47_L"};
  for (const double time_s : {0.0, 0.01, 0.02}) {
    planned.path.points.push_back({.time_s = time_s,
                                   .at_in_couch = Vector3(0.1, 0.1, 0.4),
                                   .normal_in_couch = Vector3::UnitY(),
                                   .force_n = 3.0});
  }
  file.plan.paths = {planned};
  return file;
}

bool accepts_session(std::string_view content) {
  const auto file = record::parse_session(content, "session.json");
  if (!file) return false;
  demand(record::parse_session(record::to_json(*file), "again").has_value(),
         "what is written can be read");
  return true;
}

record::SessionFile some_session() {
  record::SessionFile file{.person = "phantom:slim"};
  file.order.commands = {{3.5, session::LiveCommand::softer}};
  file.acupoints.points = {{{"GV4", Vector3(0.0, 0.1, 0.3), Vector3::UnitY(), 8_mm}, 2_mm}};
  file.massage.techniques = {{Technique::rub, 0.5, 16.0}};
  file.massage.performed = {{.name = "press GV4", .contact_fault = "none"}};
  file.tissue = {{.name = "GV4", .truth = TangentTissue{4.5, 250.0}}};
  file.changes = {{.name = "GV4", .before_n_per_mm = 3.0, .after_n_per_mm = 2.7}};
  file.stops = {{9.25, "left arm: the force is too large"}};
  return file;
}

bool accepts_touches(std::string_view content) {
  static const Folder folder;
  const auto touches =
      session::read_touches(folder.with("touches.csv", std::string(content)), robot::thesis_arm());
  if (!touches) return false;
  for (const robot::Touch& touch : *touches) {
    demand(touch.q_rad.allFinite() && touch.spot_in_couch.allFinite(), "numbers are finite");
    demand(std::abs(touch.normal_in_couch.norm() - 1.0) < 1e-9, "a normal is unit");
  }
  return true;
}

std::string some_touches() {
  robot::Touch touch{.q_rad = JointVector::Zero(robot::thesis_arm().joints)};
  touch.normal_in_couch = Vector3::UnitY();
  return session::to_csv(std::vector{touch, touch});
}

session::TaughtMotion some_motion() {
  session::TaughtMotion motion{.name = "to and fro", .line = {{3.0, 0.8}, {3.0, 0.1}}};
  for (int i = 0; i < 60; ++i) {
    motion.samples.push_back({.time_s = 0.01 * i,
                              .q_rad = JointVector::Zero(robot::thesis_arm().joints),
                              .force_n = 5.0});
  }
  return motion;
}

/// A taught motion is two files; what is spoilt is `name`, and the other is as it should be.
std::function<bool(std::string_view)> accepts_taught(const std::string& name) {
  return [name](std::string_view content) {
    static const Folder folder;
    demand(session::write_taught(some_motion(), folder / "fro.toml").has_value(), "written");
    (void)folder.with(name, std::string(content));
    const auto motion = session::read_taught(folder / "fro.toml");
    if (!motion) return false;
    demand(motion->samples.size() >= 50, "a motion has samples");
    for (const session::TaughtSample& sample : motion->samples) {
      demand(sample.q_rad.allFinite() && sample.force_n <= 60.0, "a sample can be played");
    }
    demand(motion->at(0.5 * motion->duration_s()).q_rad.allFinite(), "it goes somewhere");
    return true;
  };
}

std::string some_mcap() {
  std::string bytes;
  telemetry::mcap::Writer writer([&](std::string_view more) {
    bytes += more;
    return Result<void>();
  });
  const auto channel = writer.add_channel("/t", "json", {.name = "t", .encoding = "jsonschema"});
  for (std::uint64_t i = 0; i < 40; ++i) {
    demand(writer.write(channel, i * 100'000'000, R"({"i": 1})").has_value(), "written");
  }
  demand(writer.attach({.name = "a", .data = {"b"}}).has_value(), "written");
  demand(writer.finish().has_value(), "written");
  return bytes;
}

/// A damaged file gives what is whole of it; it is accepted where all is.
bool accepts_mcap(std::string_view content) {
  std::uint64_t seen = 0;
  const auto contents = telemetry::mcap::read(
      content, [&](const telemetry::mcap::Contents& file, const telemetry::mcap::Message& one) {
        ++seen;
        demand(file.channels.contains(one.channel_id), "a message has a channel");
      });
  if (!contents) return false;
  demand(contents->messages == seen, "messages are counted");
  return contents->lost.empty();
}

}  // namespace

std::vector<Parser> session_parsers() {
  std::vector<std::string> programmes;
  for (const auto& shipped : massage::shipped_programmes()) programmes.emplace_back(shipped.toml);
  std::vector<std::string> robots;
  for (const auto& shipped : robot::shipped_robots()) robots.emplace_back(shipped.toml);
  const Folder folder;
  demand(session::write_taught(some_motion(), folder / "fro.toml").has_value(), "written");
  const std::string motion = read_file(folder / "fro.toml").value_or("");
  const std::string samples = read_file(folder / "fro.csv").value_or("");
  return {{"programme", programmes, accepts_programme},
          {"no-go",
           {"[[no_go]]\nname = \"bruise\"\ncorners_m = [[0.05, 0.12, 0.40], [0.10, 0.11, 0.40], "
            "[0.10, 0.11, 0.45]]\n"},
           accepts_no_go},
          {"consent", {session::consent_form("P. Smith", "no")}, accepts_consent},
          {"config", {session::to_toml(session::Config{})}, accepts_config},
          {"robot.toml", {session::to_toml(session::PlacedRobot{})}, accepts_robot_pose},
          {"robot table", robots, accepts_robot},
          {"urdf",
           {robot::to_urdf(robot::describe(robot::mount_for(BodyPosture::sitting),
                                           {.of = {robot::thesis_arm(), robot::thesis_arm()}}))},
           accepts_urdf},
          {"plan.json", {record::to_json(some_plan())}, accepts_plan},
          {"session.json", {record::to_json(some_session())}, accepts_session},
          {"mcap", {some_mcap()}, accepts_mcap},
          {"touches.csv", {some_touches()}, accepts_touches},
          {"taught.toml", {motion}, accepts_taught("fro.toml")},
          {"taught.csv", {samples}, accepts_taught("fro.csv")}};
}

}  // namespace tuina::test
