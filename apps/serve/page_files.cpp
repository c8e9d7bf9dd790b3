// SPDX-License-Identifier: Apache-2.0
#include "apps/serve/page_files.hpp"

#include <fmt/chrono.h>

#include <algorithm>
#include <chrono>
#include <nlohmann/json.hpp>
#include <vector>

#include "apps/serve/packed_page.hpp"
#include "tuina/core/io/file.hpp"
#include "tuina/record/session_file.hpp"
#include "tuina/web/digest.hpp"

namespace tuina::app {
namespace {

using nlohmann::json;

constexpr std::size_t max_page_bytes = 16 << 20;

// Nothing of a page comes from elsewhere, and nothing is written into it.
const std::pair<std::string, std::string> page_policy = {
    "Content-Security-Policy",
    "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data:; connect-src "
    "'self'; frame-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'"};
// A report has its style within it, and no script.
const std::pair<std::string, std::string> report_policy = {
    "Content-Security-Policy",
    "default-src 'none'; style-src 'unsafe-inline'; img-src data:; base-uri 'none'; form-action "
    "'none'; frame-ancestors 'self'; sandbox"};

constexpr const char* not_built =
    "<!doctype html><meta charset=utf-8><title>tuina</title>"
    "<h1>The page is not built</h1><p>The server runs, but the page that it shows is not in it. "
    "<code>./run serve</code> builds it, puts it in and starts the server.</p>";

bool is_number(std::string_view name) {
  return name.size() >= 4 && name.size() <= 6 &&
         std::all_of(name.begin(), name.end(),
                     [](char letter) { return letter >= '0' && letter <= '9'; });
}

/// A session as the list has it; null where its folder cannot be read.
json session_json(const std::filesystem::path& folder, bool names) {
  const std::filesystem::path path = folder / "session.json";
  const auto text = read_file(path);
  const auto file =
      text ? record::parse_session(*text, path.string()) : tl::unexpected(text.error());
  std::error_code fault;
  const auto written = std::filesystem::last_write_time(path, fault);
  if (!file || fault) return {};
  const auto second =
      std::chrono::time_point_cast<std::chrono::seconds>(std::chrono::file_clock::to_sys(written));
  json shown{{"ended", fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(second))},
             {"person", file->order.person},
             {"position", name_of(file->position)},
             {"programme", file->order.programme},
             {"seed", file->seed},
             {"duration_s", file->massage.duration_s},
             {"peak_n", file->massage.force.peak_n},
             {"performed", file->massage.performed.size()},
             {"paths", file->plan.paths},
             {"stops", file->stops.size()}};
  if (names && file->visit) shown["who"] = file->visit->who;
  return shown;
}

}  // namespace

Page read_page(const std::filesystem::path& folder) {
  Page page;
  const std::pair<const char*, const char*> files[] = {
      {"index.html", "text/html; charset=utf-8"},
      {"page.js", "text/javascript; charset=utf-8"},
      {"page.css", "text/css; charset=utf-8"},
      {"icon.svg", "image/svg+xml"}};
  for (const auto& [name, type] : files) {
    const bool ours = folder.empty();
    std::string gzip(ours ? packed_page(name) : std::string_view());
    if (!ours) gzip = read_file(folder / (std::string(name) + ".gz"), max_page_bytes).value_or("");
    auto text = ours ? unpacked(gzip) : read_file(folder / name, max_page_bytes);
    if (!text || text->empty()) continue;
    const std::string tag = fmt::format("W/\"{}\"", web::sha256(*text));
    page[std::string("/") + name] = {
        .reply = {.type = type,
                  .body = std::move(*text),
                  .cache = "private, no-cache",
                  .headers = {page_policy, {"ETag", tag}, {"Vary", "Accept-Encoding"}}},
        .gzip = std::move(gzip)};
  }
  const auto index = page.find("/index.html");
  const bool whole = index != page.end() && page.contains("/page.js");
  page["/"] = whole ? index->second
                    : PageFile{.reply = {.status = 503,
                                         .type = "text/html; charset=utf-8",
                                         .body = not_built,
                                         .headers = {page_policy}},
                               .gzip = ""};
  return page;
}

web::Reply reply_of(const PageFile& file, const web::Request& request) {
  web::Reply reply = file.reply;
  const auto tag = std::find_if(reply.headers.begin(), reply.headers.end(),
                                [](const auto& header) { return header.first == "ETag"; });
  if (tag != reply.headers.end() && request.known_tags.find(tag->second) != std::string::npos) {
    reply.status = 304;
    reply.body.clear();
    return reply;
  }
  const std::string_view takes = request.encodings;
  const bool packed = takes.find("gzip") != takes.npos && takes.find("gzip;q=0") == takes.npos;
  if (packed && !file.gzip.empty()) {
    reply.body = file.gzip;
    reply.headers.emplace_back("Content-Encoding", "gzip");
  }
  return reply;
}

std::optional<std::string> session_number(std::string_view path, std::string_view name) {
  constexpr std::string_view before = "/sessions/";
  if (!path.starts_with(before) || !path.ends_with(name)) return std::nullopt;
  path.remove_prefix(before.size());
  if (path.size() < name.size()) return std::nullopt;
  path.remove_suffix(name.size());
  return is_number(path) ? std::optional(std::string(path)) : std::nullopt;
}

std::string sessions_json(const std::filesystem::path& folder, bool names) {
  std::vector<std::string> numbers;
  std::error_code none;
  for (const auto& entry : std::filesystem::directory_iterator(folder, none)) {
    const std::string name = entry.path().filename().string();
    if (is_number(name) && std::filesystem::exists(entry.path() / "report.html", none))
      numbers.push_back(name);
  }
  const auto value = [](const std::string& number) { return std::pair(number.size(), number); };
  std::ranges::sort(numbers, std::greater(), value);
  const std::size_t count = numbers.size();
  constexpr std::size_t max_shown = 50;
  if (numbers.size() > max_shown) numbers.resize(max_shown);
  json sessions = json::array();
  for (const std::string& number : numbers) {
    if (json one = session_json(folder / number, names); !one.is_null()) {
      one["session"] = number;
      sessions.push_back(std::move(one));
    }
  }
  return json{{"sessions", sessions}, {"count", count}}.dump(-1, ' ', true,
                                                             json::error_handler_t::replace);
}

web::Reply report_reply(Result<std::string> report) {
  if (!report) return {.status = 404, .body = "not here\n"};
  return web::Reply{
      .type = "text/html; charset=utf-8", .body = std::move(*report), .headers = {report_policy}};
}

}  // namespace tuina::app
