// SPDX-License-Identifier: Apache-2.0
#include "tests/fuzz/parsers.hpp"

#include <cstdio>
#include <cstdlib>

namespace tuina::test {

void demand(bool sound, const char* what) {
  if (sound) return;
  std::fprintf(stderr, "not sound: %s\n", what);
  std::abort();
}

const std::vector<Parser>& parsers() {
  static const std::vector<Parser> all = [] {
    std::vector<Parser> every = scanner_parsers();
    for (const auto& more :
         {person_parsers(), session_parsers(), device_parsers(), can_parsers(), guard_frames()}) {
      every.insert(every.end(), more.begin(), more.end());
    }
    return every;
  }();
  return all;
}

}  // namespace tuina::test
