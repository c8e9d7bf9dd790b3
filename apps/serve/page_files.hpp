// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "tuina/core/result.hpp"
#include "tuina/web/request.hpp"

namespace tuina::app {

/// The page itself, read once. Where it was not built, a page of words says how to.
[[nodiscard]] std::map<std::string, web::Reply, std::less<>> read_page(
    const std::filesystem::path& folder);

/// JSON array of the sessions in `folder` that have ended, the newest first.
[[nodiscard]] std::string sessions_json(const std::filesystem::path& folder);

/// The report of `/sessions/NNNN/report.html`; nothing when `path` is no such path, or there is
/// none.
[[nodiscard]] std::optional<web::Reply> report_of(const std::filesystem::path& folder,
                                                  std::string_view path);

}  // namespace tuina::app
