// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "tuina/massage/plan.hpp"

namespace tuina::session {

struct Session;
class MassageStep;

/// What a massage performed, changed and was told goes into the session.
void keep(const MassageStep& massage, Session& session);

/// The paths of plans that were broken off because the person had moved. A session tells of one
/// plan, so what they performed is put before the paths of the last.
class PerformedPaths {
 public:
  /// After a plan was broken off: keeps those of its paths that were begun, and lets what the
  /// session says of them point here.
  void set_aside(Session& session);
  /// Puts the kept paths before those of the last plan.
  void join(Session& session);
  /// Names of the paths that were performed whole, or that somebody asked to leave; a name stands
  /// once for each time.
  [[nodiscard]] const std::vector<std::string>& done() const { return done_; }

 private:
  std::vector<massage::PlannedPath> kept_;
  std::vector<std::string> done_;
  std::size_t performed_ = 0,
              decided_ = 0;  ///< counts of the session's entries that point here already
};

/// Takes paths that are done out of a plan; a name may stand for several.
void leave_out(massage::Plan& plan, std::vector<std::string> done);

}  // namespace tuina::session
