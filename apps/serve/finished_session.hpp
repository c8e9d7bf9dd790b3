// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "tuina/core/language.hpp"
#include "tuina/web/request.hpp"

namespace tuina::app {

/// What a page plays a finished session from, made of the session.mcap in `folder`: the number of
/// bytes of the back (uint32, little-endian), the back (`back_bytes`), then a JSON object. That has
/// map and plan (`map_json`, `plan_json`), what was `performed` and why otherwise than ordered,
/// `events` and `frames` as of a running session, rows of `forces`, and what is `lost` of the
/// record. At most 6000 frames and 24000 rows, whatever the length. 404 with one line where there
/// is no such record, or none that can be played; 503 while another one is read, so that memory is
/// that of one record of 512 MB at most.
[[nodiscard]] web::Reply play_of_session(const std::filesystem::path& folder);

/// The report of the session in `folder`, made again in a language; 404 where there is no session,
/// 503 while another one is read.
[[nodiscard]] web::Reply report_of_session(const std::filesystem::path& folder,
                                           const Language& language);

}  // namespace tuina::app
