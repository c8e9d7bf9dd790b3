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

/// A file of the page, and the same as gzip.
struct PageFile {
  web::Reply reply;
  std::string gzip;
};
/// The page itself by its paths, read once: what `packed_page` has, or from the folder that is
/// named instead. Where it was not built, a page of words says how to.
using Page = std::map<std::string, PageFile, std::less<>>;
[[nodiscard]] Page read_page(const std::filesystem::path& folder);
/// The file, packed where the browser takes that; 304 where it has kept the same content.
[[nodiscard]] web::Reply reply_of(const PageFile& file, const web::Request& request);

/// NNNN of the path `/sessions/NNNN` followed by `name`; nothing when `path` is no such path.
[[nodiscard]] std::optional<std::string> session_number(std::string_view path,
                                                        std::string_view name);

/// JSON of the sessions in `folder` that have ended: the newest ones, the newest first, and how
/// many there are. Whose they were is told where `names` is true.
[[nodiscard]] std::string sessions_json(const std::filesystem::path& folder, bool names);

/// A report as a browser gets it; 404 where there is none.
[[nodiscard]] web::Reply report_reply(Result<std::string> report);

}  // namespace tuina::app
