// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <memory>
#include <mutex>
#include <string>
#include <thread>

#include "apps/simulated/simulated_session.hpp"
#include "apps/tuina/history/kept_history.hpp"
#include "tuina/history/fleet.hpp"

namespace tuina::app {

/// Name of this computer, which is that of its robot unless somebody says otherwise.
[[nodiscard]] std::string name_of_computer();

/// Tells the history of a practice what this robot does. What is told waits in a file until the
/// server has it, and no session waits for the network: that is a thread of its own.
class FleetReporter {
 public:
  /// `machine` without what it does and when that was told.
  [[nodiscard]] static Result<std::unique_ptr<FleetReporter>> open(const std::string& address,
                                                                   history::Machine machine);
  FleetReporter(const FleetReporter&) = delete;
  FleetReporter& operator=(const FleetReporter&) = delete;
  ~FleetReporter();

  /// What the robot does now, in a word. Returns at once.
  void now(const std::string& doing);
  /// @{
  /// A session begins; it has ended, with its record; it has come to none. From one thread. On the
  /// disk when they return.
  [[nodiscard]] Result<void> begin_session();
  [[nodiscard]] Result<void> end_session(const SessionResult& result,
                                         const record::SessionFile& file);
  void fail_session(const Error& error);
  /// @}

 private:
  FleetReporter(KeptHistory sessions, KeptHistory states, history::Machine machine);
  void tell();
  void tell_once(const std::string& doing);

  KeptHistory sessions_;  ///< written by the thread of a session
  KeptHistory states_;    ///< written, and brought to the server, by the own thread
  history::Machine machine_;
  history::MachineSession session_;
  std::mutex mutex_;
  std::string doing_ = "idle";
  std::atomic<bool> ends_ = false;
  std::thread thread_;
};

}  // namespace tuina::app
