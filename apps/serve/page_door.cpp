// SPDX-License-Identifier: Apache-2.0
// What browsers ask of the live page's server by HTTP, those who log in and out among them.
#include "apps/serve/finished_session.hpp"
#include "apps/serve/live_site.hpp"
#include "apps/serve/plan_change.hpp"
#include "tuina/web/login.hpp"

namespace tuina::app {

std::optional<web::Reply> LiveSite::answer(const web::Request& request) {
  constexpr int see_other = 303;
  const std::string who = request.from.empty() ? "browser" : "browser " + request.from;
  std::optional<web::Reply> reply;
  {
    const std::lock_guard lock(mutex_);
    if (!access_) return web::Reply{.status = 503};
    const auto guest = access_->find_guest(request.cookie);
    reply = access_->judge(request, clock_.seconds());
    if (reply && reply->status == see_other) {
      const bool leaves = request.path == web::logout_path;
      if (leaves && guest) log_out(guest->cookie);
      note(who, leaves ? "leave" : "enter", "done");
      return reply;
    }
  }
  if (!reply && request.upgrade) return std::nullopt;
  // Without the mutex: files and passwords may be slow, and what is asked of the session waits for
  // none of them.
  const bool logs_in = !reply && request.method == "POST";
  if (!reply) reply = logs_in ? log_in(request) : content(request);
  if (reply->status >= 400) {
    const std::lock_guard lock(mutex_);
    note(who, logs_in ? "log in" : "request", fmt::format("{}", reply->status));
  }
  return reply;
}

web::Reply LiveSite::log_in(const web::Request& request) {
  const std::lock_guard guessing(guessing_);
  const auto role = options_.passwords ? options_.passwords->role_of(web::password_of(request.body))
                                       : std::nullopt;
  if (!role) return web::login_page(web::LoginAnswer::wrong);
  const std::lock_guard lock(mutex_);
  note("browser " + request.from, "log in", *role == web::Role::watch ? "done: to watch" : "done");
  return access_->let_in(*role);
}

// The mutex is held. Pages that came with the cookie see and ask nothing any more.
void LiveSite::log_out(const std::string& cookie) {
  for (const auto& [client, guest] : pages_)
    if (guest.cookie == cookie) server_->dismiss(client);
}

web::Reply LiveSite::content(const web::Request& request) const {
  const std::string& path = request.path;
  if (const auto file = page_.find(path); file != page_.end())
    return reply_of(file->second, request);
  const auto json_reply = [](std::string body) {
    return web::Reply{.type = "application/json", .body = std::move(body)};
  };
  const auto bytes_reply = [](std::string body) {
    return web::Reply{.type = "application/octet-stream", .body = std::move(body)};
  };
  if (path == "/api/choices") return json_reply(choices_);
  const LiveSession::Options& sessions = options_.session;
  if (path == "/api/sessions") return json_reply(sessions_json(sessions.folder));
  if (const auto number = session_number(path, "/report.html"))
    return report_of(LiveSession::folder_of(sessions, *number));
  if (const auto number = session_number(path, "/play")) {
    if (session_.state().phase != LivePhase::massage)
      return play_of_session(LiveSession::folder_of(sessions, *number));
    return {.status = 503, .body = "a massage is running, which looking back must not disturb\n"};
  }
  if (const auto view = session_.view()) {
    if (path == "/api/cloud") return bytes_reply(view->cloud());
    if (path == "/api/back" && !view->back().empty()) return bytes_reply(view->back());
    if (path == "/api/map" && !view->map().empty()) return json_reply(view->map());
    if (path == "/api/by_hand") return json_reply(plan_change_json(session_.by_hand()));
    if (path == "/api/events") return json_reply(view->events());
    if (path == "/api/plan" && !view->plan().empty()) return json_reply(view->plan());
  }
  return web::Reply{.status = 404, .body = "not here\n"};
}

}  // namespace tuina::app
