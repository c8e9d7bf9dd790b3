// SPDX-License-Identifier: Apache-2.0
#include "apps/simulated/ros2_door.hpp"

#include <fmt/format.h>

#include "tuina/web/foxglove.hpp"

namespace tuina::app {
namespace {

constexpr std::size_t max_programs = 64;
constexpr double look_every_s = 0.1;
// A server counts its pages from 1 and never comes so far.
constexpr web::ClientId first_id = web::ClientId{1} << 62;

}  // namespace

Ros2Door::Ros2Door(std::vector<web::Ask> asks, std::unique_ptr<ros2::Services> services, Desk desk)
    : asks_(std::move(asks)),
      services_(std::move(services)),
      desk_(std::move(desk)),
      last_id_(first_id) {
  thread_ = std::thread([this] { serve(); });
}

Result<std::unique_ptr<Ros2Door>> Ros2Door::open(ros2::Node& node, ros2::Reach reach, Desk desk) {
  // Stop is the first of them, so it is taken first.
  const auto& all = web::foxglove::services;
  std::vector<web::Ask> asks(all.begin(), reach == ros2::Reach::host ? all.end() : all.begin() + 1);
  std::vector<std::string> names;
  names.reserve(asks.size());
  for (const web::Ask ask : asks) names.push_back(fmt::format("/tuina/{}", web::name_of(ask)));
  auto services = node.offer(names);
  if (!services) return tl::unexpected(services.error());
  return std::unique_ptr<Ros2Door>(
      new Ros2Door(std::move(asks), std::move(*services), std::move(desk)));
}

Ros2Door::~Ros2Door() {
  ends_ = true;
  thread_.join();
}

void Ros2Door::serve() {
  while (!ends_) {
    if (const auto request = services_->next(look_every_s)) serve(*request);
    forget_the_silent();
    desk_.look();
  }
}

void Ros2Door::serve(const ros2::Request& request) {
  const web::Ask ask = asks_.at(request.service);
  // Before anything that may wait or fail, and whatever the request looks like.
  if (ask == web::Ask::stop) desk_.stop();
  const std::string outcome = decide(request, ask);
  desk_.note(fmt::format("ros2 {}", request.from), web::name_of(ask), outcome);
  // Who floods is not answered.
  if (outcome != web::name_of(web::Refusal::too_fast))
    services_->answer(request, outcome == "done", outcome);
}

std::string Ros2Door::decide(const ros2::Request& request, web::Ask ask) {
  if (ask == web::Ask::stop) return "done";  // it was, before anything else
  if (!request.call) return "not a request as rmw_cyclonedds writes it";
  Program* program = program_of(request.from);
  if (program == nullptr) return "too many programs";
  return desk_.decide(
      {.client = program->id, .ask = ask, .sequence = ++program->sequence, .age_s = request.age_s});
}

/// Null where there are too many of them.
Ros2Door::Program* Ros2Door::program_of(const std::string& name) {
  if (!programs_.contains(name) && programs_.size() >= max_programs) return nullptr;
  Program& program = programs_[name];
  if (program.id == 0) {
    program.id = ++last_id_;
    desk_.come(program.id);
  }
  program.heard_s = clock_.seconds();
  return &program;
}

// Nobody says that they go. Those who are silent have no control any more, and lose nothing.
void Ros2Door::forget_the_silent() {
  std::erase_if(programs_, [&](const auto& entry) {
    const bool silent = clock_.seconds() - entry.second.heard_s > web::lease_s;
    if (silent) desk_.go(entry.second.id);
    return silent;
  });
}

}  // namespace tuina::app
