// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

namespace tuina::app {

/// Writes words for people to stderr at once. Where that cannot be written, because a disk is full
/// or a terminal was closed, they are lost: nobody stops an arm, or leaves one pressing, for that.
void say(std::string_view words) noexcept;

}  // namespace tuina::app
