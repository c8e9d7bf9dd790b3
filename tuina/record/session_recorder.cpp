// SPDX-License-Identifier: Apache-2.0
#include "tuina/record/session_recorder.hpp"

#include "tuina/record/event_fields.hpp"
#include "tuina/session/run.hpp"
#include "tuina/telemetry/mcap/cdr.hpp"
#include "tuina/telemetry/mcap/ros_schema.hpp"

namespace tuina::record {
namespace {

namespace mcap = telemetry::mcap;

// With what a relay still holds, a crash then costs no more than a second.
constexpr std::uint64_t max_chunk_ns = 900'000'000;

// Viewers draw poses, frames and the state of an arm no faster.
constexpr std::uint64_t shown_every_ticks = 80;
constexpr std::uint64_t state_every_ticks = 50;

/// What rosbag2 offers to subscribers: a latched topic goes to those that come later, too. The
/// numbers are those of rmw/types.h.
std::string qos(bool latched) {
  if (!latched) return "";
  return "- history: 1\n  depth: 1\n  reliability: 1\n  durability: 1\n"
         "  deadline:\n    sec: 0\n    nsec: 0\n  lifespan:\n    sec: 0\n    nsec: 0\n"
         "  liveliness: 0\n  liveliness_lease_duration:\n    sec: 0\n    nsec: 0\n"
         "  avoid_ros_namespace_conventions: false";
}

bool is_compressed(const std::string& name) {
  for (const char* ending : {".csv", ".json", ".ply", ".svg"})
    if (name.ends_with(ending)) return true;
  return false;
}

const char* media_type_of(const std::string& name) {
  constexpr std::pair<const char*, const char*> types[] = {{".zst", "application/zstd"},
                                                           {".html", "text/html"},
                                                           {".toml", "application/toml"},
                                                           {".urdf", "application/xml"}};
  for (const auto& [ending, type] : types)
    if (name.ends_with(ending)) return type;
  return "application/octet-stream";
}

}  // namespace

Result<std::unique_ptr<SessionRecorder>> SessionRecorder::begin(const std::filesystem::path& file,
                                                                const SessionStart& start) {
  auto opened = FileWriter::open(file);
  if (!opened) return tl::unexpected(opened.error());
  return std::unique_ptr<SessionRecorder>(new SessionRecorder(std::move(*opened), start));
}

SessionRecorder::SessionRecorder(FileWriter file, const SessionStart& start)
    : file_(std::move(file)),
      writer_([this](std::string_view bytes) { return file_.append(bytes); },
              {.library = "tuina " + start.version, .max_chunk_ns = max_chunk_ns}),
      robot_model_(start.robot) {
  keep(writer_.add_metadata(
      {.name = "tuina",
       .metadata = {
           {"version", start.version},
           {"seed", fmt::format("{}", start.seed)},
           {"clock", "time of the session, zero at the first millisecond of the robot"}}}));
  tell(channels_.order,
       OrderEvent{.seed = start.seed, .version = start.version, .order = start.order}, 0.0);
  tell(channels_.consent, ConsentEvent{.answered_by = start.answered_by}, 0.0);
  for (const auto& [name, content] : start.attached) attach(name, content);
}

void SessionRecorder::keep(Result<void> done) {
  if (state_ && !done) state_ = std::move(done);
}

template <typename Message>
void SessionRecorder::tell(std::uint16_t& channel, const char* topic, const Message& message,
                           double time_s, bool latched) {
  if (channel == 0) {
    channel = writer_.add_channel(topic, "cdr", ros::schema_of<Message>(),
                                  {{"offered_qos_profiles", qos(latched)}});
  }
  ros::to_cdr(message, bytes_);
  keep(writer_.write(channel, to_ns(time_s), bytes_));
}

template <typename Event>
void SessionRecorder::tell(std::uint16_t& channel, const Event& event, double time_s) {
  if (channel == 0) {
    SchemaWriter schema;
    Event::fields(schema, event);
    std::string name = Event::topic + 1;  // without the first slash
    name[name.find('/')] = '.';
    channel = writer_.add_channel(
        Event::topic, "json",
        {.name = std::move(name), .encoding = "jsonschema", .data = schema.schema().dump()});
  }
  keep(writer_.write(channel, to_ns(time_s),
                     to_json(event, Event::fields)
                         .dump(-1, ' ', false, SchemaWriter::Json::error_handler_t::replace)));
}

void SessionRecorder::on_scan(const scanner::Scan& scan) {
  tell(channels_.scan, "/scan", cloud_message(time_s_, scan.cloud_in_couch), time_s_, true);
}

void SessionRecorder::on_map(const body::Mapping& map) {
  tell(channels_.acupoints, "/acupoints", acupoint_markers(time_s_, map.acupoints), time_s_, true);
  if (robot_) return;
  robot_.emplace(
      robot::place_robot(robot_model_, map.position, session::head_at_plus_y(map.acupoints)));
  const std::string urdf = robot::to_urdf(robot_->description());
  tell(channels_.urdf, "/robot_description", ros::String{.data = urdf}, time_s_, true);
  attach("robot.urdf", urdf);
}

void SessionRecorder::on_plan(const motion::ReadyPlan& plan, const Transform& base_from_couch) {
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
       time_s_);
}

