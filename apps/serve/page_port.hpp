// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "apps/cli/options.hpp"

namespace tuina::app {

/// The option `--port` of a verb that shows a page; `live`, if any, is the option without which
/// there is none.
inline Option add_page_port(Options& options, int& port, const Option* live = nullptr) {
  const std::string for_live = live != nullptr ? " for --live" : "";
  const auto added =
      options.add("--port", port, "of this machine" + for_live + "; 0 takes a free one")
          .between(0, 65535)
          .show_default();
  return live != nullptr ? added.needs(*live) : added;
}

}  // namespace tuina::app
