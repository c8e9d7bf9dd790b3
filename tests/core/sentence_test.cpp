// SPDX-License-Identifier: Apache-2.0
#include "tuina/core/sentence.hpp"

#include <doctest/doctest.h>

using namespace tuina;

TEST_CASE("a sentence has its values as the English has them, in their order") {
  const Sentence said =
      sentence("lowered", "{}: {:.1f} N instead of {:.0f} N", "press GV4", 9.96, 15.0);
  CHECK(said.words == "press GV4: 10.0 N instead of 15 N");
  CHECK(said.key == "lowered");
  CHECK(said.values == std::vector<std::string>{"press GV4", "10.0", "15"});
  CHECK(sentence("nothing", "nothing").values.empty());
  CHECK(Sentence().empty());
  CHECK(words_of(std::vector{said, sentence("nothing", "nothing")}).back() == "nothing");
}
