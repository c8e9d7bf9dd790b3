// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>

#include "tuina/core/result.hpp"

struct stat;

namespace tuina {

/// True of a device or a pipe, and of what this process has open (/dev/stdout): it cannot be
/// renamed over.
[[nodiscard]] bool is_written_in_place(const std::filesystem::path& path);
/// The descriptor of this process that a path such as /dev/stdout or /proc/self/fd/3 stands for.
[[nodiscard]] std::optional<int> open_descriptor_of(std::filesystem::path path);
/// What a link leads to, also where nothing is there yet; the path itself when it is none.
[[nodiscard]] std::filesystem::path behind_links(std::filesystem::path path);
/// Where a `FileWriter` keeps a file until it is whole; links have been followed.
[[nodiscard]] std::filesystem::path part_of(const std::filesystem::path& target);
/// What is said of such a file that somebody else has left: it may be all there is of a session.
[[nodiscard]] Error left_there(const std::filesystem::path& part);
/// Makes and locks FOLDER.part, where a folder is kept until it is whole; the lock is what it
/// gives, to be closed. Fails with Fault::file where one is there: it may be all there is of a
/// sweep.
[[nodiscard]] Result<int> begin_folder(const std::filesystem::path& folder);
/// Whether a file is as a `FileWriter` has just made it, of this user and under this name alone:
/// somebody else could read what is written into another.
[[nodiscard]] bool is_empty_and_own(const struct ::stat& found);

/// Refuses before the work what `FileWriter::open` would refuse after it: a name that leaves no
/// room for `.part`, and a `.part` that is there. Fails with Fault::file.
[[nodiscard]] Result<void> check_can_begin(const std::filesystem::path& path);

}  // namespace tuina
