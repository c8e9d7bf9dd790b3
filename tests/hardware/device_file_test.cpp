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
