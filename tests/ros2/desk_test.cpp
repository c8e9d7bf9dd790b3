// SPDX-License-Identifier: Apache-2.0
#include <doctest/doctest.h>

#include <condition_variable>
#include <deque>
#include <mutex>

#include "apps/simulated/ros2_desk.hpp"
#include "tests/folder.hpp"
#include "tests/reason.hpp"
#include "tuina/core/io/file.hpp"
#include "tuina/web/foxglove.hpp"

using namespace tuina;
using app::Ros2Desk;
using session::LiveCommand;
using web::Ask;

namespace {

/// What came and what was answered, without DDS.
struct Wire {
  std::mutex mutex;
  std::condition_variable changed;
  std::deque<ros2::Request> requests;
  std::vector<std::pair<std::size_t, std::string>> answers;  ///< service and message
};

struct FakeServices final : ros2::Services {
  explicit FakeServices(Wire& to) : wire(to) {}
  std::optional<ros2::Request> next(double timeout_s) override {
    std::unique_lock lock(wire.mutex);
    wire.changed.wait_for(lock, std::chrono::duration<double>(timeout_s),
                          [&] { return !wire.requests.empty(); });
    if (wire.requests.empty()) return std::nullopt;
    auto request = wire.requests.front();
    wire.requests.pop_front();
    return request;
  }
  void answer(const ros2::Request& request, bool success, const std::string& message) override {
    const std::lock_guard lock(wire.mutex);
    CHECK(success == (message == "done"));
    wire.answers.emplace_back(request.service, message);
    wire.changed.notify_all();
  }
  Wire& wire;
};

struct FakeNode final : ros2::Node {
  std::uint16_t add_channel(const record::ChannelDescription&) override { return 1; }
  void write(std::uint16_t, std::uint64_t, std::string_view) override {}
  [[nodiscard]] ros2::Traffic traffic() const override { return {}; }
  void begin_session() override {}
  Result<std::unique_ptr<ros2::Services>> offer(std::span<const std::string> names) override {
    offered.assign(names.begin(), names.end());
    return std::make_unique<FakeServices>(wire);
  }
  Wire wire;
  std::vector<std::string> offered;
};

/// A desk, and the session that it steers.
struct Room {
  explicit Room(ros2::Reach reach = ros2::Reach::host) {
    auto opened = Ros2Desk::open(node, reach, folder / "audit.log");
    REQUIRE_MESSAGE(opened.has_value(), test::reason(opened));
    desk = std::move(*opened);
    attendant = desk->attendant();
  }
  static std::size_t index_of(Ask ask) {
    const auto& all = web::foxglove::services;
    return static_cast<std::size_t>(std::find(all.begin(), all.end(), ask) - all.begin());
  }
  /// What is answered to a request; empty: nothing within two seconds.
  std::string ask(const std::string& from, Ask what, double age_s = 0.0, bool whole = true) {
    std::unique_lock lock(node.wire.mutex);
    node.wire.answers.clear();
    node.wire.requests.push_back({.service = index_of(what), .from = from, .age_s = age_s});
    if (whole) node.wire.requests.back().call = ros2::CallId{};
    node.wire.changed.notify_all();
    node.wire.changed.wait_for(lock, std::chrono::seconds(2),
                               [&] { return !node.wire.answers.empty(); });
    return node.wire.answers.empty() ? "" : node.wire.answers.front().second;
  }
  std::optional<LiveCommand> command() { return attendant.commands(0.0); }
  std::string log() { return read_file(folder / "audit.log", 1'000'000).value(); }

  test::Folder folder;
  FakeNode node;
  std::unique_ptr<Ros2Desk> desk;
  app::Attendant attendant;
};

}  // namespace

TEST_CASE("who has taken control steers, and the session does it in that order") {
  Room room;
  CHECK_FALSE(room.command().has_value());  // the massage runs
  CHECK(room.ask("anna", Ask::pause) == "viewer");
  CHECK(room.ask("anna", Ask::operate) == "done");
  CHECK(room.ask("ben", Ask::operate) == "taken");
  CHECK(room.ask("ben", Ask::softer) == "viewer");
  for (const Ask ask : {Ask::pause, Ask::resume, Ask::softer, Ask::firmer, Ask::skip, Ask::repeat})
    CHECK(room.ask("anna", ask) == "done");
  for (const LiveCommand expected : {LiveCommand::pause, LiveCommand::resume, LiveCommand::softer,
                                     LiveCommand::firmer, LiveCommand::skip, LiveCommand::repeat})
    CHECK(room.command() == expected);
  CHECK(room.ask("anna", Ask::hand_over) == "done");
  CHECK(room.ask("ben", Ask::operate) == "done");
  CHECK_FALSE(room.command().has_value());
}

