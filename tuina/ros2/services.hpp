// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "tuina/ros2/trigger.hpp"

namespace tuina::ros2 {

/// What came to a service.
struct Request {
  std::size_t service = 0;  ///< index of its name
  std::string from;         ///< program that asks: 32 digits of DDS; empty where it has gone
  double age_s = 0.0;       ///< by the clocks of both machines
  /// Nothing where the bytes are not those of a request as [rmw_cyclonedds] writes it: there is
  /// nobody to answer.
  std::optional<CallId> call;
};

/// Services of type std_srvs/Trigger that a node offers. One thread asks it.
class Services {
 public:
  virtual ~Services() = default;
  /// The next request, of the service that was named first among those that wait. Nothing where
  /// none comes in time. Of a service the newest 32 wait.
  [[nodiscard]] virtual std::optional<Request> next(double timeout_s) = 0;
  /// Never waits. Who cannot hear an answer yet is given it within five seconds, or never.
  virtual void answer(const Request& request, bool success, const std::string& message) = 0;

 protected:
  Services() = default;
  Services(const Services&) = default;
  Services& operator=(const Services&) = default;
};

}  // namespace tuina::ros2
