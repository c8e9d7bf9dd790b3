// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <thread>

#include "apps/serve/channel_fork.hpp"
#include "apps/serve/live_channels.hpp"
#include "apps/serve/live_session.hpp"
#include "apps/serve/page_files.hpp"
#include "apps/simulated/ros2_door.hpp"
#include "tuina/core/stopwatch.hpp"
#include "tuina/web/access.hpp"
#include "tuina/web/audit.hpp"
#include "tuina/web/desk.hpp"
#include "tuina/web/password.hpp"
#include "tuina/web/server.hpp"

namespace tuina::app {

/// The live page: a server, its doors, and the session behind them. Who may ask what is decided by
/// `web::Access` and `web::Desk`; each ask and each refusal is a line of the audit log.
class LiveSite {
 public:
  struct Options {
    web::Place place;
    std::optional<web::Passwords> passwords;  ///< of a server that is reached by TLS
    std::filesystem::path page = {};  ///< folder of a built page; empty: the one that is carried
    LiveSession::Options session;
    ros2::Node* node = nullptr;  ///< told of all sessions, and steers them; outlives the page
    ros2::Reach reach = ros2::Reach::host;  ///< of that node
  };
  [[nodiscard]] static Result<std::unique_ptr<LiveSite>> open(Options options);
  ~LiveSite();
  LiveSite(const LiveSite&) = delete;
  LiveSite& operator=(const LiveSite&) = delete;

  /// An address that opens the page once, for who may take control.
  [[nodiscard]] std::string invite();
  /// The address at which other programs watch (`web::foxglove`), until the server ends.
  [[nodiscard]] std::string program_address() const;
  [[nodiscard]] int port() const noexcept { return server_->port(); }
  [[nodiscard]] LiveSession& session() noexcept { return session_; }
  /// Whether a page or another program is there.
  [[nodiscard]] bool watched();

 private:
  LiveSite(Options options, web::AuditLog audit);
  [[nodiscard]] std::string address(std::string_view scheme) const;
  [[nodiscard]] std::string invitation(web::Role role);
  [[nodiscard]] std::optional<web::Reply> answer(const web::Request& request);
  [[nodiscard]] web::Reply log_in(const web::Request& request);
  void log_out(const std::string& cookie);
  [[nodiscard]] web::Reply content(const web::Request& request) const;
  [[nodiscard]] std::optional<web::Reply> look_back(const web::Request& request) const;
  [[nodiscard]] std::optional<web::Reply> people(const std::string& path, bool operates) const;
  void come(web::ClientId client, const web::Request& request);
  void go(web::ClientId client);
  void hear_page(web::ClientId client, std::string_view text);
  void hear_program(web::ClientId client, const web::Frame& frame);
  void hear_pong(web::ClientId client, const std::string& pong);
  void serve(web::ClientId client, const web::foxglove::ServiceCall& call);
  [[nodiscard]] Result<void> open_to_ros2();
  [[nodiscard]] Sentence decide(web::ClientId client, const web::Message& message);
  [[nodiscard]] Result<void> obey(const web::Message& message);
  [[nodiscard]] std::string name_of_client(web::ClientId client) const;
  /// A line of the audit log; the mutex is held. An outcome other than "done" is a refusal.
  void note(const std::string& who, const std::string& what, const std::string& outcome);
  void tell();
  [[nodiscard]] std::string state_json(web::ClientId client, web::Role role,
                                       const LiveSession::State& state) const;
  void pause_without_operator(const LiveSession::State& state);

  Options options_;
  std::mutex guessing_;  ///< one password is looked at a time
  Page page_;
  std::string choices_;
  Stopwatch clock_;
  std::mutex mutex_;  ///< of what stands from here to the audit log
  std::unique_ptr<web::Access> access_;
  web::Desk desk_;
  /// Another program: it has no clock and no numbers of its own asks.
  struct Program {
    std::uint64_t sequence = 0;
    double clock_s = 0.0;  ///< of the server, as the newest pong brought it back
    web::Rate rate{200.0, 20.0};
  };
  std::map<web::ClientId, web::Guest> pages_;  ///< and as whom they came
  std::map<web::ClientId, Program> programs_;
  web::AuditLog audit_;
  std::atomic<bool> audit_fails_ = false;
  LiveChannels channels_;
  ChannelFork fork_;
  LiveSession session_;
  std::unique_ptr<web::Server> server_;
  std::atomic<bool> ends_ = false;
  std::thread teller_;
  std::unique_ptr<Ros2Door> ros2_;  ///< ends before all else
};

}  // namespace tuina::app
