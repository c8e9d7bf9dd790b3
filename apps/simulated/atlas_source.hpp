// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "tuina/body/atlas.hpp"
#include "tuina/core/progress.hpp"

namespace tuina::app {

/// What --atlas accepts: nothing (the shipped atlas), an atlas file, or a labelled body (FILE.ply)
/// or folder of them, which then adapts the shipped atlas.
[[nodiscard]] Result<body::Atlas> open_atlas(const std::string& words,
                                             const Progress& progress = {});

/// Files of all labelled bodies of some folders and files, by name: the same in whatever order, and
/// over however many folders, they are given.
[[nodiscard]] Result<std::vector<std::filesystem::path>> list_labelled(
    const std::vector<std::string>& places);
/// The labelled bodies of folders and .ply files.
[[nodiscard]] Result<std::vector<body::LabelledBody>> read_labelled(
    const std::vector<std::string>& places);

}  // namespace tuina::app
