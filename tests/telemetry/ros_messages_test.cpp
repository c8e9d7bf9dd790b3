// SPDX-License-Identifier: Apache-2.0
#include "tuina/telemetry/mcap/ros_markers.hpp"

#include <doctest/doctest.h>

#include "tests/core/mutation.hpp"
#include "tuina/telemetry/mcap/cdr.hpp"
#include "tuina/telemetry/mcap/ros_schema.hpp"

using namespace tuina::telemetry;

namespace {

ros::JointState some_joints() {
  return {.header = {.stamp = {.sec = 3, .nanosec = 5}, .frame_id = "base"},
          .name = {"rail", "left_elbow"},
          .position = {0.1, -0.2},
          .velocity = {1.0, 2.0},
          .effort = {}};
}

}  // namespace

TEST_CASE("CDR puts numbers at multiples of their size and ends texts with a zero") {
  std::string bytes;
  ros::to_cdr(ros::WrenchStamped{.header = {.stamp = {.sec = 1, .nanosec = 2}, .frame_id = "ab"},
                                 .wrench = {.force = {.x = 1.5}}},
              bytes);
  using namespace std::string_literals;
  const std::string wanted =
      "\0\1\0\0"s  // plain CDR, little-endian
      "\1\0\0\0"
      "\2\0\0\0"
      "\3\0\0\0"
      "ab\0"
      "\0"s                     // 3 characters, one byte of padding
      "\0\0\0\0\0\0\xf8\x3f"s;  // 1.5, at byte 16 of the message
  CHECK(bytes.substr(0, wanted.size()) == wanted);
  CHECK(bytes.size() == 4 + 16 + 6 * 8);
}

TEST_CASE("a message comes back from its bytes, and from none with a length that lies") {
  std::string bytes;
  ros::to_cdr(some_joints(), bytes);
  const auto again = ros::from_cdr<ros::JointState>(bytes);
  REQUIRE(again);
  CHECK(again->name == some_joints().name);
  CHECK(again->position == some_joints().position);
  CHECK(again->effort.empty());
  CHECK(again->header.stamp.nanosec == 5);
  for (std::size_t size = 0; size + 8 < bytes.size(); ++size)
    CHECK_FALSE(ros::from_cdr<ros::JointState>(std::string_view(bytes).substr(0, size)));
  tuina::Random random(3);
  for (int run = 0; run < 20000; ++run)
    (void)ros::from_cdr<ros::MarkerArray>(tuina::tests::mutated(bytes, random));
}

TEST_CASE("the definition names a message's fields, then those of the messages in it") {
  const mcap::Schema schema = ros::schema_of<ros::WrenchStamped>();
  CHECK(schema.name == "geometry_msgs/msg/WrenchStamped");
  CHECK(schema.encoding == "ros2msg");
  const std::string line(80, '=');
  CHECK(schema.data == "std_msgs/Header header\ngeometry_msgs/Wrench wrench\n" + line +
                           "\nMSG: std_msgs/Header\nbuiltin_interfaces/Time stamp\nstring "
                           "frame_id\n" +
                           line +
                           "\nMSG: geometry_msgs/Wrench\ngeometry_msgs/Vector3 "
                           "force\ngeometry_msgs/Vector3 torque\n" +
                           line + "\nMSG: builtin_interfaces/Time\nint32 sec\nuint32 nanosec\n" +
                           line +
                           "\nMSG: geometry_msgs/Vector3\nfloat64 x\nfloat64 y\nfloat64 z\n");
}
