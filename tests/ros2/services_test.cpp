// SPDX-License-Identifier: Apache-2.0
#include "tuina/ros2/services.hpp"

#include <doctest/doctest.h>

#include <random>

#include "tests/reason.hpp"
#include "tests/ros2/fast_dds_peer.hpp"
#include "tuina/ros2/node.hpp"
#include "tuina/telemetry/mcap/cdr.hpp"

using namespace tuina;
using test::comes_true;
using test::FastDdsPeer;
namespace ros = telemetry::ros;

namespace {

const std::string names[] = {"/tuina/stop", "/tuina/pause", "/tuina/resume"};
// Fast DDS tells again what was lost every three seconds.
constexpr std::chrono::seconds found_within(10);
constexpr const char* stop_requests = "rq/tuina/stopRequest";
constexpr const char* pause_requests = "rq/tuina/pauseRequest";
constexpr const char* pause_answers = "rr/tuina/pauseReply";

/// Two services, and another DDS that asks them.
struct Asked {
  Asked()
      : domain(std::uniform_int_distribution<unsigned>(
            1, 101)(*std::make_unique<std::random_device>())),
        peer(domain) {
    auto opened = ros2::open_node(domain, ros2::Reach::host);
    REQUIRE_MESSAGE(opened.has_value(), test::reason(opened));
    node = std::move(*opened);
    auto offered = node->offer(names);
    REQUIRE_MESSAGE(offered.has_value(), test::reason(offered));
    services = std::move(*offered);
    for (const char* topic : {stop_requests, pause_requests})
      peer.advertise(topic, "std_srvs::srv::dds_::Trigger_Request_");
    peer.subscribe(pause_answers, "std_srvs::srv::dds_::Trigger_Response_", false);
    REQUIRE(comes_true([&] { return peer.publishers(pause_answers) == 1; }, found_within));
    // Either side finds the other in its own time, and what is said before is lost.
    for (const char* topic : {stop_requests, pause_requests}) {
      REQUIRE(comes_true(
          [&] {
            peer.say(topic, std::string("\0\1\0\0hello", 9));
            return services->next(0.1).has_value();
          },
          found_within));
      REQUIRE(peer.has_come(topic));
      while (services->next(0.3)) continue;
    }
  }
  std::optional<ros2::Request> next() { return services->next(3.0); }
  /// Whoever offers services goes on asking for requests, by which a late answer leaves.
  bool is_answered() {
    return comes_true(
        [&] {
          (void)services->next(0.001);
          return peer.messages(pause_answers).size() == 1;
        },
        found_within);
  }

  unsigned domain;
  std::unique_ptr<ros2::Node> node;
  std::unique_ptr<ros2::Services> services;
  FastDdsPeer peer;
};

std::string request_of(std::uint64_t client, std::int64_t sequence) {
  std::string bytes;
  ros::to_cdr(ros2::TriggerRequest{.call = {.client = client, .sequence = sequence}}, bytes);
  return bytes;
}

}  // namespace

TEST_CASE("another DDS calls a service, and hears what came of this very call") {
  Asked asked;
  CAPTURE(asked.domain);
  std::string bytes = request_of(0x0123456789abcdef, 7);
  SUBCASE("as Fast DDS numbers its encoding") {}
  SUBCASE("as Cyclone DDS does, with the number of its padding") {
    bytes[3] = 3;
  }
  asked.peer.say(pause_requests, bytes);
  const auto request = asked.next();
  REQUIRE(request.has_value());
  CHECK(request->service == 1);
  CHECK(request->from.size() == 32);
  CHECK(request->age_s >= 0.0);
  CHECK(request->age_s < 3.0);
  REQUIRE(request->call.has_value());
  CHECK(request->call->client == 0x0123456789abcdef);
  CHECK(request->call->sequence == 7);
  asked.services->answer(*request, false, "no massage is running");
  REQUIRE(asked.is_answered());
  // The bytes, letter by letter: number of the client and of the call, then bool and string.
  const std::string expected(
      "\0\1\0\0"
      "\xef\xcd\xab\x89\x67\x45\x23\x01"
      "\7\0\0\0\0\0\0\0"
      "\0\0\0\0"
      "\x16\0\0\0"
      "no massage is running\0"
      "\0\0",
      52);
  CHECK(asked.peer.messages(pause_answers).front() == expected);
}

