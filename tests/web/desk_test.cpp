// SPDX-License-Identifier: Apache-2.0
#include "tuina/web/desk.hpp"

#include <doctest/doctest.h>

namespace tuina::web {
namespace {

constexpr ClientId anna = 1, ben = 2;

/// Two pages, each with sequence numbers of its own.
struct TwoPages {
  TwoPages() {
    desk.come(anna, 0.0);
    desk.come(ben, 0.0);
  }
  Refusal ask(ClientId client, Ask what, double now_s) {
    return desk.judge(client, {.ask = what, .sequence = ++sequence, .clock_s = now_s}, now_s);
  }
  Desk desk;
  std::uint64_t sequence = 0;
};

TEST_CASE("all asks have a name, and the live commands are those of the keyboard") {
  int live = 0;
  for (std::size_t i = 0; i < ask_names.size(); ++i)
    live += live_command(static_cast<Ask>(i)).has_value() ? 1 : 0;
  CHECK(live == static_cast<int>(session::live_command_names.size()));
  CHECK(live_command(Ask::softer) == session::LiveCommand::softer);
  CHECK_FALSE(live_command(Ask::arm).has_value());
}

TEST_CASE("a viewer may stop and nothing else") {
  TwoPages pages;
  CHECK(pages.ask(anna, Ask::operate, 0.0) == Refusal::none);
  for (const Ask ask : {Ask::start, Ask::hold, Ask::arm, Ask::pause, Ask::resume, Ask::skip,
                        Ask::repeat, Ask::softer, Ask::firmer, Ask::hand_over}) {
    CAPTURE(name_of(ask));
    CHECK(pages.ask(ben, ask, 0.1) == Refusal::viewer);
  }
  CHECK(pages.ask(ben, Ask::stop, 0.1) == Refusal::none);
  CHECK(pages.desk.operator_at(0.1) == anna);
}

TEST_CASE("who came to watch may stop and nothing else, also when nobody is in control") {
  TwoPages pages;
  constexpr ClientId visitor = 3;
  pages.desk.come(visitor, 0.0, Role::watch);
  for (std::size_t i = 0; i < ask_names.size(); ++i) {
    const auto ask = static_cast<Ask>(i);
    CAPTURE(name_of(ask));
    const bool may = ask == Ask::beat || ask == Ask::stop;
    CHECK(pages.ask(visitor, ask, 0.1) == (may ? Refusal::none : Refusal::viewer));
  }
  CHECK_FALSE(pages.desk.operator_at(0.1).has_value());
  for (const Ask ask : {Ask::invite, Ask::invite_operator})
    CHECK(pages.ask(anna, ask, 0.1) == Refusal::none);
}

TEST_CASE("there is one operator, until they leave, hand over or fall silent") {
  TwoPages pages;
  CHECK(pages.ask(anna, Ask::operate, 0.0) == Refusal::none);
  CHECK(pages.ask(ben, Ask::operate, 1.0) == Refusal::taken);
  CHECK(pages.ask(anna, Ask::hand_over, 1.5) == Refusal::none);
  CHECK(pages.ask(ben, Ask::operate, 1.6) == Refusal::none);
  CHECK(pages.ask(ben, Ask::beat, 3.0) == Refusal::none);
  CHECK(pages.desk.operator_at(4.9) == ben);
  CHECK_FALSE(pages.desk.operator_at(5.1).has_value());
  CHECK(pages.ask(ben, Ask::pause, 5.2) == Refusal::viewer);
  CHECK(pages.ask(anna, Ask::operate, 5.3) == Refusal::none);
  pages.desk.go(anna);
  CHECK_FALSE(pages.desk.operator_at(5.4).has_value());
}

TEST_CASE("an ask counts once, in its order, and only while it is fresh") {
  Desk desk;
  desk.come(anna, 10.0);
  const auto ask = [&](std::uint64_t sequence, double clock_s) {
    return desk.judge(anna, {.ask = Ask::beat, .sequence = sequence, .clock_s = clock_s}, 10.0);
  };
  CHECK(ask(5, 10.0) == Refusal::none);
  CHECK(ask(5, 10.0) == Refusal::out_of_order);
  CHECK(ask(4, 10.0) == Refusal::out_of_order);
  CHECK(ask(6, 9.4) == Refusal::stale);
  CHECK(ask(7, 10.6) == Refusal::stale);
  CHECK(ask(8, 9.6) == Refusal::none);
}

TEST_CASE("stop is never too old, too often or out of order") {
  Desk desk;
  desk.come(anna, 0.0);
  for (int i = 0; i < 1000; ++i)
    CHECK(desk.judge(anna, {.ask = Ask::stop, .sequence = 0, .clock_s = -1e9}, 1.0) ==
          Refusal::none);
}

TEST_CASE("a page may ask twenty times a second") {
  TwoPages pages;
  int let = 0;
  for (int i = 0; i < 100; ++i) let += pages.ask(anna, Ask::beat, 1.0) == Refusal::none ? 1 : 0;
  CHECK(let == 20);
  CHECK(pages.ask(anna, Ask::beat, 1.0) == Refusal::too_fast);
  CHECK(pages.ask(anna, Ask::beat, 1.1) == Refusal::none);
}

TEST_CASE("the arms are armed by who has held the button for two seconds") {
  TwoPages pages;
  CHECK(pages.ask(anna, Ask::operate, 0.0) == Refusal::none);
  CHECK(pages.ask(anna, Ask::arm, 0.1) == Refusal::not_held);
  CHECK(pages.ask(anna, Ask::hold, 0.2) == Refusal::none);
  CHECK(pages.ask(anna, Ask::arm, 1.9) == Refusal::not_held);
  CHECK(pages.ask(anna, Ask::arm, 3.0) == Refusal::not_held);  // each hold counts once
  CHECK(pages.ask(anna, Ask::hold, 3.1) == Refusal::none);
  CHECK(pages.ask(anna, Ask::beat, 4.1) == Refusal::none);
  CHECK(pages.ask(anna, Ask::arm, 5.2) == Refusal::none);
}

TEST_CASE("whoever asks for another plan has to hold the button anew") {
  TwoPages pages;
  CHECK(pages.ask(anna, Ask::operate, 0.0) == Refusal::none);
  CHECK(pages.ask(anna, Ask::hold, 0.2) == Refusal::none);
  CHECK(pages.ask(anna, Ask::change, 1.0) == Refusal::none);
  CHECK(pages.ask(anna, Ask::beat, 2.0) == Refusal::none);
  CHECK(pages.ask(anna, Ask::arm, 2.5) == Refusal::not_held);
}

TEST_CASE("of a message, what is missing, unknown or of another kind is refused") {
  CHECK(parse_message(R"({"ask":"pause","sequence":7,"clock_s":1.5})").value().ask == Ask::pause);
  CHECK(parse_message(R"({"ask":"arm","sequence":7,"clock_s":1,"review":3})").value().review == 3);
  for (const char* text :
       {"", "[]", "{", R"({"sequence":7,"clock_s":1})",
        R"({"ask":"jump","sequence":7,"clock_s":1})", R"({"ask":"pause","clock_s":1})",
        R"({"ask":"pause","sequence":-7,"clock_s":1})", R"({"ask":"pause","sequence":7})",
        R"({"ask":"pause","sequence":7,"clock_s":"1"})",
        R"({"ask":"pause","sequence":7,"clock_s":1e999})",
        R"({"ask":"pause","sequence":7,"clock_s":1,"force_n":99})",
        R"({"ask":"pause","sequence":7,"clock_s":1,"order":{}})",
        R"({"ask":"arm","sequence":7,"clock_s":1,"review":-1})",
        R"({"ask":"start","sequence":7,"clock_s":1})", R"({"ask":7,"sequence":7,"clock_s":1})"}) {
    CAPTURE(text);
    CHECK_FALSE(parse_message(text).has_value());
  }
  CHECK_FALSE(parse_message(std::string(max_message_bytes + 1, ' ')).has_value());
}

}  // namespace
}  // namespace tuina::web