void SessionRecorder::on_tick(const session::Tick& tick) noexcept {
  if (!robot_ || !state_) return;
  const robot::RobotReading& reading = tick.reading;
  const double time_s = time_s_ = reading.time_s;
  if (ticks_ > 0) tell_gap(reading.tick);
  last_tick_ = reading.tick;
  tell(channels_.joints, "/joint_states", robot_->joints(reading, tick.verdict.command), time_s);
  tell(channels_.tools, "/tools", robot_->tools(reading), time_s);
  if (ticks_ % shown_every_ticks == 0) {
    tell(channels_.parts, "/tf", robot_->parts(reading), time_s);
    for (const Arm arm : both_arms) {
      const bool left = arm == Arm::left;
      tell(channels_.wrench[arm], left ? "/left/wrench" : "/right/wrench",
           robot_->wrench(reading, arm), time_s);
      tell(channels_.pose[arm], left ? "/left/pose" : "/right/pose", robot_->pose(reading, arm),
           time_s);
    }
  }
  if (ticks_ % state_every_ticks == 0) tell_arms(tick);
  tell_guard(tick);
  tell_events(tick);
  ++ticks_;
}

void SessionRecorder::tell_gap(std::uint64_t next_tick) {
  if (next_tick <= last_tick_ + 1) return;
  const std::uint64_t missing = next_tick - last_tick_ - 1;
  missing_ms_ += missing;
  tell(channels_.gaps, GapEvent{.missing_ms = missing}, time_s_);
}

SessionRecorder::PathName SessionRecorder::name_of_path(int index) const {
  const auto i = static_cast<std::size_t>(index);
  return index >= 0 && i < paths_.size() ? paths_[i] : PathName();
}

void SessionRecorder::tell_arms(const session::Tick& tick) {
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

void SessionRecorder::tell_guard(const session::Tick& tick) {
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

void SessionRecorder::tell_events(const session::Tick& tick) {
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
    if (done.felt)
      tell(channels_.tissue, TissueEvent{.path = name_of_path(done.path).path, .felt = *done.felt},
           time_s);
  }
  if (tick.decided) {
    const session::Decision& made = *tick.decided;
    tell(channels_.decisions,
         DecisionEvent{{.time_s = made.time_s,
                        .arm = made.arm,
                        .path = name_of_path(made.path).path,
                        .rule = made.rule,
                        .reason = made.reason,
                        .from_n = made.from_n,
                        .to_n = made.to_n}},
         time_s);
  }
  if (tick.stopped) {
    tell(channels_.stops,
         StopEvent{{.time_s = tick.stopped->time_s, .cause = session::explain(*tick.stopped)}},
         time_s);
  }
}

void SessionRecorder::attach(const std::string& name, std::string_view content) {
  mcap::Compressor compressor(mcap::texts);
  const bool compressed = is_compressed(name);
  const std::string called = compressed ? name + ".zst" : name;
  keep(writer_.attach({.log_time_ns = to_ns(time_s_),
                       .name = called,
                       .media_type = media_type_of(called),
                       .data = {compressed ? compressor.compress(content) : content}}));
}

Result<void> SessionRecorder::finish(std::uint64_t last_tick,
                                     std::span<const std::filesystem::path> attached) {
  constexpr std::size_t max_bytes = std::size_t{1} << 30;
  if (ticks_ > 0) tell_gap(last_tick + 1);
  for (const std::filesystem::path& path : attached) {
    std::error_code none;
    if (!std::filesystem::exists(path, none)) continue;
    const auto content = read_file(path, max_bytes);
    if (!content) return tl::unexpected(content.error());
    attach(path.filename().string(), *content);
  }
  keep(writer_.finish());
  return state_ ? file_.finish() : state_;
}

}  // namespace tuina::record