TEST_CASE("what is no request comes as one that nobody can answer, and harms nothing") {
  Asked asked;
  CAPTURE(asked.domain);
  const std::string head("\0\1\0\0", 4);
  std::string big_endian = request_of(1, 1);
  big_endian[1] = '\0';
  // The third is what ROS 2 with Fast DDS says: there the number is not among the bytes.
  const std::vector<std::string> wrong = {head,
                                          head + "abc",
                                          head + std::string(1, '\0'),
                                          request_of(1, 1).substr(0, 16),
                                          request_of(1, 1) + std::string(30, 'x'),
                                          head + std::string(100'000, '\xff'),
                                          big_endian};
  for (const std::string& bytes : wrong) {
    CAPTURE(bytes.size());
    asked.peer.say(pause_requests, bytes);
    const auto request = asked.next();
    REQUIRE(request.has_value());
    CHECK(request->service == 1);
    CHECK_FALSE(request->call.has_value());
    asked.services->answer(*request, true, "done");
  }
  asked.peer.say(pause_requests, request_of(2, 3));
  const auto right = asked.next();
  REQUIRE(right.has_value());
  REQUIRE(right->call.has_value());
  asked.services->answer(*right, true, "done");
  REQUIRE(asked.is_answered());
  const auto answer =
      ros::from_cdr<ros2::TriggerAnswer>(asked.peer.messages(pause_answers).front());
  REQUIRE(answer.has_value());
  CHECK(answer->call.client == 2);
  CHECK(answer->success);
}

TEST_CASE("a program that asks and leaves is forgotten, and the next one is served") {
  Asked asked;
  CAPTURE(asked.domain);
  // Nobody else asks this one, so that with each program its last one leaves.
  constexpr const char* requests = "rq/tuina/resumeRequest";
  for (std::uint64_t client = 1; client <= 3; ++client) {
    FastDdsPeer peer(asked.domain);
    peer.advertise(requests, "std_srvs::srv::dds_::Trigger_Request_");
    std::optional<ros2::Request> request;
    REQUIRE(comes_true(
        [&] {
          peer.say(requests, request_of(client, 1));
          request = asked.services->next(0.1);
          return request.has_value();
        },
        found_within));
    CHECK(request->call->client == client);
    while (asked.services->next(0.1)) continue;
  }
  // Whoever has left is known by what Cyclone says of its writer, which is no request.
  CHECK_FALSE(asked.services->next(1.0).has_value());
}

TEST_CASE(
    "in a flood of other requests a stop is the next that comes, and few of the others wait") {
  Asked asked;
  CAPTURE(asked.domain);
  constexpr std::int64_t count = 2000;
  for (std::int64_t i = 0; i < count; ++i) asked.peer.say(pause_requests, request_of(1, i));
  asked.peer.say(stop_requests, request_of(1, count));
  REQUIRE(asked.peer.has_come(pause_requests));
  REQUIRE(asked.peer.has_come(stop_requests));
  std::this_thread::sleep_for(std::chrono::milliseconds(100));  // from the socket to the readers
  const auto stop = asked.next();
  REQUIRE(stop.has_value());
  CHECK(stop->service == 0);
  CHECK(stop->call->sequence == count);
  std::int64_t last = 0;
  int left = 0;
  for (auto request = asked.next(); request; request = asked.services->next(0.1), ++left)
    last = request->call->sequence;
  CHECK(left == 32);
  CHECK(last == count - 1);
}
