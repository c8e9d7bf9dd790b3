// SPDX-License-Identifier: Apache-2.0
#include "tuina/telemetry/page.hpp"

#include <doctest/doctest.h>

#include <limits>

#include "tests/telemetry/words.hpp"

using namespace tuina::telemetry;
using tuina::tests::holds;
using tuina::tests::words_of;

namespace {

Table sample_table() {
  Table table{.title = "Forces",
              .note = "of two runs",
              .columns = {{.head = "run"},
                          {.head = "error, N", .key = "rmse_n", .digits = 2},
                          {.key = "secret"},
                          {.head = "outcome"}}};
  table.add({"first", {0.1234, "± 0.1"}, 1.0, "α < β"});
  table.add({"second", std::numeric_limits<double>::quiet_NaN(), 2.0, {}});
  return table;
}

}  // namespace

TEST_CASE(
    "a table in the terminal has columns that stand below their heads, numbers to the right") {
  CHECK(to_text(sample_table()) ==
        "Forces\n"
        "  run       error, N  outcome\n"
        "  first   0.12 ± 0.1  α < β\n"
        "  second           -\n"
        "  of two runs\n");
}

TEST_CASE("a long head takes several lines, and the shorter ones stand on the last") {
  Table table{.columns = {{.head = "run"}, {.head = "force over what the zone bears"}}};
  table.add({"a", 3});
  CHECK(to_text(table) ==
        "       force over\n"
        "         what the\n"
        "  run  zone bears\n"
        "  a             3\n");
}

TEST_CASE("a page shows a table with its groups, and words from outside cannot become markup") {
  Table table = sample_table();
  table.rows[1].group = "<b>later</b>";
  Page page({.title = "<script>", .lead = "one & all"});
  page.section("A <i>section</i>", "about").table(table).list({"<img>"}).note("");
  const std::string html = page.str();
  CHECK(words_of(html).find("first 0.12 ± 0.1 α < β <b>later</b> second -") != std::string::npos);
  for (const char* markup : {"<script>", "<i>section", "<b>later", "<img>", "secret"}) {
    CAPTURE(markup);
    CHECK_FALSE(holds(html, markup));
  }
}

TEST_CASE("a page stays whole when a section is filled after the next one was begun") {
  Page page({.title = "page"});
  Part& first = page.section("first");
  for (int k = 0; k < 50; ++k) page.section("another");
  first.text("said late");
  const std::string words = words_of(page.str());
  CHECK(words.find("said late") < words.find("another"));
}

TEST_CASE("a number that rounds to zero has no sign") {
  CHECK(shown(-0.001, {.digits = 1}) == "0.0");
  CHECK(shown(-0.06, {.digits = 1}) == "-0.1");
  CHECK(shown(0.35, {}) == "0.35");
  CHECK(shown(true, {}) == "yes");
}
