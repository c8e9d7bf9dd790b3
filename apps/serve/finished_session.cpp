// SPDX-License-Identifier: Apache-2.0
#include "apps/serve/finished_session.hpp"

#include <algorithm>
#include <atomic>
#include <bit>
#include <cstring>
#include <functional>
#include <future>
#include <mutex>

#include "apps/serve/page_files.hpp"
#include "apps/serve/record_player.hpp"
#include "apps/serve/shown_arm.hpp"
#include "apps/serve/shown_back.hpp"
#include "apps/serve/shown_sentence.hpp"
#include "tuina/core/io/file.hpp"
#include "tuina/core/io/surface_file.hpp"
#include "tuina/record/acupoint_file.hpp"
#include "tuina/record/plan_file.hpp"
#include "tuina/record/session_folder.hpp"
#include "tuina/record/session_report.hpp"
#include "tuina/session/run.hpp"
#include "tuina/telemetry/report/page.hpp"

namespace tuina::app {
namespace {

using nlohmann::json;
using Path = std::filesystem::path;

constexpr std::uintmax_t max_record_bytes = std::uintmax_t{512} << 20;

/// What is attached to a record, read.
struct Attached {
  record::SessionFile file;
  massage::Plan plan;
  record::MappedBack map;
  PointCloud scan_in_couch;
};

Result<Attached> attached_in(const Path& folder) {
  const std::string name = (folder / "session.json").string();
  const auto text = read_file(name);
  if (!text) return tl::unexpected(text.error());
  auto file = record::parse_session(*text, name);
  if (!file) return tl::unexpected(file.error());
  auto plan = record::read_plan(folder / "plan.json");
  if (!plan) return tl::unexpected(plan.error());
  auto map = record::read_acupoints(folder / "acupoints.json");
  if (!map) return tl::unexpected(map.error());
  auto scan = read_surface(folder / "scan.ply");
  if (!scan) return tl::unexpected(scan.error());
  for (const record::PerformedEntry& done : file->massage.performed) {
    if (done.path >= plan->plan.paths.size())
      return fail(Fault::bad_input, "{}: path {} was performed, which plan.json does not have",
                  name, done.path);
  }
  return Attached{std::move(*file), std::move(plan->plan), std::move(*map), std::move(scan->cloud)};
}

json performed_of(const record::SessionFile& file) {
  json performed = json::array();
  for (const record::PerformedEntry& done : file.massage.performed) {
    json& shown = performed.emplace_back(json{{"path", done.path},
                                              {"arm", name_of(done.arm)},
                                              {"begin_s", rounded(done.begin_s, 10.0)},
                                              {"end_s", rounded(done.end_s, 10.0)},
                                              {"ordered_n", rounded(done.ordered_n, 10.0)},
                                              {"given_n", rounded(done.compared_n(), 10.0)},
                                              {"why", shown_sentence(done.told_why())}});
    if (!done.lowered_by.empty()) {
      shown["programme_n"] = rounded(done.programme_n, 10.0);
      shown["lowered_by"] = shown_sentence(done.lowered_by);
    }
  }
  return performed;
}

json events_of(const Attached& session, const std::vector<double>& stiffness_n_per_m) {
  const record::SessionFile& file = session.file;
  std::vector<json> events;
  const auto keep = [&](double time_s, json event) {
    event["time_s"] = rounded(time_s, 10.0);
    events.push_back(std::move(event));
  };
  for (std::size_t i = 0; i < file.massage.performed.size(); ++i) {
    const record::PerformedEntry& done = file.massage.performed[i];
    json ended{{"what", "ended"}, {"path", done.path}, {"whole", done.contact_fault == "none"}};
    if (stiffness_n_per_m[i] > 0.0)
      ended["stiffness_n_per_mm"] = rounded(1e-3 * stiffness_n_per_m[i], 100.0);
    keep(done.end_s, std::move(ended));
  }
  for (const telemetry::SteeringDecision& made : file.decisions) {
    keep(made.time_s, {{"what", "decision"},
                       {"path", index_of(session.plan, made.path)},
                       {"reason", shown_sentence({.words = made.reason, .key = made.key})},
                       {"from_n", rounded(made.from_n, 10.0)},
                       {"to_n", rounded(made.to_n, 10.0)}});
  }
  for (const auto& [time_s, command] : file.order.commands)
    keep(time_s, {{"what", "command"}, {"name", name_of(command)}});
  for (const telemetry::Stop& stop : file.stops)
    keep(stop.time_s, {{"what", "stop"}, {"reason", shown_sentence(stop.cause)}});
  std::stable_sort(events.begin(), events.end(),
                   [](const json& a, const json& b) { return a["time_s"] < b["time_s"]; });
  return events;
}

/// The answer, from a record whose attachments lie in `unpacked`.
Result<std::string> play_of(const Path& mcap, const Path& unpacked) {
  auto session = attached_in(unpacked);
  if (!session) return tl::unexpected(session.error());
  const record::SessionFile& file = session->file;
  const auto robot = robot::load_robot(file.order.robot);
  if (!robot) return tl::unexpected(robot.error());
  RecordPlayer player(
      file, session->plan,
      robot::place_robot(*robot, file.position, session::head_at_plus_y(session->map.acupoints)));
  const auto record = record::read_record_file(
      mcap, [&](const auto& contents, const auto& message) { player.take(contents, message); });
  if (!record) return tl::unexpected(record.error());
  const std::string back =
      back_bytes(session->scan_in_couch, session->map.acupoints, session->map.landmarks);
  const auto size = static_cast<std::uint32_t>(back.size());
  static_assert(std::endian::native == std::endian::little);
  std::string bytes(sizeof size, '\0');
  std::memcpy(bytes.data(), &size, sizeof size);
  const json shown{{"duration_s", file.massage.duration_s},
                   {"programme", file.order.programme},
                   {"map", json::parse(map_json(file.position, session->map.acupoints))},
                   {"plan", json::parse(plan_json(session->plan))},
                   {"performed", performed_of(file)},
                   {"events", events_of(*session, player.stiffness_n_per_m())},
                   {"lost", record->contents.lost},
                   {"forces", player.forces()},
                   {"frames", player.frames()}};
  return bytes + back + shown.dump(-1, ' ', true, json::error_handler_t::replace);
}

Result<std::string> play_of(const Path& mcap) {
  std::error_code none;
  if (!std::filesystem::is_regular_file(mcap, none)) {
    return fail(Fault::file, "{}: is not there, so the session did not come to its end",
                mcap.string());
  }
  if (const auto bytes = std::filesystem::file_size(mcap, none); bytes > max_record_bytes) {
    return fail(Fault::bad_input, "{}: {} bytes, at most {} are played here", mcap.string(), bytes,
                max_record_bytes);
  }
  const auto session = record::SessionFolder::open(mcap);
  if (!session) return tl::unexpected(session.error());
  auto play = play_of(mcap, session->path());
  if (!play) return tl::unexpected(session->explained(play.error()));
  return play;
}

Result<std::string> report_in(const Path& folder, const Language& language) {
  auto data = record::read_record(folder);
  if (!data) return tl::unexpected(data.error());
  data->language = language;
  return telemetry::report_page(*data);
}

/// What `make` reads of a session, one session at a time. Two may wait for it, as a page does that
/// is drawn twice; nothing for more, so that the threads of the server stay free for a STOP.
std::optional<Result<std::string>> read_alone(const std::function<Result<std::string>()>& make) {
  constexpr int max_waiting = 2;
  static std::mutex one;
  static std::atomic<int> here = 0;
  const struct Place {
    Place() : number(++here) {}
    ~Place() { --here; }
    int number;
  } place;
  if (place.number > 1 + max_waiting) return std::nullopt;
  const std::lock_guard lock(one);
  // The threads of the web's library have 100 kB of stack, too little for the readers of a record.
  return std::async(std::launch::async, make).get();
}

const web::Reply another_is_read{.status = 503, .body = "another session is being read\n"};

}  // namespace

web::Reply play_of_session(const Path& folder) {
  auto play = read_alone([&] { return play_of(folder / "session.mcap"); });
  if (!play) return another_is_read;
  if (!*play) return {.status = 404, .body = play->error().message + "\n"};
  return {.type = "application/octet-stream", .body = std::move(**play)};
}

web::Reply report_of_session(const Path& folder, const Language& language) {
  auto report = read_alone([&] { return report_in(folder, language); });
  return report ? report_reply(std::move(*report)) : another_is_read;
}

}  // namespace tuina::app
