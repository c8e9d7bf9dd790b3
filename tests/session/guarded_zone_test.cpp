// SPDX-License-Identifier: Apache-2.0
#include "tuina/session/guarded_zone.hpp"

#include <doctest/doctest.h>

#include <filesystem>
#include <string>

#include "tuina/core/io/file.hpp"

using namespace tuina;

TEST_CASE("in every zone the plan may ask for what the guard lets through, and both trip alike") {
  for (std::size_t i = 0; i < massage::zone_rules.size(); ++i) {
    const auto zone = static_cast<massage::Zone>(i);
    CAPTURE(massage::name_of(zone));
    const safety::ForceLimits limits = safety::ceiling_of(session::guarded_zone(zone));
    CHECK(massage::rule_of(zone).cap_n == limits.set_n);
    CHECK(massage::rule_of(zone).trip_n == limits.trip_n);
  }
}

TEST_CASE("no zone of a person has the ceilings of the bench") {
  for (std::size_t i = 0; i < massage::zone_rules.size(); ++i) {
    CHECK(session::guarded_zone(static_cast<massage::Zone>(i)) != safety::Zone::bench);
  }
}

TEST_CASE("a massage and a hand that teaches ask the one table for the guard's zone") {
  int tables = 0;
  const std::filesystem::path sources = TUINA_SOURCE_DIR;
  for (const char* folder : {"tuina", "apps"}) {
    for (const auto& entry : std::filesystem::recursive_directory_iterator(sources / folder)) {
      if (!entry.is_regular_file()) continue;
      const auto text = read_file(entry.path().string());
      REQUIRE(text.has_value());
      tables += text->find("Zone guarded_zone(") != std::string::npos;
    }
  }
  CHECK(tables == 1);
}
