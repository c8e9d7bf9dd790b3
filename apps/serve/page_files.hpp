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

/// A file of the page, and the same as gzip where the build has left it so (`NAME.gz`).
struct PageFile {
  web::Reply reply;
  std::string gzip;
};
/// The page itself by its paths, read once. Where it was not built, a page of words says how to.
using Page = std::map<std::string, PageFile, std::less<>>;
[[nodiscard]] Page read_page(const std::filesystem::path& folder);
/// The file, packed where the browser takes that; 304 where it has kept the same content.
[[nodiscard]] web::Reply reply_of(const PageFile& file, const web::Request& request);

/// JSON array of the sessions in `folder` that have ended, the newest first.
[[nodiscard]] std::string sessions_json(const std::filesystem::path& folder);

/// The report of `/sessions/NNNN/report.html`; nothing when `path` is no such path, or there is
/// none.
[[nodiscard]] std::optional<web::Reply> report_of(const std::filesystem::path& folder,
                                                  std::string_view path);

}  // namespace tuina::app
