// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "tuina/core/result.hpp"

namespace tuina {

/// True of a device or a pipe (/dev/stdout): it cannot be renamed over.
[[nodiscard]] bool is_written_in_place(const std::filesystem::path& path);
/// What a link leads to, also where nothing is there yet; the path itself when it is none.
[[nodiscard]] std::filesystem::path behind_links(std::filesystem::path path);
/// Where a `FileWriter` keeps a file until it is whole; links have been followed.
[[nodiscard]] std::filesystem::path part_of(const std::filesystem::path& target);
/// What is said of such a file that somebody else has left: it may be all there is of a session.
[[nodiscard]] Error left_there(const std::filesystem::path& part);

/// Refuses before the work what `FileWriter::open` would refuse after it: a name that leaves no
/// room for `.part`, and a `.part` that is there. Fails with Fault::file.
[[nodiscard]] Result<void> check_can_begin(const std::filesystem::path& path);

}  // namespace tuina
