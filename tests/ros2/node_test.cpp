// SPDX-License-Identifier: Apache-2.0
#include "tuina/ros2/node.hpp"

#include <doctest/doctest.h>

#include <random>

#include "tests/reason.hpp"
#include "tests/record/told_session.hpp"
#include "tests/ros2/fast_dds_peer.hpp"
#include "tuina/core/io/file.hpp"
#include "tuina/record/session_channels.hpp"
#include "tuina/robot/arm_model.hpp"
#include "tuina/ros2/names.hpp"
#include "tuina/ros2/type_hash.hpp"
#include "tuina/telemetry/mcap/cdr.hpp"
#include "tuina/telemetry/mcap/ros_diagnostics.hpp"
#include "tuina/telemetry/mcap/ros_schema.hpp"

using namespace tuina;
using test::comes_true;
using test::FastDdsPeer;
using namespace std::chrono_literals;
namespace ros = telemetry::ros;

namespace {

/// A domain of its own, so that runs beside each other do not meet. Those above 101 have ports that
/// the system gives away.
unsigned some_domain() {
  return std::uniform_int_distribution<unsigned>(1, 101)(*std::make_unique<std::random_device>());
}

std::unique_ptr<ros2::Node> node_in(unsigned domain) {
  auto node = ros2::open_node(domain, ros2::Reach::host);
  REQUIRE_MESSAGE(node.has_value(), test::reason(node));
  return std::move(*node);
}

/// Passes everything on to the node, and keeps it.
struct Kept final : record::ChannelSink {
  explicit Kept(ros2::Node& to) : node(to) {}
  std::uint16_t add_channel(const record::ChannelDescription& description) override {
    described.push_back(description);
    return node.add_channel(description);
  }
  void write(std::uint16_t id, std::uint64_t time_ns, std::string_view message) override {
    // The node has a channel of its own among them, the clock.
    const std::size_t i = id == 1 ? 0 : id - std::size_t{2};
    written[described.at(i).topic].emplace_back(message);
    node.write(id, time_ns, message);
  }
  ros2::Node& node;
  std::vector<record::ChannelDescription> described;
  std::map<std::string, std::vector<std::string>> written;
};

const telemetry::mcap::Schema text_schema = ros::schema_of<ros::String>();

telemetry::mcap::Schema schema_on_dds(const record::ChannelDescription& channel) {
  return channel.encoding == "json" ? text_schema : channel.schema;
}

/// The message without the zeros that DDS adds.
std::string without_padding(std::string received, std::size_t size) {
  CHECK(received.size() - size < 4);
  received.resize(size);
  return received;
}

session::Tick stopped_at_once() {
  session::Tick tick = test::tick_at(0);
  tick.stopped = {.cause = safety::Cause::asked_to};
  return tick;
}

void check_rviz(const Kept& kept) {
  // RViz is told to show nothing that nobody publishes.
  const std::string rviz =
      read_file(TUINA_SOURCE_DIR "/ros2/tuina_view/rviz/session.rviz", 100'000).value();
  constexpr std::string_view mark = "Value: /";
  std::size_t shown = 0;
  for (auto at = rviz.find(mark); at != std::string::npos; at = rviz.find(mark, at + 1), ++shown) {
    const std::size_t first = at + mark.size() - 1;
    CHECK(kept.written.contains(rviz.substr(first, rviz.find('\n', first) - first)));
  }
  CHECK(shown == 6);
}

void check_stopped(const std::string& diagnostics) {
  const auto how = ros::from_cdr<ros::DiagnosticArray>(diagnostics);
  REQUIRE(how.has_value());
  CHECK(how->status.back().name == "tuina: session");
  CHECK(how->status.back().level == ros::DiagnosticStatus::error);
}

record::ChannelDescription cloud_channel() {
  return {.topic = "/scan",
          .encoding = "cdr",
          .schema = ros::schema_of<ros::PointCloud2>(),
          .latched = true};
}

std::string some_cloud(std::size_t points, std::int32_t stamp_s) {
  ros::PointCloud2 cloud{.width = static_cast<std::uint32_t>(points), .point_step = 16};
  cloud.header.stamp.sec = stamp_s;
  for (std::size_t i = 0; i < 16 * points; ++i)
    cloud.data.push_back(static_cast<std::uint8_t>(i * 31));
  std::string bytes;
  ros::to_cdr(cloud, bytes);
  return bytes;
}

}  // namespace

TEST_CASE("another DDS hears a session byte for byte: every topic, its type and its hash") {
  const unsigned domain = some_domain();
  CAPTURE(domain);
  const auto node = node_in(domain);
  Kept kept(*node);
  record::SessionChannels session(
      kept,
      {.version = "0", .answered_by = "somebody", .robot = robot::load_robot("thesis").value()});
  const scanner::LiveProfile line{.points_in_couch = {Vector3(0.1, 0.2, 0.5)}};
  session.on_profile(line);
  test::tell_beginning(session);
  session.on_tick(stopped_at_once());
  const auto before = kept.written;

  FastDdsPeer peer(domain);
  for (const auto& channel : kept.described) {
    peer.subscribe(ros2::dds_topic(channel.topic), ros2::dds_type(schema_on_dds(channel).name),
                   channel.latched);
  }
  peer.subscribe("rt/clock", ros2::dds_type("rosgraph_msgs/msg/Clock"), false);
  for (const auto& channel : kept.described) {
    CAPTURE(channel.topic);
    REQUIRE(comes_true([&] { return peer.publishers(ros2::dds_topic(channel.topic)) == 1; }));
    CHECK(peer.user_data(ros2::dds_topic(channel.topic)) ==
          "typehash=" + ros2::type_hash(schema_on_dds(channel)) + ";");
  }
  const std::size_t readers = kept.described.size() + 1;  // the clock's too
  REQUIRE(comes_true([&] { return node->traffic().readers == readers; }));
  constexpr std::uint64_t count = 1200;
  session.on_profile(line);
  for (std::uint64_t ms = 1; ms < count; ++ms) session.on_tick(test::tick_at(ms));

  CHECK(kept.described.size() >= 17);
  check_rviz(kept);
  CHECK(node->traffic().first_fault == "");
  CHECK(node->traffic().dropped == 0);
  for (const auto& channel : kept.described) {
    CAPTURE(channel.topic);
    // Who comes later is given what is latched, and the rest from then on.
    const auto& said = kept.written.at(channel.topic);
    const auto already = before.find(channel.topic);
    const std::size_t missed =
        channel.latched || already == before.end() ? 0 : already->second.size();
    const std::string topic = ros2::dds_topic(channel.topic);
    CHECK(comes_true([&] { return peer.messages(topic).size() == said.size() - missed; }));
    const auto heard = peer.messages(topic);
    REQUIRE(heard.size() == said.size() - missed);
    for (std::size_t i = 0; i < heard.size(); ++i) {
      std::string sent = said[i + missed];
      if (channel.encoding == "json") ros::to_cdr(ros::String{.data = said[i + missed]}, sent);
      REQUIRE(without_padding(heard[i], sent.size()) == sent);
    }
  }
  CHECK(peer.messages("rt/profile").size() == 1);
  check_stopped(peer.messages("rt/diagnostics").back());
  CHECK(peer.messages("rt/joint_states").size() == count - 1);
  CHECK(ros::from_cdr<ros::JointState>(peer.messages("rt/joint_states").back())->name.size() == 13);
  CHECK(ros::from_cdr<ros::Clock>(peer.messages("rt/clock").back())->clock.nanosec == 190'000'000);
}

TEST_CASE("what a session latched is given to nobody in the next, whose clock begins anew") {
  const unsigned domain = some_domain();
  CAPTURE(domain);
  const auto node = node_in(domain);
  const record::ChannelDescription plan{
      .topic = "/tuina/plan", .encoding = "json", .schema = text_schema, .latched = true};
  const std::uint16_t id = node->add_channel(plan);
  node->write(id, 300'000'000'000, "the first");
  FastDdsPeer early(domain);
  early.subscribe("rt/tuina/plan", ros2::dds_type("std_msgs/msg/String"), true);
  REQUIRE(comes_true([&] { return early.messages("rt/tuina/plan").size() == 1; }));

  node->begin_session();
  FastDdsPeer late(domain);
  late.subscribe("rt/tuina/plan", ros2::dds_type("std_msgs/msg/String"), true);
  late.subscribe("rt/clock", ros2::dds_type("rosgraph_msgs/msg/Clock"), false);
  REQUIRE(comes_true([&] { return node->traffic().readers == 1; }));  // the clock's
  CHECK(node->add_channel(plan) == id);
  REQUIRE(comes_true([&] { return node->traffic().readers == 3; }));
  node->write(id, 20'000'000, "the second");
  CHECK(comes_true([&] { return early.messages("rt/tuina/plan").size() == 2; }));
  REQUIRE(comes_true([&] { return late.messages("rt/tuina/plan").size() == 1; }));
  CHECK(late.messages("rt/tuina/plan").front().find("the second") != std::string::npos);
  CHECK(comes_true([&] { return late.messages("rt/clock").size() == 1; }));
}

TEST_CASE("another DDS takes clouds of 55 000 points whole, 20 of 20") {
  const unsigned domain = some_domain();
  CAPTURE(domain);
  const auto node = node_in(domain);
  const std::uint16_t scan = node->add_channel(cloud_channel());
  FastDdsPeer peer(domain, 4'000'000);
  peer.subscribe("rt/scan", "sensor_msgs::msg::dds_::PointCloud2_", true);
  REQUIRE(comes_true([&] { return peer.publishers("rt/scan") == 1; }));
  for (std::int32_t i = 1; i <= 20; ++i) {
    const std::string cloud = some_cloud(55'000, i);
    node->write(scan, 0, cloud);
    CAPTURE(i);
    REQUIRE(comes_true([&] { return peer.messages("rt/scan").size() == std::size_t(i); }));
    CHECK(without_padding(peer.messages("rt/scan").back(), cloud.size()) == cloud);
  }
}

TEST_CASE("one cloud of 55 000 points comes whole through a socket as Debian has it") {
  const unsigned domain = some_domain();
  CAPTURE(domain);
  const auto node = node_in(domain);
  const std::uint16_t scan = node->add_channel(cloud_channel());
  const std::string cloud = some_cloud(55'000, 1);
  node->write(scan, 0, cloud);
  FastDdsPeer peer(domain);
  peer.subscribe("rt/scan", "sensor_msgs::msg::dds_::PointCloud2_", true);
  REQUIRE(comes_true([&] { return peer.messages("rt/scan").size() == 1; }, 8s));
  CHECK(without_padding(peer.messages("rt/scan").back(), cloud.size()) == cloud);
}

TEST_CASE("a reader that takes nothing makes nobody wait, and what it cost is counted") {
  const unsigned domain = some_domain();
  CAPTURE(domain);
  const auto node = node_in(domain);
  const std::uint16_t stream =
      node->add_channel({.topic = "/stream", .encoding = "cdr", .schema = text_schema});
  std::string bytes;
  ros::to_cdr(ros::String{.data = std::string(10'000, 'x')}, bytes);
  FastDdsPeer peer(domain);
  peer.subscribe("rt/stream", ros2::dds_type(text_schema.name), false);
  REQUIRE(comes_true([&] { return node->traffic().readers == 1; }));
  peer.sleep("rt/stream", 1s);
  const auto begin = std::chrono::steady_clock::now();
  constexpr std::uint64_t count = 1000;  // ten megabytes, of which two may be on their way
  for (std::uint64_t i = 0; i < count; ++i) node->write(stream, 0, bytes);
  CHECK(std::chrono::steady_clock::now() - begin < 900ms);
  const ros2::Traffic traffic = node->traffic();
  CHECK(traffic.messages == count + 1);  // and one of the clock
  CHECK(traffic.dropped > 0);
  CHECK(traffic.dropped < count);
  CHECK(traffic.first_fault == "Timeout");
}
