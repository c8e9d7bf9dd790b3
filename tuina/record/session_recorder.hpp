// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "tuina/core/io/file.hpp"
#include "tuina/record/session_channels.hpp"
#include "tuina/telemetry/mcap/writer.hpp"

namespace tuina::record {

/// Writes session.mcap while the session runs (docs/record.md). It takes a microsecond here and a
/// write to a disk there, so it belongs behind a `Relay`. Until `finish` the file is called
/// session.mcap.part; a crash costs a second at most.
class SessionRecorder final : public session::Observer, private ChannelSink {
 public:
  using Attachments = std::vector<std::pair<std::string, std::string>>;  ///< names, contents

  /// Begins a record at `file` with what is known at the start. Fails with Fault::file.
  [[nodiscard]] static Result<std::unique_ptr<SessionRecorder>> begin(
      const std::filesystem::path& file, const SessionStart& start,
      const Attachments& attached = {});

  void on_profile(const scanner::LiveProfile& profile) override { channels_.on_profile(profile); }
  void on_scan(const scanner::Scan& scan) override { channels_.on_scan(scan); }
  void on_map(const body::Mapping& map) override;
  void on_plan(const motion::ReadyPlan& plan, const Transform& base_from_couch) override {
    channels_.on_plan(plan, base_from_couch);
  }
  void on_tick(const session::Tick& tick) noexcept override {
    if (state_) channels_.on_tick(tick);
  }

  /// @{
  /// Milliseconds that were recorded, and those between them that were not.
  [[nodiscard]] std::uint64_t ticks() const { return channels_.ticks(); }
  [[nodiscard]] std::uint64_t missing_ms() const { return channels_.missing_ms(); }
  /// @}

  /// Attaches these files, those that exist, and closes the record of a session whose last
  /// millisecond was `last_tick`. Large tables and texts are attached as zstd frames with `.zst`
  /// behind their names. Fails with the first thing that went wrong since `begin`; then what was
  /// written until then stays as `.part`.
  [[nodiscard]] Result<void> finish(std::uint64_t last_tick,
                                    std::span<const std::filesystem::path> attached = {});

 private:
  SessionRecorder(FileWriter file, const SessionStart& start, const Attachments& attached);

  [[nodiscard]] std::uint16_t add_channel(const ChannelDescription& description) override;
  void write(std::uint16_t channel, std::uint64_t time_ns, std::string_view message) override;
  void attach(const std::string& name, std::string_view content);
  void keep(Result<void> done);

  FileWriter file_;
  telemetry::mcap::Writer writer_;
  Result<void> state_ = {};  ///< the first thing that went wrong
  SessionChannels channels_;
};

}  // namespace tuina::record
