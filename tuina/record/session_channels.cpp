// SPDX-License-Identifier: Apache-2.0
#include "tuina/record/session_channels.hpp"

#include "tuina/record/event_fields.hpp"
#include "tuina/session/run.hpp"
#include "tuina/telemetry/mcap/cdr.hpp"
#include "tuina/telemetry/mcap/ros_schema.hpp"

namespace tuina::record {
namespace {

// Viewers draw poses, frames and the state of an arm no faster.
constexpr std::uint64_t shown_every_ticks = 80;
constexpr std::uint64_t state_every_ticks = 50;
constexpr const char *profile_topic = "/profile", *scan_topic = "/scan";

}  // namespace

ScanChannels::ScanChannels(ChannelSink& sink)
    : sink_(sink),
      profile_(sink.add_channel({.topic = profile_topic,
                                 .encoding = "cdr",
                                 .schema = ros::schema_of<ros::PointCloud2>()})),
      scan_(sink.add_channel({.topic = scan_topic,
                              .encoding = "cdr",
                              .schema = ros::schema_of<ros::PointCloud2>(),
                              .latched = true})) {}

void ScanChannels::tell(const scanner::LiveProfile& profile) {
  if (!profile.points_in_couch.empty()) write(profile_, {.points = profile.points_in_couch});
}

void ScanChannels::tell(const scanner::Scan& scan) {
  write(scan_, scan.cloud_in_couch);
}

void ScanChannels::write(std::uint16_t channel, const PointCloud& cloud_in_couch) {
  std::string bytes;
  ros::to_cdr(cloud_message(0.0, cloud_in_couch), bytes);
  sink_.write(channel, 0, bytes);
}

SessionChannels::SessionChannels(ChannelSink& sink, const SessionStart& start)
    : sink_(sink), robot_model_(start.robot), diagnostics_(start.robot.name) {
  tell(channels_.order,
       OrderEvent{.seed = start.seed, .version = start.version, .order = start.order}, 0.0, true);
  tell(channels_.consent, ConsentEvent{.answered_by = start.answered_by}, 0.0, true);
}

template <typename Message>
void SessionChannels::tell(std::uint16_t& channel, const char* topic, const Message& message,
                           double time_s, bool latched) {
  if (channel == 0) {
    channel = sink_.add_channel({.topic = topic,
                                 .encoding = "cdr",
                                 .schema = ros::schema_of<Message>(),
                                 .latched = latched});
  }
  ros::to_cdr(message, bytes_);
  sink_.write(channel, to_ns(time_s), bytes_);
}

template <typename Event>
void SessionChannels::tell(std::uint16_t& channel, const Event& event, double time_s,
                           bool latched) {
  if (channel == 0) {
    SchemaWriter schema;
    Event::fields(schema, event);
    std::string name = Event::topic + 1;  // without the first slash
    name[name.find('/')] = '.';
    channel = sink_.add_channel({.topic = Event::topic,
                                 .encoding = "json",
                                 .schema = {.name = std::move(name),
                                            .encoding = "jsonschema",
                                            .data = schema.schema().dump()},
                                 .latched = latched});
  }
  sink_.write(channel, to_ns(time_s),
              to_json(event, Event::fields)
                  .dump(-1, ' ', false, SchemaWriter::Json::error_handler_t::replace));
}

void SessionChannels::on_profile(const scanner::LiveProfile& profile) {
  if (profile.points_in_couch.empty()) return;
  tell(channels_.profile, profile_topic,
       cloud_message(time_s_, {.points = profile.points_in_couch}), time_s_);
}

void SessionChannels::on_scan(const scanner::Scan& scan) {
  tell(channels_.scan, scan_topic, cloud_message(time_s_, scan.cloud_in_couch), time_s_, true);
  diagnostics_.note_scan(scan);
}

void SessionChannels::on_map(const body::Mapping& map) {
  tell(channels_.acupoints, "/acupoints", acupoint_markers(time_s_, map.acupoints), time_s_, true);
  if (robot_) return;
  const auto placement =
      robot::place_robot(robot_model_, map.position, session::head_at_plus_y(map.acupoints));
  robot_.emplace(placement);
  diagnostics_.note_place(placement);
  urdf_ = robot::to_urdf(robot_->description());
  tell(channels_.urdf, "/robot_description", ros::String{.data = urdf_}, time_s_, true);
}

void SessionChannels::on_plan(const motion::ReadyPlan& plan, const Transform& base_from_couch) {
  paths_.clear();
  for (const massage::PlannedPath& one : plan.plan.paths)
    paths_.push_back({one.path.name, name_of(one.path.technique)});
  tell(channels_.plan, "/plan", plan_markers(time_s_, plan.plan), time_s_, true);
  if (robot_)
    tell(channels_.still, "/tf_static", robot_->still(time_s_, base_from_couch), time_s_, true);
  tell(channels_.planned,
       PlanEvent{.programme = plan.plan.programme,
                 .paths = plan.plan.paths.size(),
                 .duration_s = plan.plan.duration_s,
                 .notes = plan.plan.notes},
       time_s_, true);
}

void SessionChannels::on_tick(const session::Tick& tick) noexcept {
  if (!robot_) return;
  // What is lost must not end the session.
  try {
    tell(tick);
  } catch (const std::exception&) {
    ++missing_ms_;
  }
}

void SessionChannels::tell(const session::Tick& tick) {
  const robot::RobotReading& reading = tick.reading;
  const double time_s = time_s_ = reading.time_s;
  tell_gap(reading.tick);
  last_tick_ = reading.tick;
  tell(channels_.joints, "/joint_states", robot_->joints(reading, tick.verdict.command), time_s);
  tell(channels_.tools, "/tools", robot_->tools(reading), time_s);
  if (ticks_ % shown_every_ticks == 0) {
    tell(channels_.parts, "/tf", robot_->parts(reading), time_s);
    for (const Arm arm : both_arms) {
      const bool left = arm == Arm::left;
      tell(channels_.wrench[arm], left ? "/left/wrench" : "/right/wrench", robot_->wrench(arm),
           time_s);
      tell(channels_.pose[arm], left ? "/left/pose" : "/right/pose", robot_->pose(arm), time_s);
    }
  }
  if (ticks_ % state_every_ticks == 0) tell_arms(tick);
  tell_guard(tick);
  tell_events(tick);
  if (const ros::DiagnosticArray* due = diagnostics_.look(tick, missing_ms_))
    tell(channels_.diagnostics, "/diagnostics", *due, time_s);
  ++ticks_;
}

void SessionChannels::tell_gap(std::uint64_t next_tick) {
  if (ticks_ == 0 || next_tick <= last_tick_ + 1) return;
  const std::uint64_t missing = next_tick - last_tick_ - 1;
  missing_ms_ += missing;
  tell(channels_.gaps, GapEvent{.missing_ms = missing}, time_s_);
}

SessionChannels::PathName SessionChannels::name_of_path(int index) const {
  const auto i = static_cast<std::size_t>(index);
  return index >= 0 && i < paths_.size() ? paths_[i] : PathName();
}

void SessionChannels::tell_arms(const session::Tick& tick) {
  for (const Arm arm : both_arms) {
    const session::ArmView& view = tick.view[arm];
    const PathName served = name_of_path(view.path);
    tell(channels_.arms,
         ArmEvent{.arm = arm,
                  .phase = name_of(view.phase),
                  .path = served.path,
                  .technique = served.technique,
                  .target_n = view.target_n,
                  .measured_n = view.measured_n},
         tick.reading.time_s);
  }
}

void SessionChannels::tell_guard(const session::Tick& tick) {
  for (const Arm arm : both_arms) {
    const safety::Verdict& verdict = tick.verdict.arms[arm];
    if (verdict.action == action_[arm] && verdict.cause == cause_[arm]) continue;
    action_[arm] = verdict.action;
    cause_[arm] = verdict.cause;
    tell(channels_.guard,
         GuardEvent{.arm = arm,
                    .action = safety::name_of(verdict.action),
                    .cause = safety::name_of(verdict.cause),
                    .latched = verdict.latched},
         tick.reading.time_s);
  }
}

void SessionChannels::tell_events(const session::Tick& tick) {
  const double time_s = tick.reading.time_s;
  if (tick.commanded) tell(channels_.commands, CommandEvent{.command = *tick.commanded}, time_s);
  if (tick.ended) {
    const session::Performed& done = *tick.ended;
    tell(channels_.contacts,
         ContactEvent{.path = name_of_path(done.path).path,
                      .arm = done.arm,
                      .begin_s = done.begin_s,
                      .end_s = done.end_s,
                      .contact_fault = control::name_of(done.contact_fault),
                      .whole = done.whole},
         time_s);
    if (done.felt) {
      const TissueEvent felt{.path = name_of_path(done.path).path, .felt = *done.felt};
      tell(channels_.tissue, felt, time_s);
      diagnostics_.note_tissue(felt);
    }
  }
  if (tick.decided) {
    const session::Decision& made = *tick.decided;
    const DecisionEvent decision{{.time_s = made.time_s,
                                  .arm = made.arm,
                                  .path = name_of_path(made.path).path,
                                  .rule = made.rule,
                                  .reason = made.reason,
                                  .key = made.key,
                                  .from_n = made.from_n,
                                  .to_n = made.to_n}};
    tell(channels_.decisions, decision, time_s);
    diagnostics_.note_decision(decision);
  }
  if (tick.stopped) {
    tell(channels_.stops,
         StopEvent{{.time_s = tick.stopped->time_s, .cause = session::explain(*tick.stopped)}},
         time_s);
  }
}

}  // namespace tuina::record
