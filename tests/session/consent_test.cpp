// SPDX-License-Identifier: Apache-2.0
#include "tuina/session/consent.hpp"

#include <doctest/doctest.h>

#include "tests/reason.hpp"

using namespace tuina;
using namespace tuina::session;

namespace {

std::string replaced(std::string text, const std::string& what, const std::string& with) {
  const auto at = text.find(what);
  REQUIRE(at != std::string::npos);
  return text.replace(at, what.size(), with);
}

}  // namespace

TEST_CASE("ten questions answered with no let the arms be armed") {
  const auto consent = parse_consent(consent_form("P. Smith", "no"), "consent.toml");
  REQUIRE_MESSAGE(consent.has_value(), test::reason(consent));
  CHECK(consent->answered_by == "P. Smith");
}

TEST_CASE("each single question that is yes, unknown, empty or missing refuses, and is named") {
  const std::string good = consent_form("P. Smith", "no");
  for (const HealthQuestion& question : health_questions) {
    CAPTURE(question.key);
    const std::string answered = std::string(question.key) + " = \"no\"";
    for (const char* answer : {"yes", "unknown", "", "maybe"}) {
      const auto refused = parse_consent(
          replaced(good, answered, fmt::format("{} = \"{}\"", question.key, answer)), "c.toml");
      REQUIRE_FALSE(refused.has_value());
      CHECK(refused.error().message.find(question.key) != std::string::npos);
      const bool known = std::string_view(answer) == "yes" || std::string_view(answer) == "unknown";
      CHECK(refused.error().fault == (known ? Fault::stopped : Fault::config));
    }
    const auto missing = parse_consent(replaced(good, answered, ""), "c.toml");
    REQUIRE_FALSE(missing.has_value());
    CHECK(missing.error().message.find(fmt::format("`{}` is not answered", question.key)) !=
          std::string::npos);
  }
}

TEST_CASE(
    "a form that nobody filled in, nobody's answers and a question nobody asked are refused") {
  CHECK_FALSE(parse_consent(consent_form(), "c.toml").has_value());
  CHECK_FALSE(parse_consent(consent_form("", "no"), "c.toml").has_value());
  CHECK_FALSE(parse_consent(consent_form("   ", "no"), "c.toml").has_value());
  CHECK_FALSE(parse_consent("", "c.toml").has_value());
  const auto unknown =
      parse_consent(consent_form("P. Smith", "no") + "pacemakers = \"no\"\n", "c.toml");
  REQUIRE_FALSE(unknown.has_value());
  CHECK(unknown.error().message.find("is `pacemaker` meant?") != std::string::npos);
}
