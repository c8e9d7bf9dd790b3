// SPDX-License-Identifier: Apache-2.0
#include "tuina/hardware/dynamixel.hpp"

#include <doctest/doctest.h>

#include "tuina/core/random.hpp"

using namespace tuina;
using namespace tuina::hardware::dynamixel;

using Bytes = std::vector<std::uint8_t>;

namespace {

std::vector<Packet> read_all(const Bytes& bytes) {
  Reader reader;
  reader.add(bytes);
  std::vector<Packet> all;
  while (auto packet = reader.next()) all.push_back(std::move(*packet));
  return all;
}

}  // namespace

TEST_CASE("a packet is laid out as the protocol says") {
  // The maker's own example: read the temperature of motor 1, which answers 32 degrees.
  CHECK(encode({1, tuina::hardware::dynamixel::read, {0x2B, 0x01}}) ==
        Bytes{0xFF, 0xFF, 0x01, 0x04, 0x02, 0x2B, 0x01, 0xCC});
  CHECK(read_all({0xFF, 0xFF, 0x01, 0x03, 0x00, 0x20, 0xDB}) ==
        std::vector<Packet>{{1, 0, {0x20}}});
}

TEST_CASE("packets are found between stray bytes, however they are cut") {
  Random random = make_random(7, "dynamixel");
  for (int round = 0; round < 500; ++round) {
    std::vector<Packet> sent;
    Bytes stream;
    for (int i = 0; i < 4; ++i) {
      // No stray byte is a mark, or it would begin a packet.
      for (double k = uniform(random, 0.0, 6.0); k > 1.0; --k)
        stream.push_back(static_cast<std::uint8_t>(uniform(random, 0.0, 254.0)));
      Packet packet{.id = static_cast<std::uint8_t>(uniform(random, 0.0, 253.0)),
                    .kind = 0,
                    .parameters = {}};
      packet.parameters.resize(static_cast<std::size_t>(uniform(random, 0.0, 20.0)));
      for (std::uint8_t& byte : packet.parameters)
        byte = static_cast<std::uint8_t>(uniform(random, 0.0, 256.0));
      const Bytes bytes = encode(packet);
      stream.insert(stream.end(), bytes.begin(), bytes.end());
      sent.push_back(std::move(packet));
    }
    Reader reader;
    std::vector<Packet> found;
    for (const std::uint8_t byte : stream) {
      reader.add({&byte, 1});
      while (auto packet = reader.next()) found.push_back(std::move(*packet));
    }
    CHECK(found == sent);
    CHECK(read_all(stream) == sent);
    CHECK(reader.rejected() == 0);
  }
}

TEST_CASE("a packet with one wrong bit is none") {
  const Bytes good = encode({1, 0, {0x12, 0x34, 0x56}});
  for (std::size_t i = 0; i < good.size(); ++i) {
    for (unsigned bit = 0; bit < 8; ++bit) {
      Bytes bad = good;
      bad[i] ^= static_cast<std::uint8_t>(1U << bit);
      CHECK(read_all(bad).empty());
    }
  }
}

TEST_CASE("error bits are words") {
  CHECK(errors_of(0) == "");
  CHECK(errors_of(0x24) == "overheated, overload");
  CHECK(errors_of(0xFF).find("voltage out of range, ") == 0);
}
