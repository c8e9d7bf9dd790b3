// SPDX-License-Identifier: Apache-2.0
#include <doctest/doctest.h>

#include <algorithm>
#include <tuple>

#include "tests/core/mutation.hpp"
#include "tuina/telemetry/mcap/reader.hpp"
#include "tuina/telemetry/mcap/record_bytes.hpp"
#include "tuina/telemetry/mcap/writer.hpp"

using namespace tuina::telemetry;
using tuina::Fault;
using tuina::Random;
using tuina::Result;

namespace {

/// Topic, name of the schema, sequence number, time, data.
using Seen = std::tuple<std::string, std::string, std::uint32_t, std::uint64_t, std::string>;

constexpr std::uint64_t ms = 1'000'000;
constexpr std::string_view urdf = "<robot name=\"tuina\"/>";

/// A small file, and what was written into it.
struct Written {
  std::string bytes;
  std::vector<Seen> messages;
  std::vector<std::pair<std::size_t, std::size_t>> safe;  ///< bytes of the file, messages in them
};

Written small_file() {
  Written written;
  mcap::Writer writer([&](std::string_view bytes) {
    written.bytes += bytes;
    return Result<void>();
  });
  const mcap::Schema text{.name = "text", .encoding = "jsonschema", .data = "{}"};
  const std::uint16_t events = writer.add_channel("/events", "json", text);
  const std::uint16_t joints = writer.add_channel(
      "/joints", "cdr", {.name = "numbers", .encoding = "ros2msg", .data = "float64[] q\n"},
      {{"offered_qos_profiles", ""}});
  for (std::uint64_t i = 0; i < 12; ++i) {
    const bool event = i % 4 == 3;
    const std::uint64_t time_ns = 300 * i * ms;
    const std::string data = event ? fmt::format("{{\"i\":{}}}", i) : std::string(20, char(i));
    REQUIRE(writer.write(event ? events : joints, time_ns, data));
    written.messages.emplace_back(event ? "/events" : "/joints", event ? "text" : "numbers", 0U,
                                  time_ns, data);
    // A chunk holds a second: four messages.
    if (i % 4 == 0 && i > 0) written.safe.emplace_back(written.bytes.size(), i);
  }
  REQUIRE(writer.attach({.name = "robot.urdf", .media_type = "text/xml", .data = {urdf}}));
  written.safe.emplace_back(written.bytes.size(), 12);
  REQUIRE(writer.add_metadata({.name = "session", .metadata = {{"seed", "7"}}}));
  REQUIRE(writer.finish());
  CHECK(writer.bytes() == written.bytes.size());
  return written;
}

struct Got {
  mcap::Contents contents;
  std::vector<Seen> messages;
};

Got got_of(std::string_view bytes) {
  Got got;
  got.contents =
      mcap::read(bytes, [&](const mcap::Contents& file, const mcap::Message& message) {
        const mcap::Channel& channel = file.channels.at(message.channel_id);
        got.messages.emplace_back(channel.topic, file.schemas.at(channel.schema_id).name,
                                  message.sequence, message.log_time_ns, std::string(message.data));
      }).value();
  return got;
}

/// What is told of a damaged file is true, and what is not told is named as lost.
void check_honest(const Got& got, const Written& written) {
  std::size_t at = 0;
  for (const Seen& message : got.messages) {
    const auto begin = written.messages.begin() + static_cast<std::ptrdiff_t>(at);
    const auto found = std::find(begin, written.messages.end(), message);
    REQUIRE(found != written.messages.end());
    at = static_cast<std::size_t>(found - written.messages.begin()) + 1;
  }
  for (const mcap::Attachment& one : got.contents.attachments)
    REQUIRE((one.name == "robot.urdf" && one.data.bytes == urdf && one.media_type == "text/xml"));
  const auto& metadata = got.contents.metadata;
  const std::map<std::string, std::string> expected = {{"seed", "7"}};
  const bool all = got.messages.size() == written.messages.size() &&
                   got.contents.attachments.size() == 1 && metadata.size() == 1 &&
                   metadata.front().metadata == expected && got.contents.header.profile == "ros2";
  REQUIRE((all || !got.contents.lost.empty()));
}

}  // namespace

TEST_CASE("what was written is read again, message by message, and nothing is lost") {
  const Written written = small_file();
  const Got got = got_of(written.bytes);
  CHECK(got.contents.lost.empty());
  CHECK(got.messages == written.messages);
  CHECK(got.contents.header.profile == "ros2");
  CHECK(got.contents.chunks == 3);
  CHECK(got.contents.channel_messages == std::map<std::uint16_t, std::uint64_t>{{1, 3}, {2, 9}});
  CHECK(got.contents.end_ns == 3300 * ms);
  CHECK(got.contents.channels.at(2).metadata.contains("offered_qos_profiles"));
  REQUIRE(got.contents.attachment("robot.urdf") != nullptr);
  CHECK(got.contents.attachment("robot.urdf")->data.bytes == urdf);
  CHECK(got.contents.metadata.front().metadata.at("seed") == "7");
}

