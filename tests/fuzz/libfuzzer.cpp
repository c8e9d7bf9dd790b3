// SPDX-License-Identifier: Apache-2.0
// One parser under libFuzzer; which one is set when it is compiled.
#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "tests/fuzz/parsers.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const auto& all = tuina::test::parsers();
  static const auto parser = std::find_if(all.begin(), all.end(),
                                          [](const auto& any) { return any.name == TUINA_PARSER; });
  tuina::test::demand(parser != all.end(), "no parser has this name");
  (void)parser->accepts({reinterpret_cast<const char*>(data), size});
  return 0;
}
