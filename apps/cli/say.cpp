// SPDX-License-Identifier: Apache-2.0
#include "apps/cli/say.hpp"

#include <cstdio>

namespace tuina::app {

void say(std::string_view words) noexcept {
  (void)std::fwrite(words.data(), 1, words.size(), stderr);
  (void)std::fflush(stderr);
}

}  // namespace tuina::app