TEST_CASE("a file that is cut off anywhere gives every chunk that was ended, and says so") {
  const Written written = small_file();
  for (std::size_t size = mcap::magic.size(); size < written.bytes.size(); ++size) {
    CAPTURE(size);
    const Got got = got_of(std::string_view(written.bytes).substr(0, size));
    REQUIRE_FALSE(got.contents.lost.empty());
    check_honest(got, written);
    std::size_t safe = 0;
    for (const auto& [bytes, messages] : written.safe)
      if (bytes <= size) safe = messages;
    REQUIRE(got.messages.size() >= safe);
  }
}

TEST_CASE("one byte that is wrong, anywhere, costs one chunk at most and is noticed") {
  const Written written = small_file();
  for (std::size_t at = mcap::magic.size(); at < written.bytes.size(); ++at) {
    for (const int flip : {0x01, 0x02, 0x04, 0x08, 0x10, 0x20, 0x40, 0x80, 0xff}) {
      CAPTURE(at);
      CAPTURE(flip);
      std::string bytes = written.bytes;
      bytes[at] = static_cast<char>(bytes[at] ^ flip);
      const Got got = got_of(bytes);
      REQUIRE_FALSE(got.contents.lost.empty());
      check_honest(got, written);
      REQUIRE(got.messages.size() >= written.messages.size() - 4);
    }
  }
}

TEST_CASE("several faults at once are noticed, and no message comes that was never written") {
  const Written written = small_file();
  Random random(11);
  for (int run = 0; run < 20000; ++run) {
    CAPTURE(run);
    const std::string bytes = tuina::tests::mutated(written.bytes, random);
    if (!bytes.starts_with(mcap::magic) || bytes == written.bytes) continue;
    const Got got = got_of(bytes);
    REQUIRE_FALSE(got.contents.lost.empty());
    for (const Seen& message : got.messages)
      REQUIRE(std::find(written.messages.begin(), written.messages.end(), message) !=
              written.messages.end());
  }
}

TEST_CASE("what does not begin as an MCAP file is refused") {
  const auto none = mcap::read("PK\3\4 and so on");
  REQUIRE_FALSE(none);
  CHECK(none.error().fault == Fault::bad_input);
  CHECK_FALSE(mcap::read("").has_value());
}

TEST_CASE("plain chunks and messages without a chunk, as others write them, are read") {
  std::string bytes(mcap::magic), records;
  mcap::append_record(bytes, mcap::Header{.profile = "", .library = "another"});
  mcap::append_record(bytes, mcap::Schema{.id = 1, .name = "s", .encoding = "", .data = ""});
  mcap::append_record(bytes, mcap::Channel{.id = 5, .schema_id = 1, .topic = "/t"});
  mcap::append_record(bytes, mcap::MessageHead{.channel_id = 5, .log_time_ns = 3});
  mcap::append_record(bytes, mcap::DataEnd{});
  mcap::append_record(bytes, mcap::Footer{});
  bytes += mcap::magic;
  CHECK(got_of(bytes).messages.size() == 1);
  CHECK(got_of(bytes).contents.lost.empty());

  mcap::append_record(records, mcap::Schema{.id = 1, .name = "s", .encoding = "", .data = ""});
  mcap::append_record(records, mcap::Channel{.id = 5, .schema_id = 1, .topic = "/t"});
  mcap::append_record(records, mcap::MessageHead{.channel_id = 5, .log_time_ns = 3});
  bytes = mcap::magic;
  mcap::append_record(bytes, mcap::Header{});
  mcap::append_record(bytes, mcap::Chunk{.begin_ns = 3,
                                         .end_ns = 3,
                                         .uncompressed_size = records.size(),
                                         .compression = "",
                                         .records = {records}});
  mcap::append_record(bytes, mcap::DataEnd{});
  mcap::append_record(bytes, mcap::Footer{});
  bytes += mcap::magic;
  CHECK(got_of(bytes).messages.size() == 1);
  CHECK(got_of(bytes).contents.lost.empty());
}

TEST_CASE("a sink that fails is not asked again, and every later call says why") {
  int asked = 0;
  mcap::Writer writer([&](std::string_view) -> Result<void> {
    if (++asked < 2) return {};
    return tuina::fail(Fault::file, "the disk is full");
  });
  const std::uint16_t channel = writer.add_channel("/t", "json", {.name = "t"});
  CHECK(writer.write(channel, 0, "{}"));
  CHECK_FALSE(writer.end_chunk().has_value());
  CHECK(writer.write(channel, 1, "{}").error().message == "the disk is full");
  CHECK_FALSE(writer.finish().has_value());
  CHECK(asked == 2);
}
