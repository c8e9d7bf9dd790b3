// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "tuina/history/history.hpp"
#include "tuina/history/outbox.hpp"

namespace tuina::app {

/// The history that a robot keeps whether or not its server answers: a file, or a file from which
/// sessions go to a server.
class KeptHistory {
 public:
  /// What `--history` names. A server may be away; its file lies beside the usual history.
  [[nodiscard]] static Result<KeptHistory> open(const std::string& address);

  /// Where this robot writes: on the disk when a call returns.
  [[nodiscard]] history::History& own() { return own_; }
  /// Everything that is known. Fails while the server does not answer.
  [[nodiscard]] Result<history::History*> whole();
  /// Brings what waits to the server, if there is one. Fails while it does not answer.
  [[nodiscard]] Result<history::Delivered> catch_up();
  /// Forgets that a session began which did not after all. Where the server does not answer now, it
  /// keeps a session that was cut short.
  void take_back(const record::VisitLabel& label);
  /// The file in which sessions wait for the server; empty: there is no server.
  [[nodiscard]] const std::string& outbox() const { return outbox_; }

 private:
  KeptHistory(history::History own, std::string server, std::string outbox)
      : own_(std::move(own)), server_(std::move(server)), outbox_(std::move(outbox)) {}

  history::History own_;
  std::string server_, outbox_;
  std::optional<history::History> reached_;
};

}  // namespace tuina::app
