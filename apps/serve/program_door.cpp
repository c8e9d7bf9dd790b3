// SPDX-License-Identifier: Apache-2.0
// What other programs ask of the live page's server, by `web::foxglove`.
#include <charconv>

#include "apps/serve/live_site.hpp"

namespace tuina::app {
namespace {

namespace foxglove = web::foxglove;

// A beat is the echo of the server's clock.
std::optional<double> clock_of(const std::string& pong) {
  double clock_s = 0.0;
  const char* end = pong.data() + pong.size();
  const auto read = std::from_chars(pong.data(), end, clock_s);
  if (read.ec != std::errc() || read.ptr != end) return std::nullopt;
  return clock_s;
}

}  // namespace

Result<void> LiveSite::open_to_ros2() {
  if (options_.node == nullptr) return {};
  auto door =
      Ros2Door::open(*options_.node, options_.reach,
                     {.stop = [this] { session_.stop(); },
                      .come =
                          [this](auto client) {
                            const std::lock_guard lock(mutex_);
                            desk_.come(client, clock_.seconds());
                          },
                      .go =
                          [this](auto client) {
                            const std::lock_guard lock(mutex_);
                            desk_.go(client);
                          },
                      .decide =
                          [this](const auto& asked) {
                            const std::lock_guard lock(mutex_);
                            return decide(asked.client, {.ask = asked.ask,
                                                         .sequence = asked.sequence,
                                                         .clock_s = clock_.seconds() - asked.age_s})
                                .words;
                          },
                      .note =
                          [this](const auto& who, const auto& what, const auto& outcome) {
                            const std::lock_guard lock(mutex_);
                            note(who, what, outcome);
                          }});
  if (!door) return tl::unexpected(door.error());
  ros2_ = std::move(*door);
  return {};
}

// Messages of one connection keep their order, so an ask is younger than the pong before it: with
// the clock of that pong the desk takes it to be no younger than it is.
void LiveSite::serve(web::ClientId client, const foxglove::ServiceCall& call) {
  const auto ask = foxglove::ask_of(call);
  // Before anything that may wait or fail.
  if (ask && *ask == web::Ask::stop) session_.stop();
  std::string outcome;
  {
    const std::lock_guard lock(mutex_);
    Program& program = programs_[client];
    outcome =
        ask ? decide(client,
                     {.ask = *ask, .sequence = ++program.sequence, .clock_s = program.clock_s})
                  .words
            : ask.error().message;
    note(name_of_client(client), ask ? name_of(*ask) : "service", outcome);
  }
  if (outcome == name_of(web::Refusal::too_fast)) return;  // who floods is not answered
  server_->reply(client, outcome == "done" ? foxglove::service_done(call)
                                           : foxglove::service_failed(call, outcome));
}

void LiveSite::hear_pong(web::ClientId client, const std::string& pong) {
  const auto clock_s = clock_of(pong);
  const std::lock_guard lock(mutex_);
  Program& program = programs_[client];
  if (!clock_s || !(*clock_s > program.clock_s)) return;
  const web::Message beat{.sequence = ++program.sequence, .clock_s = *clock_s};
  if (desk_.judge(client, beat, clock_.seconds()) == web::Refusal::none) program.clock_s = *clock_s;
}

void LiveSite::hear_program(web::ClientId client, const web::Frame& frame) {
  if (frame.kind == web::Frame::Kind::pong) return hear_pong(client, frame.bytes);
  const auto message = foxglove::parse(frame);
  if (const auto* call = message ? std::get_if<foxglove::ServiceCall>(&*message) : nullptr)
    return serve(client, *call);
  {
    const std::lock_guard lock(mutex_);
    if (!programs_[client].rate.take(clock_.seconds()))
      return note(name_of_client(client), "message", name_of(web::Refusal::too_fast));
  }
  Result<void> done = {};
  if (!message) {
    done = tl::unexpected(message.error());
  } else if (const auto* wanted = std::get_if<foxglove::Subscribe>(&*message)) {
    done = channels_.subscribe(client, *wanted);
  } else if (const auto* left = std::get_if<foxglove::Unsubscribe>(&*message)) {
    done = channels_.unsubscribe(client, *left);
  }
  if (done) return;
  {
    const std::lock_guard lock(mutex_);
    note(name_of_client(client), "message", done.error().message);
  }
  server_->reply(client, foxglove::status(done.error().message));
}

}  // namespace tuina::app
