// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tuina/record/channel_sink.hpp"
#include "tuina/record/session_diagnostics.hpp"
#include "tuina/record/session_file.hpp"
#include "tuina/record/session_messages.hpp"
#include "tuina/session/observer.hpp"

namespace tuina::record {

/// What a session says of itself before anything has happened.
struct SessionStart {
  std::uint64_t seed = 1;
  std::string version;
  SessionOrder order;
  std::string answered_by;  ///< who answered the health questions
  robot::RobotModel robot;
};

/// Tells a scan that belongs to no session, at time zero: its lines as they come, then the cloud.
class ScanChannels {
 public:
  /// The sink must outlive it. Those who read it learn of both channels here.
  explicit ScanChannels(ChannelSink& sink);
  /// Writes a line of the laser, where it has seen anything.
  void tell(const scanner::LiveProfile& profile);
  /// Writes the cloud of a scan.
  void tell(const scanner::Scan& scan);

 private:
  void write(std::uint16_t channel, const PointCloud& cloud_in_couch);
  ChannelSink& sink_;
  std::uint16_t profile_, scan_;
};

/// Tells a session as messages on channels (docs/record.md): joints, tools and their wrenches each
/// millisecond, profiles of a scan and the scan, acupoints, plan, and what happens; each second how
/// the devices are. A millisecond takes a microsecond here and what the sink takes.
class SessionChannels final : public session::Observer {
 public:
  /// The sink must outlive it, and hears of the order and of the consent here.
  SessionChannels(ChannelSink& sink, const SessionStart& start);

  void on_profile(const scanner::LiveProfile& profile) override;
  void on_scan(const scanner::Scan& scan) override;
  void on_map(const body::Mapping& map) override;
  void on_plan(const motion::ReadyPlan& plan, const Transform& base_from_couch) override;
  /// A millisecond that cannot be told counts as missing.
  void on_tick(const session::Tick& tick) noexcept override;
  /// Says which milliseconds are missing before that one.
  void tell_gap(std::uint64_t next_tick);

  /// @{
  /// Milliseconds that were told, and those between them that were not.
  [[nodiscard]] std::uint64_t ticks() const { return ticks_; }
  [[nodiscard]] std::uint64_t missing_ms() const { return missing_ms_; }
  /// @}
  /// Session time of the last millisecond.
  [[nodiscard]] double time_s() const { return time_s_; }
  /// The robot where it stands, once the person is found.
  [[nodiscard]] const std::string& urdf() const { return urdf_; }

 private:
  struct PathName {
    std::string path, technique;
  };

  template <typename Message>
  void tell(std::uint16_t& channel, const char* topic, const Message& message, double time_s,
            bool latched = false);
  template <typename Event>
  void tell(std::uint16_t& channel, const Event& event, double time_s, bool latched = false);
  void tell(const session::Tick& tick);
  void tell_events(const session::Tick& tick);
  void tell_guard(const session::Tick& tick);
  void tell_arms(const session::Tick& tick);
  [[nodiscard]] PathName name_of_path(int index) const;

  /// Channels are added when their first message comes; 0: not yet.
  struct Channels {
    std::uint16_t joints = 0, tools = 0, parts = 0, still = 0, profile = 0, scan = 0, acupoints = 0,
                  plan = 0, urdf = 0, diagnostics = 0;
    PerArm<std::uint16_t> wrench = {}, pose = {};
    std::uint16_t order = 0, consent = 0, planned = 0, arms = 0, contacts = 0, tissue = 0,
                  decisions = 0, stops = 0, commands = 0, guard = 0, gaps = 0;
  };

  ChannelSink& sink_;
  robot::RobotModel robot_model_;
  Channels channels_;
  std::optional<RobotMessages> robot_;
  SessionDiagnostics diagnostics_;
  std::string urdf_;
  std::vector<PathName> paths_;  ///< of the plan that is carried out
  std::string bytes_;            ///< of the message that is being written
  double time_s_ = 0.0;
  std::uint64_t ticks_ = 0, last_tick_ = 0, missing_ms_ = 0;
  PerArm<safety::Action> action_ = {};
  PerArm<safety::Cause> cause_ = {};
};

}  // namespace tuina::record
