// SPDX-License-Identifier: Apache-2.0
#include "tuina/hardware/device_file.hpp"

#include <doctest/doctest.h>

#include "tests/reason.hpp"

using namespace tuina;
using namespace tuina::hardware;

namespace {

std::string wrong(const char* text) {
  const auto file = parse_device_file(text, "device.toml");
  REQUIRE_FALSE(file.has_value());
  CHECK(file.error().fault == Fault::config);
  return file.error().message;
}

}  // namespace

TEST_CASE("a device file names both arms") {
  const auto file = parse_device_file(
      "[arm.left]\nkind = \"armlink\"\naddress = \"127.0.0.1:7001\"\n"
      "[arm.right]\nkind = \"armlink\"\naddress = \"192.168.3.11:7002\"\n",
      "device.toml");
  REQUIRE_MESSAGE(file.has_value(), test::reason(file));
  REQUIRE(file->arms.has_value());
  CHECK((*file->arms)[Arm::left].address == "127.0.0.1:7001");
  CHECK(ntohs((*file->arms)[Arm::right].udp.of.sin_port) == 7002);
}

TEST_CASE("a device file names the camera and the turntable of a scanner") {
  const auto file = parse_device_file(
      "[camera]\nkind = \"v4l2\"\naddress = \"/dev/video2\"\nformat = \"MJPG\"\n"
      "exposure_ms = 2.5\nturned_deg = 270\n"
      "[turntable]\nkind = \"adapter\"\naddress = \"/dev/ttyUSB0\"\nreversed = true\n",
      "device.toml");
  REQUIRE_MESSAGE(file.has_value(), test::reason(file));
  CHECK_FALSE(file->arms.has_value());
  REQUIRE(file->camera.has_value());
  CHECK(file->camera->address == "/dev/video2");
  CHECK(file->camera->format == PixelFormat::mjpeg);
  CHECK(file->camera->exposure_ms == 2.5);
  CHECK_FALSE(file->camera->gain.has_value());
  CHECK(file->camera->turned_deg == 270);
  REQUIRE(file->turntable.has_value());
  CHECK(file->turntable->kind == TurntableDevice::Kind::adapter);
  CHECK(file->turntable->bits_per_s == 1'000'000);
  CHECK(file->turntable->reversed);
}

TEST_CASE("what is wrong with a scanner's section is said with line, key and value") {
  CHECK(wrong("").find("no device is named") != std::string::npos);
  const std::string said = wrong(
      "[camera]\nkind = \"v4l2\"\naddress = \"video0\"\nformat = \"RGB3\"\n"
      "exposure_ms = 50\nturned_deg = 45\nzoom = 3\n"
      "[turntable]\nkind = \"board\"\nbits_per_s = 9600\nservo = 300\n");
  for (const char* part :
       {"device.toml:3: camera.address = 'video0' is no path of a device", "camera.format",
        "camera.exposure_ms = 50", "device.toml:6: camera.turned_deg = 45 is not 0, 90, 180 or 270",
        "zoom", "turntable.address", "turntable.bits_per_s = 9600 is not one of 57600",
        "turntable.servo = 300"})
    CHECK_MESSAGE(said.find(part) != std::string::npos, said);
}

TEST_CASE("what is wrong with a device file is said with line, key and value") {
  CHECK(wrong("[arm.left]\nkind = \"armlink\"\naddress = \"127.0.0.1\"\n"
              "[arm.right]\nkind = \"armlnk\"\naddress = \"127.0.0.1:7002\"\n") ==
        "device.toml:3: arm.left.address = '127.0.0.1' is no IPv4 address and port, such as "
        "\"192.168.3.10:7001\"\n"
        "device.toml:5: arm.right.kind = \"armlnk\" is unknown; is `armlink` meant?");
  CHECK(wrong("[arm.left]\nkind = \"armlink\"\naddress = \"127.0.0.1:7001\"\n")
            .find("arm.right is missing") != std::string::npos);
  CHECK(wrong("[arm.left]\nkind = \"armlink\"\naddress = \"127.0.0.1:7001\"\n"
              "[arm.right]\nkind = \"armlink\"\naddress = \"127.0.0.1:7001\"\n")
            .find("is that of the left arm") != std::string::npos);
  for (const char* port : {"127.0.0.1:0", "127.0.0.1:70000", "127.0.0.1:7x", "host:7001", ":", ""})
    CHECK_FALSE(parse_udp_address(port).has_value());
}
