// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "apps/cli/command_line.hpp"
#include "apps/serve/channel_fork.hpp"
#include "apps/serve/known_people.hpp"
#include "apps/serve/live_view.hpp"
#include "apps/serve/start_order.hpp"
#include "apps/simulated/session_files.hpp"
#include "apps/simulated/simulated_session.hpp"
#include "tuina/session/command_queue.hpp"
#include "tuina/session/config.hpp"
#include "tuina/session/live_command.hpp"

namespace tuina::app {

/// Where a session is, as a page shows it. `review`: the plan waits to be approved.
enum class LivePhase : std::uint8_t { idle, scan, map, plan, review, massage, report, ended };
[[nodiscard]] const char* name_of(LivePhase phase) noexcept;

/// What is said to somebody who asks for something about a plan that stands no more.
inline constexpr const char* another_plan = "another plan was made meanwhile; look at it first";

/// One session after the other, each on a thread of its own. What is asked of a running one goes
/// through the door that the keyboard uses: `session::Order::commands`. All of it may be called
/// from any thread, and none of it waits for the session.
class LiveSession {
 public:
  struct Options {
    session::Config config;
    CommonOptions common;
    std::optional<double> pace = 1.0;  ///< `record::SessionOrder::pace`
    std::string robot = "thesis";      ///< name or file, as `robot_model` was loaded from
    robot::RobotModel robot_model;
    std::filesystem::path folder;  ///< a folder in it for each session
    bool ordered = false;  ///< at the terminal: one session, in `folder` itself; pages start none
    ChannelFork* channels = nullptr;  ///< told what the record of each session is told
    /// @{
    /// Told of each session on its own thread: before it begins, which this may refuse; when its
    /// record is there; when it has come to none.
    std::function<Result<void>()> begins = {};
    std::function<Result<void>(const SessionResult&, const record::SessionFile&)> has_ended = {};
    std::function<void(const Error&)> has_failed = {};
    /// @}
    KnownPeople people = {};                    ///< whose history a session may join
    std::optional<ServedDevices> devices = {};  ///< nothing: arms are simulated in this program
  };
  struct State {
    LivePhase phase = LivePhase::idle;
    bool paused = false;
    std::string session;  ///< number of the newest session, "0001"; empty: there was none
    std::string outcome;  ///< of an ended session: done, stopped, or failed
    /// What happened, for people; in a review why a change was refused.
    std::vector<SentenceLine> said;
    bool recorded = false;      ///< it has ended, and its report and record are in its folder
    std::uint64_t reviews = 0;  ///< plans that were laid before somebody
    LiveView::Progress progress;
  };

  /// Of the session of that number.
  [[nodiscard]] static std::filesystem::path folder_of(const Options& options,
                                                       const std::string& number) {
    return options.ordered ? options.folder : options.folder / number;
  }

  explicit LiveSession(Options options) : options_(std::move(options)) {}
  ~LiveSession();
  LiveSession(const LiveSession&) = delete;
  LiveSession& operator=(const LiveSession&) = delete;

  /// Refused (Fault::usage) while one runs.
  [[nodiscard]] Result<void> start(StartOrder start);
  /// The one session that was ordered at the terminal begins; whoever runs it asks `attendant`, and
  /// tells when it has ended: `outcome` and what is said as in `State`.
  void begin_ordered();
  [[nodiscard]] Attendant attendant();
  void end_ordered(const std::string& outcome, std::vector<SentenceLine> said);
  /// Refused when no plan waits for it, or another one than that of this `State::reviews`.
  [[nodiscard]] Result<void> approve(std::optional<std::uint64_t> review = {});
  /// Another plan, with these places ruled out and these points put right; refused like
  /// `approve`. What comes of it stands in the next state.
  [[nodiscard]] Result<void> change(session::ByHand wanted,
                                    std::optional<std::uint64_t> review = {});
  /// Refused when no massage runs.
  [[nodiscard]] Result<void> command(session::LiveCommand command);
  /// What the plan that stands was made with.
  [[nodiscard]] session::ByHand by_hand() const;
  /// In any phase; again and again does no harm.
  void stop();

  [[nodiscard]] State state() const;
  /// Of the newest session; null before the first.
  [[nodiscard]] std::shared_ptr<LiveView> view() const;

 private:
  void run(StartOrder start, std::filesystem::path folder);
  void give_up(const Error& error, const std::filesystem::path& folder,
               const std::optional<record::VisitLabel>& visit);
  [[nodiscard]] Result<void> waits_for(std::optional<std::uint64_t> review, const char* what) const;
  [[nodiscard]] session::Review wait_for_review(const motion::ReadyPlan& plan,
                                                const std::string& refused);
  void begin(const std::string& number);
  void end(std::string outcome, std::vector<SentenceLine> said, bool recorded);
  [[nodiscard]] std::string next_number() const;

  Options options_;
  mutable std::mutex mutex_;
  std::condition_variable answered_;
  LivePhase phase_ = LivePhase::idle;
  std::optional<session::Review> review_;  ///< answer that the session has not taken yet
  std::uint64_t reviews_ = 0;
  session::ByHand by_hand_, asked_by_hand_;
  bool paused_ = false;
  std::string number_, outcome_;
  std::vector<SentenceLine> said_;
  bool recorded_ = false;
  std::shared_ptr<LiveView> view_;
  /// Written under the mutex, read by the session.
  session::CommandQueue commands_;
  std::thread thread_;
};

}  // namespace tuina::app
