// SPDX-License-Identifier: Apache-2.0
// One parser under libFuzzer; which one is set when it is compiled.
#include <cstddef>
#include <cstdint>

#include "tests/fuzz/parsers.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto& parser = tuina::test::parsers()[TUINA_PARSER];
  (void)parser.accepts({reinterpret_cast<const char*>(data), size});
  return 0;
}
