// SPDX-License-Identifier: Apache-2.0
#include "apps/serve/live_picture.hpp"

#include <fmt/format.h>

#include <mutex>
#include <optional>

#include "apps/cli/say.hpp"
#include "apps/serve/page_port.hpp"
#include "tuina/core/io/png.hpp"
#include "tuina/core/stopwatch.hpp"
#include "tuina/web/access.hpp"
#include "tuina/web/server.hpp"

namespace tuina::app {
namespace {

constexpr const char* page_html =
    R"(<!doctype html><html lang="en"><meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>tuina: what the camera sees</title><link rel="stylesheet" href="/page.css">
<main><img id="picture" alt="What the camera sees">
<p id="told" role="status">Waiting for the first picture.</p></main>
<script src="/page.js"></script></html>
)";

// The words are large: who reads them stands before the camera, not at the screen.
constexpr const char* page_css =
    R"(html{background:#101417;color:#f4f1ea;font:1rem/1.4 system-ui,sans-serif}
body{margin:0}
main{display:grid;grid-template-rows:1fr auto;height:100vh;height:100dvh}
img{min-height:0;min-width:0;width:100%;height:100%;object-fit:contain}
img:not([src]){visibility:hidden}
p{margin:0;padding:.6em 1em;font-size:clamp(1.3rem,3.4vw,2.6rem);background:#1d2429;min-height:2.8em}
)";

constexpr const char* page_js =
    R"(const picture = document.getElementById("picture"), told = document.getElementById("told");
const pause_ms = 80;
async function look() {
  try {
    const [words, image] = await Promise.all([fetch("/told"), fetch("/picture.png")]);
    if (words.ok && image.ok) {
      const said = await words.text();
      if (told.textContent !== said) told.textContent = said;
      const before = picture.src;
      picture.src = URL.createObjectURL(await image.blob());
      if (before) URL.revokeObjectURL(before);
    }
  } catch {
    told.textContent = "The program has ended.";
    picture.removeAttribute("src");
  }
  setTimeout(look, pause_ms);
}
look();
)";

// The picture is made by the script, of what it has fetched.
const std::vector<std::pair<std::string, std::string>> policy = {
    {"Content-Security-Policy",
     "default-src 'none'; script-src 'self'; style-src 'self'; img-src blob:; connect-src 'self'; "
     "base-uri 'none'; form-action 'none'; frame-ancestors 'none'"}};

}  // namespace

class LivePicture::Page {
 public:
  static Result<std::unique_ptr<Page>> open(int port) {
    auto page = std::make_unique<Page>();
    Page* self = page.get();
    auto server = web::Server::start(
        {.port = port},
        {.answer = [self](const web::Request& request) { return self->answer(request); },
         .come = [](auto, const auto&) {},
         .go = [](auto) {},
         .hear = [](auto, const auto&) {},
         .hear_program = [](auto, const auto&) {},
         .say_too_much = [](auto) {}});
    if (!server) return tl::unexpected(server.error());
    const std::lock_guard lock(page->mutex_);
    page->server_ = std::move(*server);
    page->access_.emplace(page->server_->port());
    return page;
  }

  std::string address() {
    const std::lock_guard lock(mutex_);
    return fmt::format("http://127.0.0.1:{}/?token={}", server_->port(),
                       access_->invite(web::Role::watch));
  }

  void show(Image picture, std::string told) {
    const std::lock_guard lock(mutex_);
    picture_ = std::move(picture);
    told_ = std::move(told);
  }

 private:
  web::Reply answer(const web::Request& request) {
    Image picture;
    {
      const std::lock_guard lock(mutex_);
      if (!access_) return {.status = 503};
      if (auto refused = access_->judge(request, clock_.seconds())) return *refused;
      if (request.upgrade) return {.status = 404};
      if (request.path == "/")
        return {.type = "text/html; charset=utf-8", .body = page_html, .headers = policy};
      if (request.path == "/page.css") return {.type = "text/css", .body = page_css};
      if (request.path == "/page.js") return {.type = "text/javascript", .body = page_js};
      if (picture_.data.empty()) return {.status = 404};
      if (request.path == "/told") return {.body = told_};
      if (request.path != "/picture.png") return {.status = 404};
      picture = picture_;
    }
    return {.type = "image/png", .body = to_png(picture)};  // the camera waits for no packing
  }

  const Stopwatch clock_{};
  std::mutex mutex_;
  std::optional<web::Access> access_;
  Image picture_;
  std::string told_;
  std::unique_ptr<web::Server> server_;  // the first to go: it asks the others
};

LivePicture::LivePicture() = default;
LivePicture::~LivePicture() = default;

Option LivePicture::describe(Options& options, const char* shown) {
  auto live = options.flag("--live", asked_, shown);
  add_page_port(options, port_, &live);
  return live;
}

Result<void> LivePicture::begin() {
  if (!asked_) return {};
  auto page = Page::open(port_);
  if (!page) return tl::unexpected(page.error());
  page_ = std::move(*page);
  say(fmt::format("{}\n", page_->address()));
  return {};
}

void LivePicture::show(Image picture, std::string told) {
  if (page_) page_->show(std::move(picture), std::move(told));
}

}  // namespace tuina::app
