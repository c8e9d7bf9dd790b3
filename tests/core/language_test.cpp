// SPDX-License-Identifier: Apache-2.0
#include "tuina/core/language.hpp"

#include <doctest/doctest.h>

using namespace tuina;

TEST_CASE("a language says what it has a message for, and leaves the rest in English") {
  const Language backwards("x-back", {{"press", "sserp"},
                                      {"to", "ot"},
                                      {"lowered", "{1} si {0}"},
                                      {"{} of {:.1f} N", "N {1} fo {0}"},
                                      {"spine", "enips"}});
  CHECK(backwards.tag() == "x-back");
  CHECK(backwards("spine") == "enips");
  CHECK(backwards("neck") == "neck");
  CHECK(backwards("press SI11_L to BL50_L") == "sserp SI11_L ot BL50_L");
  CHECK(backwards("neck to spine") == "neck to spine");
  CHECK(backwards(sentence("lowered", "{}: {:.0f} N", "spine", 8.0)) == "8 si enips");
  CHECK(backwards(sentence("raised", "{}: {:.0f} N", "spine", 8.0)) == "spine: 8 N");
  CHECK(backwards(Sentence{.words = "spine"}) == "enips");
  CHECK(backwards("{} of {:.1f} N", "press GV4", 7.96) == "N 8.0 fo sserp GV4");
  CHECK(Language()("{} of {:.1f} N", "press GV4", 7.96) == "press GV4 of 8.0 N");
  CHECK(Language().tag() == "en");
}

TEST_CASE(
    "a value may hold what stands for a value in messages, and a message none that there is") {
  const Language odd("x-odd", {{"two", "{1}{0}{7}"}, {"open", "{0"}});
  CHECK(odd(Sentence{.words = "", .key = "two", .values = {"{1}", "{0}"}}) == "{0}{1}");
  CHECK(odd(Sentence{.words = "", .key = "open", .values = {"a"}}) == "{0");
}
