// SPDX-License-Identifier: Apache-2.0
#include "tuina/core/io/csv.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "tests/core/mutation.hpp"

using namespace tuina;

namespace {

std::string refusal(std::string_view text) {
  const auto table = parse_csv(text, "yaw.csv", {"time_s", "yaw_deg"});
  REQUIRE_FALSE(table.has_value());
  CHECK(table.error().fault == Fault::bad_input);
  return table.error().message;
}

bool says(const std::string& message, std::string_view words) {
  INFO(message);
  return message.find(words) != std::string::npos;
}

}  // namespace

TEST_CASE(
    "a CSV file gives the columns asked for, in the order asked, whatever stands beside them") {
  const auto table =
      parse_csv("arm,time_s,yaw_deg\nleft,0.5,-3e1\nright,1,2\n", "yaw.csv", {"yaw_deg", "time_s"});
  REQUIRE(table.has_value());
  CHECK(table->rows() == 2);
  CHECK(table->columns[0] == std::vector<double>{-30.0, 2.0});
  CHECK(table->columns[1] == std::vector<double>{0.5, 1.0});
}

TEST_CASE(
    "CRLF, a byte-order mark, a missing last newline and blank lines at the end change nothing") {
  for (const char* text : {"time_s,yaw_deg\r\n1,2\r\n", "\xEF\xBB\xBFtime_s,yaw_deg\n1,2",
                           "time_s,yaw_deg\n1,2\n \n\n"}) {
    const auto table = parse_csv(text, "yaw.csv", {"time_s", "yaw_deg"});
    REQUIRE(table.has_value());
    CHECK(table->rows() == 1);
    CHECK(table->columns[1][0] == 2.0);
  }
}

TEST_CASE("a number may have a plus sign, but no second sign") {
  const auto table = parse_csv("time_s,yaw_deg\n+1,+2.5e+1\n", "yaw.csv", {"time_s", "yaw_deg"});
  REQUIRE(table.has_value());
  CHECK(table->columns[1][0] == 25.0);
  for (const char* word : {"+-1", "-+1", "++1", "+", "+ 1"})
    CHECK(says(refusal(fmt::format("time_s,yaw_deg\n1,{}\n", word)), "a finite number is needed"));
}

TEST_CASE("every departure from CSV is refused with its line and what would be right") {
  CHECK(says(refusal(""), "yaw.csv: is empty"));
  CHECK(says(refusal("time_s,yaw\n1,2\n"), "yaw.csv:1: no column `yaw_deg`"));
  CHECK(says(refusal("time_s,yaw_deg,time_s\n1,2,3\n"),
             "yaw.csv:1: the column `time_s` stands twice"));
  CHECK(says(refusal("time_s,yaw_deg\n"), "yaw.csv:2: no row"));
  CHECK(says(refusal("time_s,yaw_deg\n1,2\n3\n"), "yaw.csv:3: 1 cells, the header has 2"));
  CHECK(says(refusal("time_s,yaw_deg\n1,2\n\n3,4\n"), "yaw.csv:3: 1 cells"));
  CHECK(says(refusal("time_s,yaw_deg\n1,2,3\n"), "yaw.csv:2: 3 cells"));
  CHECK(says(refusal("time_s,yaw_deg\n1,two\n"), "yaw.csv:2: yaw_deg is `two`, a finite number"));
  CHECK(says(refusal("time_s,yaw_deg\n1,nan\n"), "yaw.csv:2: yaw_deg is `nan`"));
  CHECK(says(refusal("time_s,yaw_deg\n1,1e999\n"), "yaw.csv:2: yaw_deg"));
  CHECK(says(refusal("time_s,yaw_deg\n1,2mm\n"), "yaw.csv:2: yaw_deg"));
  CHECK(says(refusal("time_s,yaw_deg\n1,\n"), "yaw.csv:2: yaw_deg is ``"));
}

TEST_CASE("a CSV file with random faults is read or refused, and what is read is finite") {
  std::string good = "time_s,yaw_deg,note\r\n";
  for (int k = 0; k < 20; ++k) good += fmt::format("{},{},a b\r\n", 0.1 * k, 1e-3 * k * k - 7);
  Random random = make_random(1, "csv faults");
  int refused = 0;
  for (int k = 0; k < 5000; ++k) {
    const auto table = parse_csv(tests::mutated(good, random), "faulty.csv", {"time_s", "yaw_deg"});
    if (!table) {
      ++refused;
      CHECK(table.error().message.find("faulty.csv") == 0);
      continue;
    }
    REQUIRE(table->columns[0].size() == table->columns[1].size());
    for (const double value : table->columns[1]) REQUIRE(std::isfinite(value));
  }
  CHECK(refused > 1000);
  CHECK(refused < 5000);
}
