// SPDX-License-Identifier: Apache-2.0
#include "apps/serve/live_site.hpp"

#include <chrono>
#include <nlohmann/json.hpp>

#include "apps/serve/plan_change.hpp"
#include "apps/serve/shown_sentence.hpp"

namespace tuina::app {
namespace {

using nlohmann::json;

constexpr auto frame_every = std::chrono::milliseconds(50);
constexpr int state_every_frames = 4;
// What a page is told again and again.
constexpr web::Outbox::Slot state_slot = 0, live_slot = 1;
// A number that no channel has.
constexpr web::Outbox::Slot ping_slot = 0xffff'ffff;

std::string text_of(const json& object) {
  return object.dump(-1, ' ', true, json::error_handler_t::replace);
}

LiveSession::Options with_channels(LiveSession::Options options, ChannelFork& channels) {
  options.channels = &channels;
  return options;
}

}  // namespace

LiveSite::LiveSite(Options options, web::AuditLog audit)
    : options_(std::move(options)),
      page_(read_page(options_.page)),
      choices_(
          choices_json(static_cast<bool>(options_.session.people.find), options_.session.devices)),
      audit_(std::move(audit)),
      channels_({.reply = [this](auto client, auto frame) { server_->reply(client, frame); },
                 .put = [this](auto client, auto slot, auto frame,
                               auto keep) { server_->put(client, slot, std::move(frame), keep); },
                 .drop = [this](auto client, auto slot) { server_->drop(client, slot); }},
                web::random_token()),
      fork_(channels_, options_.node),
      session_(with_channels(options_.session, fork_)) {}

Result<std::unique_ptr<LiveSite>> LiveSite::open(Options options) {
  auto audit = web::AuditLog::open(options.session.folder / "audit.log");
  if (!audit) return tl::unexpected(audit.error());
  std::unique_ptr<LiveSite> site(new LiveSite(std::move(options), std::move(*audit)));
  LiveSite* self = site.get();
  auto server = web::Server::start(
      site->options_.place,
      {.answer = [self](const web::Request& request) { return self->answer(request); },
       .come = [self](web::ClientId client,
                      const web::Request& request) { self->come(client, request); },
       .go = [self](web::ClientId client) { self->go(client); },
       .hear = [self](web::ClientId client,
                      const web::Frame& frame) { self->hear_page(client, frame.bytes); },
       .hear_program = [self](web::ClientId client,
                              const web::Frame& frame) { self->hear_program(client, frame); },
       .say_too_much =
           [self](web::ClientId client) {
             const std::lock_guard lock(self->mutex_);
             self->note(self->name_of_client(client), "message", "too much at once");
           }});
  if (!server) return tl::unexpected(server.error());
  {
    const std::lock_guard lock(site->mutex_);
    site->server_ = std::move(*server);
    const auto& certificate = site->options_.place.certificate;
    const int port = site->server_->port();
    site->access_ = certificate ? std::make_unique<web::Access>(port, certificate->hosts())
                                : std::make_unique<web::Access>(port);
    site->note("server", "begin", "done");
  }
  site->teller_ = std::thread([self] { self->tell(); });
  if (auto opened = site->open_to_ros2(); !opened) return tl::unexpected(opened.error());
  return site;
}

LiveSite::~LiveSite() {
  session_.stop();
  ros2_.reset();
  ends_ = true;
  if (teller_.joinable()) teller_.join();
  channels_.close();  // the session may still be at its end
  server_.reset();
}

// A certificate's first host is what browsers are told: they know the server by no other name.
std::string LiveSite::address(std::string_view scheme) const {
  const auto& certificate = options_.place.certificate;
  return fmt::format("{}{}://{}:{}", scheme, certificate ? "s" : "",
                     certificate ? certificate->hosts().front() : options_.place.address,
                     server_->port());
}

// The mutex is held.
std::string LiveSite::invitation(web::Role role) {
  return fmt::format("{}/?token={}", address("http"), access_->invite(role));
}

std::string LiveSite::invite() {
  const std::lock_guard lock(mutex_);
  return invitation(web::Role::operate);
}

std::string LiveSite::program_address() const {
  return fmt::format("{}{}?token={}", address("ws"), web::foxglove::path, access_->program_token());
}

bool LiveSite::watched() {
  const std::lock_guard lock(mutex_);
  return desk_.clients() > 0;
}

// The mutex is held.
std::string LiveSite::name_of_client(web::ClientId client) const {
  return fmt::format("{} {}", pages_.contains(client) ? "page" : "program", client);
}

void LiveSite::note(const std::string& who, const std::string& what, const std::string& outcome) {
  const bool done = outcome.starts_with("done");
  const web::AuditEntry entry{.who = who,
                              .what = what,
                              .phase = name_of(session_.state().phase),
                              .outcome = done ? outcome : "refused: " + outcome};
  const double now_s = clock_.seconds();
  const auto written = done ? audit_.add(entry, now_s) : audit_.add_refused(entry, now_s);
  if (!written) audit_fails_ = true;
}

void LiveSite::come(web::ClientId client, const web::Request& request) {
  const bool is_page = request.path == web::page_path;
  {
    const std::lock_guard lock(mutex_);
    // Whose cookie has ended since it was looked at is nobody's guest.
    const web::Guest guest = access_->find_guest(request.cookie).value_or(web::Guest{});
    const web::Role role = is_page ? guest.role : web::Role::operate;
    desk_.come(client, clock_.seconds(), role);
    if (is_page) pages_[client] = guest;
    if (!is_page) programs_[client] = {};
    note(name_of_client(client), request.from.empty() ? "come" : "come from " + request.from,
         role == web::Role::watch ? "done: to watch" : "done");
  }
  if (!is_page) channels_.come(client);
}

void LiveSite::go(web::ClientId client) {
  channels_.go(client);
  const std::lock_guard lock(mutex_);
  note(name_of_client(client), "go", "done");
  desk_.go(client);
  pages_.erase(client);
  programs_.erase(client);
}

Result<void> LiveSite::obey(const web::Message& message) {
  if (audit_fails_ && (message.ask == web::Ask::start || message.ask == web::Ask::arm))
    return fail(Fault::file, "the audit log cannot be written, so nothing is begun");
  if (message.ask == web::Ask::start) {
    auto start = parse_start_order(message.order, options_.session.devices);
    if (!start) return tl::unexpected(start.error());
    return session_.start(std::move(*start));
  }
  if (message.ask == web::Ask::arm) return session_.approve(message.review);
  if (message.ask == web::Ask::change) {
    auto wanted = parse_plan_change(message.order);
    if (!wanted) return tl::unexpected(wanted.error());
    return session_.change(std::move(*wanted), message.review);
  }
  if (const auto command = web::live_command(message.ask)) return session_.command(*command);
  return {};
}

// The mutex is held. "done", or why not.
Sentence LiveSite::decide(web::ClientId client, const web::Message& message) {
  const auto refusal = desk_.judge(client, message, clock_.seconds());
  if (refusal != web::Refusal::none)
    return {.words = name_of(refusal), .key = fmt::format("refusal_{}", name_of(refusal))};
  if (message.ask == web::Ask::stop) return {.words = "done"};  // it was, before anything else
  const auto obeyed = obey(message);
  if (obeyed) return {.words = "done"};
  if (obeyed.error().message == another_plan)
    return {.words = another_plan, .key = "refusal_outdated"};
  return sentence_of(obeyed.error());
}

void LiveSite::hear_page(web::ClientId client, std::string_view text) {
  const auto message = web::parse_message(text);
  // Before anything that may wait or fail.
  if (message && message->ask == web::Ask::stop) session_.stop();
  json reply = {{"channel", "reply"}, {"sequence", message ? message->sequence : 0}};
  Sentence said;
  const std::string& outcome = said.words;
  {
    const std::lock_guard lock(mutex_);
    said = message ? decide(client, *message) : sentence_of(message.error());
    const bool done = outcome == "done";
    if (done && message->ask == web::Ask::invite) reply["address"] = invitation(web::Role::watch);
    if (done && message->ask == web::Ask::invite_operator)
      reply["address"] = invitation(web::Role::operate);
    if (!message || message->ask != web::Ask::beat || !done)
      note(name_of_client(client), message ? name_of(message->ask) : "message", outcome);
  }
  reply["ask"] = message ? name_of(message->ask) : "";
  reply["outcome"] = outcome;
  reply["said"] = shown_sentence(said);
  // A beat is answered by the next state, and who floods is not answered.
  const bool silent = (message && message->ask == web::Ask::beat && outcome == "done") ||
                      outcome == name_of(web::Refusal::too_fast);
  if (!silent) server_->reply(client, {.bytes = text_of(reply)});
}

std::string LiveSite::state_json(web::ClientId client, web::Role role,
                                 const LiveSession::State& state) const {
  const double now_s = clock_.seconds();
  const auto at_the_desk = desk_.operator_at(now_s);
  return text_of({{"channel", "state"},
                  {"clock_s", now_s},
                  {"you", client},
                  {"viewer", role == web::Role::watch},
                  {"operator", at_the_desk == client},
                  {"operated", at_the_desk.has_value()},
                  {"pages", desk_.clients()},
                  {"phase", name_of(state.phase)},
                  {"progress", state.progress.share},
                  {"paused", state.paused},
                  {"session", state.session},
                  {"outcome", state.outcome},
                  {"words", english_of(state.said)},
                  {"said", shown_sentence(state.said)},
                  {"recorded", state.recorded},
                  {"reviews", state.reviews},
                  {"cloud_points", state.progress.cloud_points},
                  {"backs", state.progress.backs},
                  {"plans", state.progress.plans},
                  {"events", state.progress.events},
                  {"pace", options_.session.pace ? json(*options_.session.pace) : json()},
                  {"ordered", options_.session.ordered},
                  {"audit_fails", audit_fails_.load()},
                  {"password", options_.passwords.has_value()}});
}

// The mutex is held. Whoever steers must be there: the arms stay where they are until somebody is.
void LiveSite::pause_without_operator(const LiveSession::State& state) {
  if (state.phase != LivePhase::massage || state.paused || desk_.operator_at(clock_.seconds()))
    return;
  const auto paused = session_.command(session::LiveCommand::pause);
  note("server", "pause", paused ? "done: no operator is there" : paused.error().message);
}

void LiveSite::tell() {
  for (int frame = 0; !ends_; ++frame) {
    std::this_thread::sleep_for(frame_every);
    const auto view = session_.view();
    const auto live = view ? view->take_frame() : std::nullopt;
    const std::lock_guard lock(mutex_);
    const LiveSession::State state = session_.state();
    pause_without_operator(state);
    const bool all = frame % state_every_frames == 0;
    for (const auto& [client, guest] : pages_) {
      if (live) server_->put(client, live_slot, {.bytes = *live});
      if (all) server_->put(client, state_slot, {.bytes = state_json(client, guest.role, state)});
    }
    if (!all) continue;
    const std::string now = fmt::format("{:.3f}", clock_.seconds());
    for (const auto& [client, program] : programs_)
      server_->put(client, ping_slot, {.kind = web::Frame::Kind::ping, .bytes = now});
  }
}

}  // namespace tuina::app
