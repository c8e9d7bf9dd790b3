// SPDX-License-Identifier: Apache-2.0
// Bytes on the wire against the documents of their makers, written out here by hand.
#include "tuina/hardware/wrist_frames.hpp"

#include <doctest/doctest.h>

#include <string>
#include <vector>

using namespace tuina::hardware;

namespace {

using Bytes = std::vector<std::uint8_t>;

std::vector<WristSample> found_in(hex_serial::Reader& reader, const Bytes& bytes) {
  std::vector<WristSample> all;
  for (const std::uint8_t byte : bytes) {
    reader.room()[0] = byte;
    reader.took(1);
    while (const auto sample = reader.next()) all.push_back(*sample);
  }
  return all;
}

// Counter 0x0102, status 0, forces 1, -2, 300, torques -400, 5, -32768.
const Bytes hex_frame = {0xAA, 0x07, 0x08, 0x10, 0x01, 0x02, 0x00, 0x00, 0x00, 0x01, 0xFF,
                         0xFE, 0x01, 0x2C, 0xFE, 0x70, 0x00, 0x05, 0x80, 0x00, 0x04, 0xEA};

}  // namespace

TEST_CASE("a HEX is told rate, filter and zero in nine bytes with their sum") {
  const auto frame = hex_serial::encode_config(1, 4, 0);
  CHECK(Bytes(frame.begin(), frame.end()) ==
        Bytes{0xAA, 0x00, 0x32, 0x03, 0x01, 0x04, 0x00, 0x00, 0xE4});
  const auto zeroed = hex_serial::encode_config(10, 6, 255);
  CHECK(Bytes(zeroed.begin(), zeroed.end()) ==
        Bytes{0xAA, 0x00, 0x32, 0x03, 0x0A, 0x06, 0xFF, 0x01, 0xEE});
}

TEST_CASE("a sample of a HEX is read from 22 bytes, wherever the line begins and breaks") {
  hex_serial::Reader reader;
  Bytes stream(hex_frame.begin() + 9, hex_frame.end());  // the end of one
  stream.insert(stream.end(), hex_frame.begin(), hex_frame.end());
  stream.insert(stream.end(), {0xAA, 0x07, 0x08});  // a beginning without more
  stream.insert(stream.end(), hex_frame.begin(), hex_frame.end());
  const auto found = found_in(reader, stream);
  REQUIRE(found.size() == 2);
  CHECK(found[0] == WristSample{.sequence = 0x0102,
                                .counter = 0x0102,
                                .status = 0,
                                .counts = {1, -2, 300, -400, 5, -32768}});
  CHECK(found[1] == found[0]);
  CHECK(reader.spoilt_bytes() == 0);
}

TEST_CASE("a frame of a HEX with one wrong bit anywhere is none") {
  for (std::size_t at = 0; at < hex_frame.size(); ++at) {
    for (int bit = 0; bit < 8; ++bit) {
      Bytes spoilt = hex_frame;
      spoilt[at] ^= static_cast<std::uint8_t>(1 << bit);
      hex_serial::Reader reader;
      CHECK_MESSAGE(found_in(reader, spoilt).empty(), "byte " << at << " bit " << bit);
    }
  }
}

TEST_CASE("the answer of a HEX and sensors of other axes are told apart") {
  hex_serial::Reader reader;
  CHECK(found_in(reader, {0xAA, 0x00, 0x50, 0x01, 0x00, 0x00, 0xFB}).empty());
  CHECK(reader.answer() == 0);
  CHECK(found_in(reader, {0xAA, 0x00, 0x50, 0x01, 0x03, 0x00, 0xFE}).empty());
  CHECK(reader.answer() == 3);
  CHECK(reader.other_axes() == 0);
  CHECK(found_in(reader, {0xAA, 0x07, 0x08, 0x0A, 0, 1, 0, 0, 0, 1, 0, 1, 0, 1, 0, 0xC7}).empty());
  CHECK(reader.other_axes() == hex_serial::axes_3);
  CHECK(found_in(reader, hex_frame).size() == 1);
}

TEST_CASE("noise without end neither fills the reader nor hides a frame for long") {
  hex_serial::Reader reader;
  CHECK(found_in(reader, Bytes(5000, 0xAA)).empty());
  CHECK(found_in(reader, hex_frame).size() == 1);
}

TEST_CASE("a request of RDT has eight bytes, a record 36, both big-endian") {
  const auto request = rdt::encode(rdt::Command::start, 0x01020304);
  const Bytes wanted = {0x12, 0x34, 0x00, 0x02, 0x01, 0x02, 0x03, 0x04};
  for (std::size_t i = 0; i < wanted.size(); ++i)
    CHECK(std::to_integer<std::uint8_t>(request[i]) == wanted[i]);
  CHECK(std::to_integer<int>(rdt::encode(rdt::Command::bias, 255)[3]) == 0x42);
  CHECK(std::to_integer<int>(rdt::encode(rdt::Command::filter, 4)[3]) == 0x81);
  CHECK(std::to_integer<int>(rdt::encode(rdt::Command::period, 2)[3]) == 0x82);
  const Bytes record = {0,    0,    0,    7,    0,    1,    0,    0,    0x80, 0, 0, 1,
                        0,    0,    0,    1,    0xFF, 0xFF, 0xFF, 0xFE, 0,    0, 1, 0x2C,
                        0xFF, 0xFF, 0xFE, 0x70, 0,    0,    0,    5,    0x80, 0, 0, 0};
  std::vector<std::byte> bytes;
  for (const std::uint8_t byte : record) bytes.push_back(std::byte{byte});
  const auto sample = rdt::decode(bytes);
  REQUIRE(sample.has_value());
  CHECK(*sample == WristSample{.sequence = 7,
                               .counter = 65536,
                               .status = 0x80000001U,
                               .counts = {1, -2, 300, -400, 5, -2147483647 - 1}});
  bytes.pop_back();
  CHECK_FALSE(rdt::decode(bytes).has_value());
  bytes.resize(37);
  CHECK_FALSE(rdt::decode(bytes).has_value());
  CHECK_FALSE(rdt::decode({}).has_value());
}
