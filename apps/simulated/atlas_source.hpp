// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "tuina/body/atlas.hpp"
#include "tuina/core/progress.hpp"

namespace tuina::app {

/// What --atlas accepts: nothing (the shipped atlas), an atlas file, or a labelled body (FILE.ply)
/// or folder of them, which then adapts the shipped atlas.
[[nodiscard]] Result<body::Atlas> open_atlas(const std::string& words,
                                             const Progress& progress = {});

/// The labelled bodies of folders and .ply files.
[[nodiscard]] Result<std::vector<body::LabelledBody>> read_labelled(
    const std::vector<std::string>& places);

}  // namespace tuina::app
