// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "tuina/core/io/file.hpp"
#include "tuina/record/session_file.hpp"
#include "tuina/record/session_messages.hpp"
#include "tuina/session/observer.hpp"
#include "tuina/telemetry/mcap/writer.hpp"

namespace tuina::record {

/// What a record says before anything has happened.
struct SessionStart {
  std::uint64_t seed = 1;
  std::string version;
  SessionOrder order;
  std::string answered_by;  ///< who answered the health questions
  robot::RobotModel robot;
  std::vector<std::pair<std::string, std::string>> attached = {};  ///< files: name, content
};

/// Writes session.mcap while the session runs (docs/record.md): joints, tools and their wrenches
/// each millisecond, scan, acupoints, plan, and what happens. It takes a microsecond here and a
/// write to a disk there, so it belongs behind a `Relay`. Until `finish` the file is called
/// session.mcap.part; a crash costs a second at most.
class SessionRecorder final : public session::Observer {
 public:
  [[nodiscard]] static Result<std::unique_ptr<SessionRecorder>> begin(
      const std::filesystem::path& file, const SessionStart& start);

  void on_scan(const scanner::Scan& scan) override;
  void on_map(const body::Mapping& map) override;
  void on_plan(const motion::ReadyPlan& plan, const Transform& base_from_couch) override;
  void on_tick(const session::Tick& tick) noexcept override;

  /// Milliseconds that were recorded, and those between them that were not.
  [[nodiscard]] std::uint64_t ticks() const { return ticks_; }
  [[nodiscard]] std::uint64_t missing_ms() const { return missing_ms_; }

  /// Attaches these files, those that exist, and closes the record of a session whose last
  /// millisecond was `last_tick`. Large tables and texts are attached as zstd frames with `.zst`
  /// behind their names. Fails with the first thing that went wrong since `begin`; then there is no
  /// record.
  [[nodiscard]] Result<void> finish(std::uint64_t last_tick,
                                    std::span<const std::filesystem::path> attached = {});

 private:
  SessionRecorder(FileWriter file, const SessionStart& start);

  struct PathName {
    std::string path, technique;
  };

  template <typename Message>
  void tell(std::uint16_t& channel, const char* topic, const Message& message, double time_s,
            bool latched = false);
  template <typename Event>
  void tell(std::uint16_t& channel, const Event& event, double time_s);
  void tell_events(const session::Tick& tick);
  void tell_guard(const session::Tick& tick);
  void tell_arms(const session::Tick& tick);
  /// Says which milliseconds are missing before that one.
  void tell_gap(std::uint64_t next_tick);
  void attach(const std::string& name, std::string_view content);
  void keep(Result<void> done);
  [[nodiscard]] PathName name_of_path(int index) const;

  /// Channels are added when their first message comes; 0: not yet.
  struct Channels {
    std::uint16_t joints = 0, tools = 0, parts = 0, still = 0, scan = 0, acupoints = 0, plan = 0,
                  urdf = 0;
    PerArm<std::uint16_t> wrench = {}, pose = {};
    std::uint16_t order = 0, consent = 0, planned = 0, arms = 0, contacts = 0, tissue = 0,
                  decisions = 0, stops = 0, commands = 0, guard = 0, gaps = 0;
  };

  FileWriter file_;
  telemetry::mcap::Writer writer_;
  robot::RobotModel robot_model_;
  Channels channels_;
  Result<void> state_ = {};  ///< the first thing that went wrong
  std::optional<RobotMessages> robot_;
  std::vector<PathName> paths_;  ///< of the plan that is carried out
  std::string bytes_;            ///< of the message that is being written
  double time_s_ = 0.0;
  std::uint64_t ticks_ = 0, last_tick_ = 0, missing_ms_ = 0;
  PerArm<safety::Action> action_ = {};
  PerArm<safety::Cause> cause_ = {};
};

}  // namespace tuina::record
