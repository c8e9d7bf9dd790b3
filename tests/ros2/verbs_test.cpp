// SPDX-License-Identifier: Apache-2.0
// Whole verbs with `--ros2`, heard by Fast DDS and asked by a program that knows Cyclone DDS only.
#include <doctest/doctest.h>
#include <fmt/format.h>

#include <future>
#include <nlohmann/json.hpp>
#include <random>

#include "tests/ros2/fast_dds_peer.hpp"
#include "tests/whole/command.hpp"
#include "tuina/core/io/file.hpp"
#include "tuina/telemetry/mcap/cdr.hpp"
#include "tuina/telemetry/mcap/ros_messages.hpp"

using namespace tuina;
using test::comes_true;
using test::FastDdsPeer;
using test::Folder;
using test::run_tuina;
using namespace std::chrono_literals;
namespace ros = telemetry::ros;

namespace {

/// Verbs and peers of this test meet in a domain of their own.
unsigned some_domain() {
  const unsigned domain =
      std::uniform_int_distribution<unsigned>(1, 101)(*std::make_unique<std::random_device>());
  setenv("ROS_DOMAIN_ID", std::to_string(domain).c_str(), 1);
  return domain;
}

std::future<test::Outcome> run_beside(std::vector<std::string> words) {
  return std::async(std::launch::async, [words = std::move(words)] { return run_tuina(words); });
}

/// Lines of `service_client` for these services, called one after the other by one program.
std::string call(unsigned domain, const std::string& services) {
  const Folder folder;
  const std::string command =
      fmt::format("{} {} {} >{}", TUINA_SERVICE_CLIENT, domain, services, folder / "out");
  const int status = std::system(command.c_str());
  CHECK(status == 0);
  return read_file(folder / "out", 10'000).value();
}

}  // namespace

TEST_CASE("scan --ros2: another program hears lines as they come, and gets the cloud of the file") {
  const Folder folder;
  FastDdsPeer peer(some_domain(), 4'000'000);
  peer.subscribe("rt/scan", "sensor_msgs::msg::dds_::PointCloud2_", true);
  peer.subscribe("rt/profile", "sensor_msgs::msg::dds_::PointCloud2_", false);
  // A scan may be over before two kinds of DDS have found each other: once more then.
  std::size_t clouds = 0;
  test::Outcome outcome;
  for (int i = 0; i < 6 && peer.messages("rt/profile").empty(); ++i) {
    outcome = run_tuina(
        {"scan", "--ros2", "--person", "phantom:slim", "--json", "--out", folder / "scan.ply"});
    REQUIRE_MESSAGE(outcome.exit_code == 0, outcome.err);
    if (comes_true([&] { return peer.messages("rt/scan").size() > clouds; })) ++clouds;
  }
  REQUIRE(clouds > 0);
  const auto cloud = ros::from_cdr<ros::PointCloud2>(peer.messages("rt/scan").back());
  REQUIRE(cloud.has_value());
  const std::string points = "element vertex " + std::to_string(cloud->width) + "\n";
  CHECK(read_file(folder / "scan.ply", 50'000'000)->find(points) != std::string::npos);

  const auto lines = peer.messages("rt/profile");
  MESSAGE(lines.size(), " lines were heard");
  REQUIRE_FALSE(lines.empty());
  // Lines at the edge may be seen and have no part in the cloud.
  CHECK(lines.size() < nlohmann::json::parse(outcome.out)["profiles"].get<std::size_t>() + 10);
  for (const std::string& one : lines) {
    const auto line = ros::from_cdr<ros::PointCloud2>(one);
    REQUIRE(line.has_value());
    CHECK(line->width > 0);
    CHECK(line->header.frame_id == "couch");
  }
}

TEST_CASE("massage --ros2: another program sees it, takes control, pauses it, and stops it") {
  const Folder folder;
  const unsigned domain = some_domain();
  CAPTURE(domain);
  FastDdsPeer peer(domain);
  peer.subscribe("rt/joint_states", "sensor_msgs::msg::dds_::JointState_", false);
  auto massage = run_beside({"massage", "--ros2", "--pace", "real", "--person", "phantom:slim",
                             "--out", folder / "report"});
  REQUIRE(comes_true([&] { return peer.messages("rt/joint_states").size() > 100; }, 60s));
  CHECK(call(domain, "/tuina/pause /tuina/operate /tuina/softer /tuina/pause /tuina/hand_over") ==
        "/tuina/pause false viewer\n/tuina/operate true done\n/tuina/softer true done\n"
        "/tuina/pause true done\n/tuina/hand_over true done\n");
  CHECK(call(domain, "/tuina/stop") == "/tuina/stop true done\n");
  REQUIRE(massage.wait_for(30s) == std::future_status::ready);
  const auto outcome = massage.get();
  CHECK(outcome.exit_code == 4);
  CHECK((outcome.out + outcome.err).find("ROS 2: ") != std::string::npos);
  const auto session = read_file(std::filesystem::path(folder / "report") / "session.json");
  REQUIRE(session.has_value());
  for (const char* command : {"\"softer\"", "\"pause\"", "\"stop\""})
    CHECK(session->find(command) != std::string::npos);
  const std::string log = (std::filesystem::path(folder / "report") / "audit.log").string();
  const auto audit = run_tuina({"audit", "check", log});
  CHECK_MESSAGE(audit.exit_code == 0, audit.err);
}
