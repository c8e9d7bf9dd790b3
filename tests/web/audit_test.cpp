// SPDX-License-Identifier: Apache-2.0
#include "tuina/web/audit.hpp"

#include <doctest/doctest.h>

#include <nlohmann/json.hpp>

#include "tests/folder.hpp"
#include "tuina/core/io/file.hpp"
#include "tuina/web/outbox.hpp"

namespace tuina::web {
namespace {

/// The text of a log of three lines.
std::string three_lines(const test::Folder& folder) {
  auto log = AuditLog::open(folder / "audit.log");
  REQUIRE(log.has_value());
  for (const char* what : {"start", "arm", "stop"})
    REQUIRE(log->add({.who = "page 1", .what = what, .phase = "idle", .outcome = "done"}, 0.0));
  return read_file(folder / "audit.log").value();
}

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  for (std::size_t at = 0; at < text.size(); at = text.find('\n', at) + 1)
    lines.push_back(text.substr(at, text.find('\n', at) - at + 1));
  return lines;
}

TEST_CASE("a log is a chain that goes on where it ended") {
  const test::Folder folder;
  const std::string text = three_lines(folder);
  CHECK(check_audit(text, "log").value().lines == 3);
  const std::string more = three_lines(folder);
  CHECK(more.starts_with(text));
  CHECK(check_audit(more, "log").value().lines == 6);
  CHECK(nlohmann::json::parse(lines_of(more)[4])["line"] == 5);
}

TEST_CASE("a line that was changed, left out, added or moved is found by its number") {
  const test::Folder folder;
  const std::string text = three_lines(folder);
  const auto lines = lines_of(text);
  std::string changed = text;
  changed.replace(changed.find("arm"), 3, "ARM");
  const auto first_bad = [](const std::string& log) {
    const auto checked = check_audit(log, "log");
    return checked ? std::string() : checked.error().message.substr(0, 6);
  };
  CHECK(first_bad(changed) == "log:2:");
  CHECK(first_bad(lines[0] + lines[2]) == "log:2:");
  CHECK(first_bad(lines[1] + lines[2]) == "log:1:");
  CHECK(first_bad(lines[0] + lines[0] + lines[1] + lines[2]) == "log:2:");
  CHECK(first_bad(lines[1] + lines[0] + lines[2]) == "log:1:");
  CHECK(first_bad(text + "{}\n") == "log:4:");
  CHECK(first_bad(text.substr(0, text.size() - 1)) == "log:3:");
}

TEST_CASE("every single byte of a log counts") {
  const test::Folder folder;
  const std::string text = three_lines(folder);
  for (std::size_t i = 0; i < text.size(); ++i) {
    std::string changed = text;
    changed[i] = static_cast<char>(changed[i] ^ 1);
    CAPTURE(i);
    CHECK_FALSE(check_audit(changed, "log").has_value());
  }
}

TEST_CASE("a file of somebody else is no log whose line was torn: it is refused, and stays") {
  const test::Folder folder;
  REQUIRE(write_file(folder / "audit.log", "my own notes, without an end of line").has_value());
  CHECK_FALSE(AuditLog::open(folder / "audit.log").has_value());
  CHECK(read_file(folder / "audit.log").value() == "my own notes, without an end of line");
}

TEST_CASE("a broken log is not gone on with") {
  const test::Folder folder;
  std::string text = three_lines(folder);
  text[10] = 'x';
  REQUIRE(write_file(folder / "audit.log", text));
  CHECK_FALSE(AuditLog::open(folder / "audit.log").has_value());
}

TEST_CASE(
    "a line that a killed server left half written is cut off and told; two servers are not one") {
  const test::Folder folder;
  const std::string text = three_lines(folder);
  REQUIRE(write_file(folder / "audit.log", text + "{\"line\":4,").has_value());
  {
    auto log = AuditLog::open(folder / "audit.log");
    REQUIRE(log.has_value());
    const auto second = AuditLog::open(folder / "audit.log");
    REQUIRE_FALSE(second.has_value());
    CHECK(second.error().message.find("another server writes there") != std::string::npos);
    REQUIRE(log->add({.who = "page 1", .what = "come", .phase = "idle", .outcome = "done"}, 1.0));
  }
  const auto now = read_file(folder / "audit.log");
  REQUIRE(now.has_value());
  CHECK(now->starts_with(text));
  CHECK(now->find("\"torn_bytes\":10") != std::string::npos);
  CHECK(check_audit(*now, "log").value().lines == 4);
}

TEST_CASE("a flood of refusals is counted, not written") {
  const test::Folder folder;
  auto log = AuditLog::open(folder / "audit.log");
  REQUIRE(log.has_value());
  for (int i = 0; i < 5000; ++i)
    REQUIRE(log->add_refused({.who = "browser", .what = "request", .outcome = "401"}, 1.0));
  REQUIRE(log->add({.who = "page 1", .what = "stop", .outcome = "done"}, 1.0));
  const auto lines = lines_of(read_file(folder / "audit.log").value());
  CHECK(lines.size() == 201);
  CHECK(nlohmann::json::parse(lines.back())["left_out"] == 4800);
}

TEST_CASE("what a page says of itself cannot forge a line") {
  const test::Folder folder;
  {
    auto log = AuditLog::open(folder / "audit.log");
    REQUIRE(
        log->add({.who = "x\"}\n{\"line\":2", .what = "\xff\xfe", .outcome = "\"hash\":\"0"}, 0.0));
  }
  CHECK(check_audit(read_file(folder / "audit.log").value(), "log").value().lines == 1);
}

TEST_CASE("a client that reads slowly is told the newest, and replies in their order") {
  Outbox outbox;
  constexpr Outbox::Slot state = 1, live = 2, events = 3;
  for (const char* text : {"1", "2", "3"}) outbox.put(live, {.bytes = text});
  for (const char* text : {"x", "y", "z"}) outbox.put(events, {.bytes = text}, 2);
  outbox.put(state, {.bytes = "s"});
  CHECK(outbox.reply({.bytes = "a"}));
  CHECK(outbox.reply({.bytes = "b"}));
  // Each slot has its turn, so that none waits for one that is always full.
  for (const char* text : {"a", "b", "s", "3", "y"}) CHECK(outbox.take().value().bytes == text);
  outbox.put(state, {.bytes = "t"});
  for (const char* text : {"t", "z"}) CHECK(outbox.take().value().bytes == text);
  outbox.put(live, {.bytes = "4"});
  outbox.drop(live);
  bool taken = true;
  for (int i = 0; i < 1000; ++i) taken = taken && outbox.reply({.bytes = "r"});
  CHECK_FALSE(taken);
  for (int i = 0; i < 64; ++i) CHECK(outbox.take().value().bytes == "r");
  outbox.put(state, {.bytes = "u"});
  CHECK(outbox.take().value().bytes == "u");
  outbox.close();
  CHECK_FALSE(outbox.take().has_value());
}

}  // namespace
}  // namespace tuina::web
