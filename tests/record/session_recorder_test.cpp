// SPDX-License-Identifier: Apache-2.0
#include "tuina/record/session_recorder.hpp"

#include <doctest/doctest.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <cstdlib>
#include <map>
#include <nlohmann/json.hpp>
#include <thread>

#include "tests/folder.hpp"
#include "tests/reason.hpp"
#include "tests/record/told_session.hpp"
#include "tuina/core/random.hpp"
#include "tuina/record/session_folder.hpp"
#include "tuina/robot/arm_model.hpp"
#include "tuina/session/relay.hpp"
#include "tuina/telemetry/mcap/cdr.hpp"

using namespace tuina;
using namespace tuina::record;
using nlohmann::json;
using test::tell_beginning;
using test::tick_at;
namespace mcap = telemetry::mcap;

namespace {

const robot::RobotModel& recorded_robot() {
  static const robot::RobotModel model = robot::load_robot("thesis").value();
  return model;
}

std::unique_ptr<SessionRecorder> recorder_for(const std::filesystem::path& file) {
  auto recorder = SessionRecorder::begin(file,
                                         {.seed = 7,
                                          .version = "0",
                                          .order = {.person = "somebody \xff"},
                                          .answered_by = "somebody",
                                          .robot = recorded_robot()},
                                         {{"config.toml", "[scan]\n"}});
  REQUIRE_MESSAGE(recorder.has_value(), test::reason(recorder));
  return std::move(*recorder);
}

struct Read {
  mcap::Contents contents;
  std::map<std::string, std::vector<std::string>> of;  ///< messages by topic
  std::map<std::string, std::vector<std::uint64_t>> at_ns;
};

Read read_back(const std::filesystem::path& file) {
  Read all;
  auto record =
      read_record_file(file, [&](const mcap::Contents& contents, const mcap::Message& message) {
        const std::string& topic = contents.channels.at(message.channel_id).topic;
        all.of[topic].emplace_back(message.data);
        all.at_ns[topic].push_back(message.log_time_ns);
      });
  REQUIRE_MESSAGE(record.has_value(), test::reason(record));
  all.contents = std::move(record->contents);
  return all;
}

}  // namespace

TEST_CASE(
    "every millisecond of both arms is in the record, to the steps that docs/record.md states") {
  const test::Folder folder;
  constexpr std::uint64_t count = 2500;
  const auto recorder = recorder_for(folder / "session.mcap");
  for (int line = 0; line < 3; ++line)  // the middle one has seen nothing
    recorder->on_profile(
        {.number = line, .points_in_couch = std::vector<Vector3>(line == 1 ? 0 : 2)});
  tell_beginning(*recorder);
  for (std::uint64_t ms = 0; ms < count; ++ms) recorder->on_tick(tick_at(ms));
  REQUIRE(recorder->finish(count - 1).has_value());
  CHECK(recorder->missing_ms() == 0);

  const Read read = read_back(folder / "session.mcap");
  CHECK(read.contents.lost.empty());
  REQUIRE(read.of.at("/joint_states").size() == count);
  REQUIRE(read.of.at("/tools").size() == count);
  CHECK(read.of.at("/profile").size() == 2);
  CHECK(read.of.at("/scan").size() == 1);
  CHECK(read.of.at("/acupoints").size() == 1);
  CHECK(read.contents.attachment("robot.urdf") != nullptr);
  CHECK(read.contents.attachment("config.toml")->data.bytes == "[scan]\n");

  const auto stand = robot::place_robot(recorded_robot(), BodyPosture::sitting, true);
  const auto models = robot::both_models(stand.arm, stand.mount);
  for (std::uint64_t ms = 0; ms < count; ms += 100) {
    CAPTURE(ms);
    const session::Tick tick = tick_at(ms);
    CHECK(read.at_ns.at("/joint_states")[ms] == ms * 1'000'000);
    const auto joints = ros::from_cdr<ros::JointState>(read.of.at("/joint_states")[ms]).value();
    REQUIRE(joints.name.size() == 13);
    CHECK(joints.name[0] == "rail_joint");
    const auto tools = ros::from_cdr<ros::MultiDOFJointState>(read.of.at("/tools")[ms]).value();
    for (const Arm arm : both_arms) {
      const auto& seen = tick.reading.arms[arm];
      const std::size_t first = arm == Arm::left ? 1 : 7;
      CHECK(std::abs(joints.position[first] - seen.q_rad[0]) <= 0x1p-14);
      CHECK(std::abs(joints.velocity[first] - seen.dq_rad_per_s[0]) <= 0x1p-6);
      CHECK(std::abs(joints.effort[first] - tick.verdict.command.torque_nm[arm][0]) <= 0x1p-3);
      const auto a = static_cast<std::size_t>(arm);
      CHECK(std::abs(tools.wrench[a].force.x - seen.wrench_in_tool.force_n.x()) <= 0x1p-4);
      const Transform pose = models[arm].base_from_tool(seen.q_rad, 0.0);
      const auto& at = tools.transforms[a].translation;
      CHECK((Vector3(at.x, at.y, at.z) - pose.translation()).cwiseAbs().maxCoeff() <= 0x1p-12);
      const auto& q = tools.transforms[a].rotation;
      const Eigen::Quaterniond turned(q.w, q.x, q.y, q.z);
      CHECK(turned.angularDistance(Eigen::Quaterniond(pose.linear())) < 2e-3);
    }
  }
}

