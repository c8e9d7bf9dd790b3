// SPDX-License-Identifier: Apache-2.0
#include "tuina/web/password.hpp"

#include <doctest/doctest.h>

#include "tests/folder.hpp"
#include "tuina/core/io/file.hpp"
#include "tuina/web/access.hpp"
#include "tuina/web/login.hpp"

namespace tuina::web {
namespace {

namespace fs = std::filesystem;
constexpr const char* right = "eleven slow hands";

fs::path written(const test::Folder& folder, const std::string& text) {
  const fs::path file = folder / "password";
  REQUIRE(write_file(file, text).has_value());
  fs::permissions(file, fs::perms::owner_read | fs::perms::owner_write);
  return file;
}

Access network() {
  return {8642, {"robot.test", "[::1]"}};
}

Request ask(const char* method, std::string path) {
  return {.method = method,
          .path = std::move(path),
          .host = "robot.test:8642",
          .origin = "https://robot.test:8642"};
}

int answer(Access& access, const Request& request, double now_s = 0.0) {
  const auto reply = access.judge(request, now_s);
  return reply ? reply->status : 200;
}

TEST_CASE("a password is known by its line, which does not have it, and never twice the same") {
  const auto made = Password::make(right);
  REQUIRE(made.has_value());
  CHECK(made->line().find("slow") == std::string::npos);
  CHECK(made->line() != Password::make(right)->line());
  const auto read = Password::parse(made->line());
  REQUIRE(read.has_value());
  CHECK(read->matches(right));
  for (const char* wrong : {"", "eleven slow hand", "eleven slow hands ", "Eleven slow hands"})
    CHECK_FALSE(read->matches(wrong));
  CHECK_FALSE(read->matches(std::string(max_password_bytes + 1, 'x')));
}

TEST_CASE("a password is neither short nor endless") {
  CHECK_FALSE(Password::make(std::string(min_password_bytes - 1, 'x')).has_value());
  CHECK(Password::make(std::string(min_password_bytes, 'x')).has_value());
  CHECK_FALSE(Password::make(std::string(max_password_bytes + 1, 'x')).has_value());
}

TEST_CASE("a file has one password for operators, and may have one for viewers") {
  const test::Folder folder;
  Passwords passwords{.operators = *Password::make(right)};
  const auto one = Passwords::read(written(folder, passwords.text()));
  REQUIRE(one.has_value());
  CHECK(one->role_of(right) == Role::operate);
  CHECK_FALSE(one->role_of("twelve quiet eyes").has_value());
  passwords.viewers = *Password::make("twelve quiet eyes");
  const auto two = Passwords::read(written(folder, passwords.text()));
  REQUIRE(two.has_value());
  CHECK(two->role_of(right) == Role::operate);
  CHECK(two->role_of("twelve quiet eyes") == Role::watch);
  CHECK_FALSE(two->role_of("viewers twelve quiet eyes").has_value());
}

TEST_CASE("a password file is whole lines that not everybody may read") {
  const test::Folder folder;
  const std::string line = Password::make(right)->line() + "\n";
  std::string other = line;
  other[other.size() - 2] = 'g';
  for (const std::string& text :
       {std::string(), std::string(right), line + line, line.substr(1),
        line.substr(0, line.size() - 2), other, "viewers " + line, line + "viewers " + other,
        line + "viewers " + line + "\n", line + "viewers ", line + "viewers " + line + line})
    CHECK(Passwords::read(written(folder, text)).error().fault == Fault::bad_input);
  const fs::path file = written(folder, line);
  fs::permissions(file, fs::perms::others_read, fs::perm_options::add);
  CHECK(Passwords::read(file).error().fault == Fault::bad_input);
  CHECK(Passwords::read(folder / "nowhere").error().fault == Fault::file);
}

TEST_CASE("a form's password is decoded, and whatever is no password is none") {
  CHECK(password_of("password=a+b%26c%E6%8E%A8") == "a b&c\xE6\x8E\xA8");
  CHECK(password_of("other=1&password=abc") == "abc");
  for (const char* form : {"", "password", "password=", "passwort=abc", "%"})
    CHECK(password_of(form).empty());
  CHECK(password_of("password=" + std::string(3000, 'x')).empty());
}

TEST_CASE("to a network only the hosts of the certificate answer, and their own pages ask") {
  Access access = network();
  CHECK(answer(access, ask("POST", login_path)) == 200);
  for (const char* host : {"127.0.0.1:8642", "localhost:8642", "robot.test", "robot.test:80", ""}) {
    CAPTURE(host);
    Request request = ask("POST", login_path);
    request.host = host;
    CHECK(answer(access, request) == 403);
  }
  for (const char* origin : {"", "null", "http://robot.test:8642", "https://evil.test:8642"}) {
    CAPTURE(origin);
    Request request = ask("POST", login_path);
    request.origin = origin;
    CHECK(answer(access, request) == 403);
  }
  CHECK(answer(access, ask("POST", "/api/choices")) == 405);
  CHECK(answer(access, ask("GET", "/")) == 401);
}

TEST_CASE("the port that browsers leave out is no part of a host's name") {
  Access access(443, {"robot.test"});
  Request request = ask("GET", "/");
  request.host = "robot.test";
  request.origin = "https://robot.test";
  CHECK(answer(access, request) == 401);
}

TEST_CASE("a cookie of the network goes by TLS alone, and is nothing after its owner has left") {
  Access access = network();
  const std::string said = access.let_in(Role::operate).headers.at(1).second;
  CHECK(said.starts_with("__Host-tuina_8642="));
  CHECK(said.find("; HttpOnly; SameSite=Strict; Path=/; Secure") != std::string::npos);
  Request request = ask("GET", "/page.js");
  request.cookie = said.substr(0, said.find(';'));
  CHECK(answer(access, request) == 200);
  Request leave = request;
  leave.method = "POST";
  leave.path = logout_path;
  CHECK(answer(access, leave) == 303);
  CHECK(answer(access, request) == 401);
  CHECK(answer(access, leave) == 405);
}

TEST_CASE("after five wrong passwords a minute nobody's is looked at; right ones do not count") {
  Access access = network();
  const Request request = ask("POST", login_path);
  for (int i = 0; i < 50; ++i) {
    REQUIRE(answer(access, request) == 200);
    (void)access.let_in(Role::operate);
  }
  for (int i = 0; i < 5; ++i) CHECK(answer(access, request) == 200);
  CHECK(answer(access, request, 1.0) == 429);
  CHECK(answer(access, request, 14.0) == 200);
  CHECK(answer(access, request, 15.0) == 429);
}

}  // namespace
}  // namespace tuina::web
