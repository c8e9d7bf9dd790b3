// SPDX-License-Identifier: Apache-2.0
#include "apps/simulated/ros2_desk.hpp"

namespace tuina::app {

Result<std::unique_ptr<Ros2Desk>> Ros2Desk::open(ros2::Node& node, ros2::Reach reach,
                                                 const std::filesystem::path& log) {
  auto audit = web::AuditLog::open(log);
  if (!audit) return tl::unexpected(audit.error());
  std::unique_ptr<Ros2Desk> desk(new Ros2Desk(std::move(*audit)));
  Ros2Desk* self = desk.get();
  auto door = Ros2Door::open(
      node, reach,
      {.stop = [self] { self->commands_.stop(); },
       .come = [self](auto client) { self->desk_.come(client, self->clock_.seconds()); },
       .go = [self](auto client) { self->desk_.go(client); },
       .decide = [self](const auto& asked) { return self->decide(asked); },
       .note = [self](const auto& who, const auto& what,
                      const auto& outcome) { self->note(who, what, outcome); },
       .look = [self] { self->pause_without_operator(); }});
  if (!door) return tl::unexpected(door.error());
  desk->door_ = std::move(*door);
  return desk;
}

Attendant Ros2Desk::attendant() {
  return {.commands = [this](double) { return next_command(); },
          .ends_scan = [this] { return commands_.stopped(); }};
}

std::optional<session::LiveCommand> Ros2Desk::next_command() noexcept {
  running_ = true;
  return commands_.next();
}

// "done", or why not.
std::string Ros2Desk::decide(const Ros2Door::Asked& asked) {
  if (audit_fails_) return "the audit log cannot be written";
  const double now_s = clock_.seconds();
  const auto refusal = desk_.judge(
      asked.client, {.ask = asked.ask, .sequence = asked.sequence, .clock_s = now_s - asked.age_s},
      now_s);
  return refusal == web::Refusal::none ? obey(asked.ask) : web::name_of(refusal);
}

std::string Ros2Desk::obey(web::Ask ask) {
  if (ask == web::Ask::operate) operated_ = true;
  if (ask == web::Ask::hand_over) operated_ = false;
  const auto command = web::live_command(ask);
  if (!command) return "done";
  if (!running_) return "no massage is running";
  return commands_.push(*command) ? "done" : "too many commands at once";
}

void Ros2Desk::pause_without_operator() {
  if (!operated_ || desk_.operator_at(clock_.seconds())) return;
  operated_ = false;
  if (!running_) return;
  const bool paused = commands_.push(session::LiveCommand::pause);
  note("server", "pause", paused ? "done: no operator is there" : "too many commands at once");
}

void Ros2Desk::note(const std::string& who, const std::string& what, const std::string& outcome) {
  const bool done = outcome.starts_with("done");
  const web::AuditEntry entry{.who = who,
                              .what = what,
                              .phase = running_ ? "massage" : "before the massage",
                              .outcome = done ? outcome : "refused: " + outcome};
  const double now_s = clock_.seconds();
  const auto written = done ? audit_.add(entry, now_s) : audit_.add_refused(entry, now_s);
  if (!written) audit_fails_ = true;
}

}  // namespace tuina::app
