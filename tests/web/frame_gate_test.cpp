// SPDX-License-Identifier: Apache-2.0
#include "tuina/web/frame_gate.hpp"

#include <doctest/doctest.h>

#include "tuina/web/ask.hpp"

namespace tuina::web {
namespace {

// A frame as a browser masks it (RFC 6455, 5.2), with as much content as it says, or none.
std::string frame(std::uint64_t announced, char opcode = '\x81', bool with_content = true) {
  std::string all(1, opcode);
  constexpr unsigned mask = 0x80;
  const auto number = [&](int bytes) {
    for (int i = bytes - 1; i >= 0; --i) all.push_back(static_cast<char>(announced >> (8 * i)));
  };
  if (announced < 126) {
    all.push_back(static_cast<char>(mask | announced));
  } else if (announced <= 0xffff) {
    all.push_back(static_cast<char>(mask | 126U));
    number(2);
  } else {
    all.push_back(static_cast<char>(mask | 127U));
    number(8);
  }
  all += "abcd";
  return with_content ? all + std::string(announced, 'x') : all;
}

std::string passed(const std::string& said, std::size_t at_a_time, bool& shut) {
  FrameGate gate;
  std::string onwards;
  for (std::size_t i = 0; i < said.size(); i += at_a_time)
    gate.pass(std::string_view(said).substr(i, at_a_time), onwards);
  shut = gate.is_shut();
  return onwards;
}

const std::string farewell = "\x88\x02\x03\xf1";

}  // namespace

TEST_CASE("frames within the limit go on as they are, however they are cut") {
  const std::string said = frame(0) + frame(125) + frame(126) + frame(65535) +
                           frame(max_message_bytes) + frame(7, '\x8a') + frame(3, '\x01');
  for (const std::size_t at_a_time : {std::size_t{1}, std::size_t{7}, said.size()}) {
    bool shut = true;
    CHECK(passed(said, at_a_time, shut) == said);
    CHECK_FALSE(shut);
  }
}

TEST_CASE("a frame beyond the limit is a farewell, and nothing comes behind it") {
  for (const std::uint64_t bytes : {std::uint64_t{max_message_bytes} + 1, std::uint64_t{1} << 30U,
                                    std::uint64_t{1} << 63U, ~std::uint64_t{0}}) {
    const std::string said = frame(9) + frame(bytes, '\x81', false) + std::string(1000, 'x');
    for (const std::size_t at_a_time : {std::size_t{1}, std::size_t{16}, said.size()}) {
      bool shut = false;
      CHECK(passed(said, at_a_time, shut) == frame(9) + farewell);
      CHECK(shut);
    }
  }
}

TEST_CASE("a header that is not whole waits, and one without a mask is read, too") {
  bool shut = true;
  CHECK(passed("\x81", 1, shut).empty());
  CHECK(passed("\x81\xff", 2, shut).empty());
  CHECK(passed(std::string("\x81\x7f\0\0\0\0\1\0\0", 9), 9, shut).empty());
  CHECK_FALSE(shut);
  CHECK(passed(std::string("\x81\x7f\0\0\0\0\1\0\0\0", 10), 3, shut) == farewell);
  CHECK(passed("\x81\x02hi", 1, shut) == "\x81\x02hi");
}

TEST_CASE("a shut gate lets nothing pass") {
  FrameGate gate;
  gate.shut();
  std::string onwards;
  gate.pass(frame(5), onwards);
  CHECK(onwards.empty());
}

TEST_CASE("a head ends at the first empty line, and only CR LF ends a line") {
  const std::string head = "GET /live HTTP/1.1\r\nHost: here\r\n\r\n";
  CHECK(find_head_end(head + "more\r\n\r\n").at == head.size());
  for (std::size_t i = 0; i < head.size(); ++i) {
    CHECK_FALSE(find_head_end(head.substr(0, i)).at);
    CHECK_FALSE(find_head_end(head.substr(0, i)).broken);
  }
  for (const char* broken : {"GET / HTTP/1.1\n\n", "GET / HTTP/1.1\r\nHost: a\n\r\n", "\n"}) {
    CHECK(find_head_end(broken).broken);
    CHECK_FALSE(find_head_end(broken).at);
  }
}

}  // namespace tuina::web