TEST_CASE("the frames of the record lead from the base to the tool as the arm does") {
  const test::Folder folder;
  const auto recorder = recorder_for(folder / "session.mcap");
  tell_beginning(*recorder);
  recorder->on_tick(tick_at(0));
  REQUIRE(recorder->finish(0).has_value());
  const Read read = read_back(folder / "session.mcap");
  std::map<std::string, std::pair<std::string, Transform>> parents;
  for (const char* topic : {"/tf", "/tf_static"}) {
    const auto message = ros::from_cdr<ros::TFMessage>(read.of.at(topic).front()).value();
    for (const ros::TransformStamped& one : message.transforms) {
      const auto& t = one.transform.translation;
      const auto& q = one.transform.rotation;
      parents[one.child_frame_id] = {one.header.frame_id,
                                     Eigen::Translation3d(t.x, t.y, t.z) *
                                         Eigen::Quaterniond(q.w, q.x, q.y, q.z).normalized()};
    }
  }
  const auto tools = ros::from_cdr<ros::MultiDOFJointState>(read.of.at("/tools").front()).value();
  for (std::size_t arm = 0; arm < 2; ++arm) {
    Transform base_from_tool = Transform::Identity();
    std::string frame = RobotMessages::tool_frames[arm];
    for (int hops = 0; frame != "base"; ++hops) {
      CAPTURE(frame);
      REQUIRE(parents.contains(frame));
      REQUIRE(hops < 20);
      base_from_tool = parents[frame].second * base_from_tool;
      frame = parents[frame].first;
    }
    const auto& at = tools.transforms[arm].translation;
    CHECK((base_from_tool.translation() - Vector3(at.x, at.y, at.z)).norm() < 3e-3);
  }
  CHECK(parents.at("couch").first == "base");
}

