// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "tuina/core/result.hpp"

// A bus without a wire, for machines without CAN: a program on the same machine emulates the drives
// and takes the same frames from a socket. It is named "emulated:PROGRAM/BUS".
namespace tuina::hardware {

/// Whose drives are on a bus of this name; nothing where it is one of the kernel's.
[[nodiscard]] std::optional<std::string> emulator_of(std::string_view bus);

/// @{
/// A socket that carries a `can_frame` each time, from the host's side, and one that takes hosts on
/// the drives' side. Fails with Fault::device, where nobody is there or somebody is already.
[[nodiscard]] Result<int> connect_to_emulated(const std::string& bus);
[[nodiscard]] Result<int> listen_as_emulated(const std::string& bus);
/// @}

}  // namespace tuina::hardware
