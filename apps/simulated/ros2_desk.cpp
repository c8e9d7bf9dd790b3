// SPDX-License-Identifier: Apache-2.0
#include "apps/simulated/ros2_desk.hpp"

#include <algorithm>

#include "tuina/web/foxglove.hpp"

namespace tuina::app {
namespace {

constexpr std::size_t max_programs = 64;
// So often the desk looks whether its operator is still there.
constexpr double look_every_s = 0.1;

}  // namespace

Ros2Desk::Ros2Desk(std::vector<web::Ask> asks, std::unique_ptr<ros2::Services> services,
                   web::AuditLog audit)
    : asks_(std::move(asks)), services_(std::move(services)), audit_(std::move(audit)) {
  thread_ = std::thread([this] { serve(); });
}

Result<std::unique_ptr<Ros2Desk>> Ros2Desk::open(ros2::Node& node, ros2::Reach reach,
                                                 const std::filesystem::path& log) {
  // Stop is the first of them, so it is taken first.
  const auto& all = web::foxglove::services;
  std::vector<web::Ask> asks(all.begin(), reach == ros2::Reach::host ? all.end() : all.begin() + 1);
  std::vector<std::string> names;
  names.reserve(asks.size());
  for (const web::Ask ask : asks) names.push_back(fmt::format("/tuina/{}", web::name_of(ask)));
  auto audit = web::AuditLog::open(log);
  if (!audit) return tl::unexpected(audit.error());
  auto services = node.offer(names);
  if (!services) return tl::unexpected(services.error());
  return std::unique_ptr<Ros2Desk>(
      new Ros2Desk(std::move(asks), std::move(*services), std::move(*audit)));
}

Ros2Desk::~Ros2Desk() {
  ends_ = true;
  thread_.join();
}

Attendant Ros2Desk::attendant() {
  return {.commands = [this](double) { return next_command(); },
          .ends_scan = [this] { return commands_.stopped(); }};
}

std::optional<session::LiveCommand> Ros2Desk::next_command() noexcept {
  running_ = true;
  return commands_.next();
}

void Ros2Desk::serve() {
  while (!ends_) {
    if (const auto request = services_->next(look_every_s)) serve(*request);
    pause_without_operator();
  }
}

void Ros2Desk::serve(const ros2::Request& request) {
  const web::Ask ask = asks_.at(request.service);
  // Before anything that may wait or fail, and whatever the request looks like.
  if (ask == web::Ask::stop) commands_.stop();
  const std::string outcome = decide(request, ask);
  note(fmt::format("ros2 {}", request.from), web::name_of(ask), outcome);
  // Who floods is not answered.
  if (outcome != web::name_of(web::Refusal::too_fast))
    services_->answer(request, outcome == "done", outcome);
}

// "done", or why not.
std::string Ros2Desk::decide(const ros2::Request& request, web::Ask ask) {
  if (ask == web::Ask::stop) return "done";  // it was, before anything else
  if (!request.call) return "not a request as rmw_cyclonedds writes it";
  if (audit_fails_) return "the audit log cannot be written";
  const double now_s = clock_.seconds();
  Program* program = program_of(request.from, now_s);
  if (program == nullptr) return "too many programs";
  const auto refusal = desk_.judge(
      program->id, {.ask = ask, .sequence = ++program->sequence, .clock_s = now_s - request.age_s},
      now_s);
  return refusal == web::Refusal::none ? obey(ask) : web::name_of(refusal);
}

std::string Ros2Desk::obey(web::Ask ask) {
  if (ask == web::Ask::operate) operated_ = true;
  if (ask == web::Ask::hand_over) operated_ = false;
  const auto command = web::live_command(ask);
  if (!command) return "done";
  if (!running_) return "no massage is running";
  return commands_.push(*command) ? "done" : "too many commands at once";
}

/// Null where there are too many of them.
Ros2Desk::Program* Ros2Desk::program_of(const std::string& name, double now_s) {
  const auto known = programs_.find(name);
  if (known == programs_.end() && programs_.size() >= max_programs) {
    // Those who are silent have no control any more, and lose nothing by being forgotten.
    std::erase_if(programs_, [&](const auto& entry) {
      const bool silent = now_s - entry.second.heard_s > web::lease_s;
      if (silent) desk_.go(entry.second.id);
      return silent;
    });
    if (programs_.size() >= max_programs) return nullptr;
  }
  Program& program = programs_[name];
  if (program.id == 0) {
    program.id = ++last_id_;
    desk_.come(program.id, now_s);
  }
  program.heard_s = now_s;
  return &program;
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