TEST_CASE("what happens is told on the channels of its kind, with the names of the plan") {
  const test::Folder folder;
  const auto recorder = recorder_for(folder / "session.mcap");
  tell_beginning(*recorder);
  for (std::uint64_t ms = 0; ms < 100; ++ms) {
    session::Tick tick = tick_at(ms);
    tick.view[Arm::left].path = 0;
    if (ms == 10) tick.commanded = session::LiveCommand::softer;
    if (ms == 20) tick.decided = {.time_s = 0.02, .rule = "A3", .reason = "hard", .to_n = 5.0};
    if (ms == 30) {
      tick.ended = {.path = 0, .begin_s = 0.01, .end_s = 0.03};
      tick.ended->felt = TissueEstimate{.tissue = {4.0, 250.0}, .presses = 2};
    }
    if (ms == 40) tick.stopped = {.time_s = 0.04, .cause = safety::Cause::asked_to};
    if (ms >= 40) tick.verdict.arms[Arm::left].action = safety::Action::retract;
    recorder->on_tick(tick);
  }
  REQUIRE(recorder->finish(99).has_value());
  const Read read = read_back(folder / "session.mcap");
  const auto only = [&](const std::string& topic) {
    CAPTURE(topic);
    REQUIRE(read.of.contains(topic));
    REQUIRE(read.of.at(topic).size() == 1);
    return json::parse(read.of.at(topic).front());
  };
  CHECK(only("/tuina/order")["seed"] == 7);
  CHECK(only("/tuina/consent")["answered_by"] == "somebody");
  CHECK(only("/tuina/plan")["programme"] == "one press");
  CHECK(only("/tuina/commands")["command"] == "softer");
  CHECK(only("/tuina/decisions")["path"] == "press GV4");
  CHECK(only("/tuina/contacts")["end_s"] == 0.03);
  CHECK(only("/tuina/tissue")["presses"] == 2);
  CHECK(only("/tuina/stops")["cause"] == "asked to stop");
  CHECK(only("/tuina/guard")["action"] == safety::name_of(safety::Action::retract));
  const auto& arms = read.of.at("/tuina/arms");
  CHECK(json::parse(arms.front())["path"] == "press GV4");
  // The schema of each channel names every key of its messages, and no other.
  for (const auto& [id, channel] : read.contents.channels) {
    if (channel.message_encoding != "json") continue;
    CAPTURE(channel.topic);
    const json schema = json::parse(read.contents.schemas.at(channel.schema_id).data);
    const json event = json::parse(read.of.at(channel.topic).front());
    CHECK(schema["type"] == "object");
    CHECK(schema["properties"].size() == event.size());
    for (const auto& [key, value] : event.items()) CHECK(schema["properties"].contains(key));
  }
}

TEST_CASE("milliseconds that did not come are counted and said, also those at the end") {
  const test::Folder folder;
  const auto recorder = recorder_for(folder / "session.mcap");
  tell_beginning(*recorder);
  for (const std::uint64_t ms : {0, 1, 2, 6, 7}) recorder->on_tick(tick_at(ms));
  REQUIRE(recorder->finish(9).has_value());
  CHECK(recorder->missing_ms() == 5);
  const Read read = read_back(folder / "session.mcap");
  REQUIRE(read.of.at("/tuina/gaps").size() == 2);
  CHECK(json::parse(read.of.at("/tuina/gaps")[0])["missing_ms"] == 3);
  CHECK(json::parse(read.of.at("/tuina/gaps")[1])["missing_ms"] == 2);
}

