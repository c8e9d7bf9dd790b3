// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "tuina/history/history.hpp"

/// A robot whose server is away goes on alone: it writes into a history of its own, a SQLite file,
/// from which the sessions go to the server once it answers.
namespace tuina::history {

/// What has gone to the server.
struct Delivered {
  std::size_t sessions = 0;
  std::vector<std::string> refused;  ///< sessions that the server does not take, and why
};

/// Brings all that waits in `outbox` to `server`, and takes out what the server has acknowledged.
/// Whenever it is cut off, nothing is lost, and when it is done again, nothing is there twice.
/// Fails when the server does not answer: what has not gone still waits. What it refuses waits,
/// too.
[[nodiscard]] Result<Delivered> deliver(History& outbox, History& server);

/// Sessions that wait: of people, and of the robot.
[[nodiscard]] Result<std::size_t> waiting(History& outbox);

}  // namespace tuina::history
