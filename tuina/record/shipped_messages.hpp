// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string_view>

namespace tuina::record {

/// Messages of one language: its tag, and the JSON object of page/messages.
struct ShippedMessages {
  std::string_view tag;
  std::string_view json;
};

/// Those that are built in. English needs none.
[[nodiscard]] std::span<const ShippedMessages> shipped_messages();

}  // namespace tuina::record
