// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "apps/cli/options.hpp"
#include "tuina/history/history.hpp"

namespace tuina::app {

/// `--history`: a SQLite file or the address of a PostgreSQL server.
Option add_history_option(Options& options, std::string& address);

/// Opens what `--history` names; without it the file in `data_folder`. A file that is not there is
/// made.
[[nodiscard]] Result<history::History> open_history(const std::string& address);
/// Likewise, but a file that is named must hold something: a slip in its name shall not look like a
/// history of nobody.
[[nodiscard]] Result<history::History> open_known_history(const std::string& address);

/// The folder that the XDG base directory specification gives for such data, for whoever is logged
/// in and nobody else; made if it is not there.
[[nodiscard]] Result<std::filesystem::path> data_folder();

/// The time now: "2026-11-22T14:03:05Z".
[[nodiscard]] std::string utc_now();

/// Likewise: when a file was written last. Fails where there is none.
[[nodiscard]] Result<std::string> day_of_file(const std::filesystem::path& file);

/// A session that begins now, with an id that no other one has.
[[nodiscard]] record::VisitLabel new_visit(const std::string& who);

}  // namespace tuina::app
