// SPDX-License-Identifier: Apache-2.0
#include "tuina/web/access.hpp"

#include <doctest/doctest.h>

namespace tuina::web {
namespace {

constexpr int port = 8642;

Request get(std::string path, std::string cookie = "") {
  return {.method = "GET",
          .path = std::move(path),
          .host = "127.0.0.1:8642",
          .cookie = std::move(cookie)};
}

int status_of(Access& access, const Request& request, double now_s = 0.0) {
  const auto reply = access.judge(request, now_s);
  return reply ? reply->status : 200;
}

Request show(const std::string& token) {
  Request request = get("/");
  request.query = "token=" + token;
  return request;
}

/// The cookie that a fresh token is exchanged for.
std::string entered(Access& access) {
  const auto reply = access.judge(show(access.invite(Role::operate)), 0.0);
  REQUIRE(reply.has_value());
  REQUIRE(reply->status == 303);
  const std::string cookie = reply->headers.at(1).second;
  CHECK(cookie.find("HttpOnly; SameSite=Strict") != std::string::npos);
  return cookie.substr(0, cookie.find(';'));
}

TEST_CASE("tokens are 32 bytes and never the same") {
  CHECK(random_token().size() == 64);
  CHECK(random_token() != random_token());
  CHECK(same_secret("abc", "abc"));
  CHECK_FALSE(same_secret("abc", "abd"));
  CHECK_FALSE(same_secret("abc", "abcd"));
}

TEST_CASE("an address opens the page once, and its cookie many times") {
  Access access(port);
  const std::string token = access.invite(Role::operate);
  CHECK(status_of(access, show(token)) == 303);
  CHECK(status_of(access, show(token)) == 401);
  const std::string cookie = entered(access);
  CHECK(status_of(access, get("/page.js", cookie)) == 200);
  CHECK(status_of(access, get("/page.js", "other=1; " + cookie)) == 200);
  CHECK(status_of(access, get("/page.js", cookie + "0")) == 401);
  CHECK(status_of(access, get("/page.js")) == 401);
}

TEST_CASE("a link in another page, after which no browser shows the cookie, goes on by itself") {
  Access access(port);
  Request request = show(access.invite(Role::operate));
  request.fetch_site = "cross-site";
  const auto reply = access.judge(request, 0.0);
  REQUIRE(reply.has_value());
  CHECK(reply->status == 200);
  CHECK(reply->body.find("url=/") != std::string::npos);
  REQUIRE(reply->headers.size() == 1);
  CHECK(reply->headers[0].first == "Set-Cookie");
}

TEST_CASE("a browser leaves the port of its scheme out of the name") {
  Access access(80);
  Request request = get("/page.js");
  request.host = "127.0.0.1";
  CHECK(status_of(access, request) == 401);  // and not 403
}

TEST_CASE("who comes by an invitation is what it is for") {
  Access access(port);
  for (const Role role : {Role::watch, Role::operate}) {
    const auto reply = access.judge(show(access.invite(role)), 0.0);
    REQUIRE(reply.has_value());
    const std::string cookie = reply->headers.at(1).second;
    const auto guest = access.find_guest(cookie.substr(0, cookie.find(';')));
    REQUIRE(guest.has_value());
    CHECK(guest->role == role);
  }
  CHECK_FALSE(access.find_guest("tuina_8642=").has_value());
}

TEST_CASE("after five wrong tokens, guessing is slow; the right one still opens") {
  Access access(port);
  const std::string token = access.invite(Role::operate);
  for (int i = 0; i < 5; ++i) CHECK(status_of(access, show(random_token()), 1.0) == 401);
  CHECK(status_of(access, show(random_token()), 1.0) == 429);
  CHECK(status_of(access, show(random_token()), 14.0) == 401);
  CHECK(status_of(access, show(token), 14.0) == 303);
}

TEST_CASE("another name of this machine is refused, with a cookie or without") {
  Access access(port);
  const std::string cookie = entered(access);
  for (const char* host : {"", "evil.example", "evil.example:8642", "127.0.0.1", "127.0.0.1:80",
                           "127.0.0.1:8642.evil.example", "0.0.0.0:8642"}) {
    CAPTURE(host);
    Request request = get("/", cookie);
    request.host = host;
    CHECK(status_of(access, request) == 403);
  }
  Request request = get("/", cookie);
  request.host = "localhost:8642";
  CHECK(status_of(access, request) == 200);
}

TEST_CASE("another page may not ask, and a WebSocket must say which page opens it") {
  Access access(port);
  const std::string cookie = entered(access);
  for (const char* origin : {"http://evil.example", "null", "https://127.0.0.1:8642",
                             "http://127.0.0.1:80", "http://127.0.0.1:8642.evil.example"}) {
    CAPTURE(origin);
    Request request = get("/live", cookie);
    request.origin = origin;
    CHECK(status_of(access, request) == 403);
  }
  Request upgrade = get("/live", cookie);
  upgrade.upgrade = true;
  CHECK(status_of(access, upgrade) == 403);
  upgrade.origin = "http://127.0.0.1:8642";
  CHECK(status_of(access, upgrade) == 200);
}

TEST_CASE("nothing is posted, and a body is refused by the size it announces") {
  Access access(port);
  Request request = get("/", entered(access));
  request.method = "POST";
  CHECK(status_of(access, request) == 405);
  request.body_bytes = 2 << 20;
  CHECK(status_of(access, request) == 413);
}

TEST_CASE("no address but this machine's own is listened at") {
  CHECK(loopback_address("127.0.0.1").value() == "127.0.0.1");
  CHECK(loopback_address("localhost").value() == "127.0.0.1");
  // CivetWeb as Debian has it knows no IPv6; the door to a network does.
  for (const char* address :
       {"0.0.0.0", "::", "::1", "192.168.0.7", "", "127.0.0.1.evil.example"}) {
    CAPTURE(address);
    REQUIRE_FALSE(loopback_address(address).has_value());
    CHECK(loopback_address(address).error().fault == Fault::usage);
  }
}

}  // namespace
}  // namespace tuina::web