TEST_CASE("whoever asks may stop, however old, however written, and it goes before all else") {
  Room room;
  CHECK_FALSE(room.attendant.ends_scan());
  CHECK_FALSE(room.command().has_value());
  CHECK(room.ask("anna", Ask::operate) == "done");
  CHECK(room.ask("anna", Ask::pause) == "done");
  SUBCASE("another program") {
    CHECK(room.ask("ben", Ask::stop) == "done");
  }
  SUBCASE("an hour old") {
    CHECK(room.ask("ben", Ask::stop, 3600.0) == "done");
  }
  SUBCASE("no request at all") {
    CHECK(room.ask("", Ask::stop, 1e30, false) == "done");
  }
  CHECK(room.attendant.ends_scan());
  CHECK(room.command() == LiveCommand::stop);
  CHECK(room.command() == LiveCommand::pause);
  CHECK_FALSE(room.command().has_value());
}

TEST_CASE("nothing but stop is done of what is old, early, malformed, or before the massage") {
  Room room;
  CHECK(room.ask("anna", Ask::operate, 0.6) == "stale");
  CHECK(room.ask("anna", Ask::operate, -0.6) == "stale");
  CHECK(room.ask("anna", Ask::operate, 0.0, false) == "not a request as rmw_cyclonedds writes it");
  CHECK(room.ask("anna", Ask::operate) == "done");
  CHECK(room.ask("anna", Ask::pause) == "no massage is running");
  CHECK_FALSE(room.command().has_value());
  CHECK(room.ask("anna", Ask::pause) == "done");
  CHECK(room.command() == LiveCommand::pause);
}

TEST_CASE("an operator who falls silent leaves the massage paused, once; a hand-over does not") {
  Room room;
  CHECK_FALSE(room.command().has_value());
  const auto command_within = [&](std::chrono::milliseconds limit) {
    std::optional<LiveCommand> command;
    const auto end = std::chrono::steady_clock::now() + limit;
    while (!(command = room.command()) && std::chrono::steady_clock::now() < end)
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    return command;
  };
  CHECK(room.ask("anna", Ask::operate) == "done");
  CHECK(room.ask("anna", Ask::hand_over) == "done");
  CHECK_FALSE(command_within(std::chrono::milliseconds(2500)).has_value());
  CHECK(room.ask("anna", Ask::operate) == "done");
  CHECK_FALSE(command_within(std::chrono::milliseconds(1500)).has_value());
  CHECK(command_within(std::chrono::milliseconds(3000)) == LiveCommand::pause);
  CHECK_FALSE(command_within(std::chrono::milliseconds(300)).has_value());
  CHECK(room.ask("anna", Ask::resume) == "viewer");
  CHECK(room.log().find("done: no operator is there") != std::string::npos);
}

TEST_CASE("who floods is left without an answer, and the audit log tells all of it") {
  Room room;
  CHECK_FALSE(room.command().has_value());
  CHECK(room.ask("anna", Ask::operate) == "done");
  int done = 0;
  std::string outcome = "done";
  for (; done < 100 && outcome == "done"; ++done) outcome = room.ask("anna", Ask::softer);
  CHECK(done < 40);
  CHECK(outcome == "");
  CHECK(room.ask("ben", Ask::stop) == "done");
  room.desk.reset();
  const std::string log = room.log();
  CHECK(web::check_audit(log, "audit.log").has_value());
  for (const char* said :
       {"ros2 anna", "operate", "softer", "refused: too_fast", "ros2 ben", "stop"})
    CHECK(log.find(said) != std::string::npos);
}

TEST_CASE("from further away than this machine nothing is offered but stop") {
  const Room room(ros2::Reach::lan);
  CHECK(room.node.offered == std::vector<std::string>{"/tuina/stop"});
}
