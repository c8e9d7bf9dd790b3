// SPDX-License-Identifier: Apache-2.0
#include "tuina/session/performed_paths.hpp"

#include <algorithm>

#include "tuina/session/run.hpp"

namespace tuina::session {

void keep(const MassageStep& massage, Session& session) {
  session.performed.insert(session.performed.end(), massage.performed().begin(),
                           massage.performed().end());
  session.decisions.insert(session.decisions.end(), massage.decisions().begin(),
                           massage.decisions().end());
  session.stops.insert(session.stops.end(), massage.stops().begin(), massage.stops().end());
  session.intensity = massage.intensity();
  session.paused = massage.paused();
}

void PerformedPaths::set_aside(Session& session) {
  const auto& paths = session.ready.plan.paths;
  std::vector<int> place(paths.size(), -1);
  std::vector<bool> counted(paths.size(), false);  // what was repeated is done once
  const auto keep = [&](int path) {
    int& at = place[static_cast<std::size_t>(path)];
    if (at < 0) {
      at = static_cast<int>(kept_.size());
      kept_.push_back(paths[static_cast<std::size_t>(path)]);
    }
    return at;
  };
  for (; performed_ < session.performed.size(); ++performed_) {
    Performed& performed = session.performed[performed_];
    const auto index = static_cast<std::size_t>(performed.path);
    if ((performed.whole || performed.skipped) && !counted[index]) {
      counted[index] = true;
      done_.push_back(paths[index].path.name);
    }
    performed.path = keep(performed.path);
  }
  for (; decided_ < session.decisions.size(); ++decided_)
    session.decisions[decided_].path = keep(session.decisions[decided_].path);
}

void PerformedPaths::join(Session& session) {
  const int before = static_cast<int>(kept_.size());
  for (; performed_ < session.performed.size(); ++performed_)
    session.performed[performed_].path += before;
  for (; decided_ < session.decisions.size(); ++decided_)
    session.decisions[decided_].path += before;
  auto& paths = session.ready.plan.paths;
  paths.insert(paths.begin(), kept_.begin(), kept_.end());
}

void leave_out(massage::Plan& plan, std::vector<std::string> done) {
  std::erase_if(plan.paths, [&](const massage::PlannedPath& planned) {
    const auto found = std::find(done.begin(), done.end(), planned.path.name);
    if (found == done.end()) return false;
    done.erase(found);
    return true;
  });
}

}  // namespace tuina::session
