// SPDX-License-Identifier: Apache-2.0
// What browsers ask of the live page's server by HTTP, those who log in and out among them.
#include <future>
#include <nlohmann/json.hpp>

#include "apps/serve/finished_session.hpp"
#include "apps/serve/live_site.hpp"
#include "apps/serve/plan_change.hpp"
#include "apps/serve/shown_sentence.hpp"
#include "tuina/core/io/file.hpp"
#include "tuina/record/languages.hpp"
#include "tuina/web/login.hpp"

namespace tuina::app {
namespace {

using nlohmann::json;

Result<std::string> people_json(const KnownPeople& known) {
  const auto names = known.names();
  if (!names) return tl::unexpected(names.error());
  return json(*names).dump();
}

/// Of `POSITION/WHO`.
Result<std::string> remembered_json(const KnownPeople& known, const std::string& asked) {
  const std::size_t slash = asked.find('/');
  const std::string position = asked.substr(0, slash);
  if (slash == std::string::npos ||
      (position != "sitting" && position != "prone" && position != "auto"))
    return fail(Fault::bad_input, "a position and a pseudonym are asked for");
  std::optional<BodyPosture> lies;
  if (position == "sitting") lies = BodyPosture::sitting;
  if (position == "prone") lies = BodyPosture::prone;
  const auto found = known.find(asked.substr(slash + 1), lies);
  if (!found) return tl::unexpected(found.error());
  json items = json::array();
  for (const RememberedItem& item : found->items)
    items.push_back({{"kind", name_of(item.kind)}, {"said", shown_sentence(item.words)}});
  return json{
      {"sessions", found->sessions}, {"items", items}, {"changes", shown_sentence(found->changes)}}
      .dump();
}

}  // namespace

std::optional<web::Reply> LiveSite::answer(const web::Request& request) {
  constexpr int see_other = 303;
  const std::string who = request.from.empty() ? "browser" : "browser " + request.from;
  std::optional<web::Reply> reply;
  bool operates = false;
  {
    const std::lock_guard lock(mutex_);
    if (!access_) return web::Reply{.status = 503};
    const auto guest = access_->find_guest(request.cookie);
    operates = guest && guest->role == web::Role::operate;
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
  if (!reply && !logs_in) {
    reply = people(request.path, operates);
    if (reply && reply->status < 400) {
      const std::lock_guard lock(mutex_);
      note(who, "look up people", "done");
    }
  }
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

// Who has had sessions, and what is remembered of them, is for who may order the next one.
std::optional<web::Reply> LiveSite::people(const std::string& path, bool operates) const {
  constexpr std::string_view all = "/api/people", one = "/api/remembered/";
  const LiveSession::Options& sessions = options_.session;
  if (path == "/api/sessions" && operates && sessions.people.find)
    return web::Reply{.type = "application/json", .body = sessions_json(sessions.folder, true)};
  if (path != all && !path.starts_with(one)) return std::nullopt;
  if (!operates) return web::Reply{.status = 403, .body = "for who operates alone\n"};
  const KnownPeople& known = sessions.people;
  if (!known.find) return web::Reply{.status = 404, .body = "no history is kept here\n"};
  // The threads of the web's library have too little stack for databases.
  const auto text =
      std::async(std::launch::async, [&] {
        return path == all ? people_json(known) : remembered_json(known, path.substr(one.size()));
      }).get();
  if (!text) return web::Reply{.status = 404, .body = text.error().message + "\n"};
  return web::Reply{.type = "application/json", .body = *text};
}

// What lies in the folder of a finished session. The report in English lies there; in another
// language it is made anew.
std::optional<web::Reply> LiveSite::look_back(const web::Request& request) const {
  constexpr std::string_view in_language = "language=";
  const auto report = session_number(request.path, "/report.html");
  const auto play = session_number(request.path, "/play");
  if (!report && !play) return std::nullopt;
  const auto folder = LiveSession::folder_of(options_.session, report ? *report : *play);
  const std::string_view query = request.query;
  const bool other = query.starts_with(in_language) && query != "language=en";
  if (report && !other) return report_reply(read_file(folder / "report.html"));
  if (session_.state().phase == LivePhase::massage)
    return web::Reply{.status = 503,
                      .body = "a massage is running, which looking back must not disturb\n"};
  if (play) return play_of_session(folder);
  const auto language = record::find_language(query.substr(in_language.size()));
  if (!language) return web::Reply{.status = 404, .body = language.error().message + "\n"};
  return report_of_session(folder, *language);
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
  if (path == "/api/sessions") return json_reply(sessions_json(sessions.folder, false));
  if (const auto reply = look_back(request)) return *reply;
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
