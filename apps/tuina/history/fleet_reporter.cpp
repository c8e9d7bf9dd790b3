// SPDX-License-Identifier: Apache-2.0
#include "apps/tuina/history/fleet_reporter.hpp"

#include <unistd.h>

#include <array>
#include <chrono>

#include "apps/tuina/history/open.hpp"

namespace tuina::app {
namespace {

constexpr auto looks_every = std::chrono::milliseconds(200);
/// A robot that has nothing new to say is heard of this often, and a server that was away is asked
/// again.
constexpr auto told_every = std::chrono::seconds(10);

}  // namespace

std::string name_of_computer() {
  std::array<char, 256> name{};
  if (::gethostname(name.data(), name.size() - 1) != 0 || name[0] == '\0') return "robot";
  return name.data();
}

FleetReporter::FleetReporter(KeptHistory sessions, KeptHistory states, history::Machine machine)
    : sessions_(std::move(sessions)), states_(std::move(states)), machine_(std::move(machine)) {}

Result<std::unique_ptr<FleetReporter>> FleetReporter::open(const std::string& address,
                                                           history::Machine machine) {
  auto sessions = KeptHistory::open(address);
  if (!sessions) return tl::unexpected(sessions.error());
  auto states = KeptHistory::open(address);
  if (!states) return tl::unexpected(states.error());
  machine.seen = utc_now();
  machine.doing = "idle";
  if (auto told = enter(states->own().database(), machine); !told)
    return tl::unexpected(told.error());
  std::unique_ptr<FleetReporter> reporter(
      new FleetReporter(std::move(*sessions), std::move(*states), std::move(machine)));
  reporter->thread_ = std::thread([self = reporter.get()] { self->tell(); });
  return reporter;
}

FleetReporter::~FleetReporter() {
  ends_ = true;
  if (thread_.joinable()) thread_.join();
  tell_once("switched off");
}

Result<void> FleetReporter::begin_session() {
  const record::VisitLabel label = new_visit({});
  session_ = {.id = label.id, .machine = machine_.name, .began = label.began};
  return enter(sessions_.own().database(), session_);
}

Result<void> FleetReporter::end_session(const SessionResult& result,
                                        const record::SessionFile& file) {
  auto ended = history::machine_session_of(file, result.truth.trace);
  ended.id = session_.id, ended.machine = session_.machine, ended.began = session_.began;
  return enter(sessions_.own().database(), ended);
}

void FleetReporter::fail_session(const Error& error) {
  history::MachineSession failed = session_;
  failed.ended = true;
  // Other reasons may be the person's, such as a health question, and are not told.
  if (error.fault == Fault::device) failed.stops = 1, failed.stop_cause = error.message;
  static_cast<void>(enter(sessions_.own().database(), failed));
}

void FleetReporter::tell_once(const std::string& doing) {
  history::Machine now = machine_;
  now.seen = utc_now();
  now.doing = doing;
  // Neither a full disk nor a server that is away stops a robot; both show as one that was last
  // heard of long ago.
  static_cast<void>(enter(states_.own().database(), now));
  static_cast<void>(states_.catch_up());
}

void FleetReporter::now(const std::string& doing) {
  const std::lock_guard lock(mutex_);
  doing_ = doing;
}

void FleetReporter::tell() {
  std::string told;
  auto next = std::chrono::steady_clock::now();
  while (!ends_) {
    std::string doing;
    {
      const std::lock_guard lock(mutex_);
      doing = doing_;
    }
    if (const auto now = std::chrono::steady_clock::now(); doing != told || now >= next) {
      tell_once(doing);
      told = doing;
      next = std::chrono::steady_clock::now() + told_every;
    }
    std::this_thread::sleep_for(looks_every);
  }
}

}  // namespace tuina::app