TEST_CASE("a process that is killed costs its record a second at most") {
  // Twenty kills, or as many as TUINA_KILLS says, at random moments; the clock runs ten times as
  // fast as real.
  const char* asked = std::getenv("TUINA_KILLS");
  const int kills = asked != nullptr ? std::stoi(asked) : 20;
  Random random = make_random(1, "kills");
  const test::Folder folder;
  void* shared = ::mmap(nullptr, sizeof(std::atomic<std::uint64_t>), PROT_READ | PROT_WRITE,
                        MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  REQUIRE(shared != MAP_FAILED);
  auto& told = *new (shared) std::atomic<std::uint64_t>(0);
  std::uint64_t worst_ms = 0;
  for (int kill = 0; kill < kills; ++kill) {
    CAPTURE(kill);
    const std::filesystem::path file = folder / std::to_string(kill);
    told = 0;
    const ::pid_t child = ::fork();
    REQUIRE(child >= 0);
    if (child == 0) {
      const auto recorder = recorder_for(file);
      session::Relay relay(*recorder);
      tell_beginning(relay);
      auto next = std::chrono::steady_clock::now();
      for (std::uint64_t ms = 0;; ++ms) {
        relay.on_tick(tick_at(ms));
        told = ms + 1;
        std::this_thread::sleep_until(next += std::chrono::microseconds(100));
      }
    }
    const double until_ms = uniform(random, 200.0, 8000.0);
    while (static_cast<double>(told) < until_ms)
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    ::kill(child, SIGKILL);
    int status = 0;
    ::waitpid(child, &status, 0);
    const std::uint64_t given = told;
    const Read read = read_back(file.string() + ".part");
    const auto kept = read.of.find("/joint_states");
    CHECK_FALSE(read.contents.lost.empty());
    // Before the first chunk has ended nothing is kept.
    worst_ms = std::max(worst_ms, given - (kept == read.of.end() ? 0 : kept->second.size()));
  }
  ::munmap(shared, sizeof(std::atomic<std::uint64_t>));
  // The chunk that was open, and ten times of what the relay had not passed on: its thread sleeps
  // in real time.
  constexpr std::uint64_t chunk_ms = 900, relay_ms = 100;
  MESSAGE("at most ", worst_ms, " ms were lost in ", kills, " kills, at ten times the pace");
  CHECK(worst_ms <= chunk_ms + 10 * relay_ms);
}

TEST_CASE("the files in a record come out as they went in, and only as files of the folder") {
  const test::Folder folder;
  const auto file_with = [&](const std::string& name, const std::string& content) {
    const auto recorder = recorder_for(folder / "session.mcap");
    tell_beginning(*recorder);
    recorder->on_tick(tick_at(0));
    const std::filesystem::path files[] = {folder.with("session.json", "{}"),
                                           folder.with(name, content), folder / "not there"};
    REQUIRE(recorder->finish(0, files).has_value());
    return folder / "session.mcap";
  };
  const std::string table = "time_s,a\n" + std::string(3000, '1') + "\n";
  std::filesystem::path unpacked;
  {
    const auto session = SessionFolder::open(file_with("trace.csv", table));
    REQUIRE_MESSAGE(session.has_value(), test::reason(session));
    unpacked = session->path();
    CHECK(read_file(unpacked / "trace.csv").value() == table);
    CHECK(read_file(unpacked / "session.json").value() == "{}");
    CHECK_FALSE(std::filesystem::exists(unpacked / "not there"));
    const Error error{Fault::bad_input, (unpacked / "trace.csv").string() + ":3: bad"};
    CHECK(session->explained(error).message == folder / "session.mcap" + ":trace.csv:3: bad");
  }
  CHECK_FALSE(std::filesystem::exists(unpacked));

  // A record from elsewhere may call its attachments as it likes.
  std::string bytes;
  mcap::Writer writer([&](std::string_view more) {
    bytes += more;
    return Result<void>();
  });
  mcap::Compressor compressor(mcap::texts);
  REQUIRE(writer.attach({.name = "session.json.zst", .data = {compressor.compress("{}")}}));
  REQUIRE(writer.attach({.name = "../escaped", .data = {"x"}}));
  REQUIRE(writer.finish());
  const auto escaped = SessionFolder::open(folder.with("foreign.mcap", bytes));
  REQUIRE_FALSE(escaped.has_value());
  CHECK(escaped.error().message.find("`../escaped` is no name of a file") != std::string::npos);
}

TEST_CASE("a record that cannot be written says so at its end, and leaves nothing") {
  CHECK_FALSE(SessionRecorder::begin("/no/such/folder/session.mcap", {}).has_value());
  const auto recorder = recorder_for("/dev/full");
  tell_beginning(*recorder);
  for (std::uint64_t ms = 0; ms < 3000; ++ms) recorder->on_tick(tick_at(ms));
  const auto finished = recorder->finish(2999);
  REQUIRE_FALSE(finished.has_value());
  CHECK(finished.error().fault == Fault::file);
  CHECK(finished.error().message.find("/dev/full") != std::string::npos);
}

TEST_CASE("a millisecond that cannot be told is counted as missing, and the session goes on") {
  struct FullSink final : ChannelSink {
    bool full = false;
    std::uint16_t add_channel(const ChannelDescription&) override { return 1; }
    void write(std::uint16_t, std::uint64_t, std::string_view) override {
      if (full) throw std::runtime_error("no room");
    }
  } sink;
  SessionChannels channels(sink, {.robot = recorded_robot()});
  tell_beginning(channels);
  channels.on_tick(tick_at(0));
  sink.full = true;
  for (std::uint64_t ms = 1; ms <= 3; ++ms) channels.on_tick(tick_at(ms));
  sink.full = false;
  channels.on_tick(tick_at(4));
  CHECK(channels.ticks() == 2);
  CHECK(channels.missing_ms() == 3);
}
