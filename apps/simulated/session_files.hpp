// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "apps/simulated/simulated_session.hpp"
#include "tuina/core/sentence.hpp"
#include "tuina/record/session_file.hpp"

namespace tuina::app {

/// The numbers of a session, with the truth beside them: the answer of `massage`.
[[nodiscard]] record::SessionFile session_file(const SessionResult& result,
                                               const SessionOrder& order, std::uint64_t seed);

/// session.json, config.toml, consent.toml, scan.ply, acupoints.json, plan.json, trace.csv,
/// joints.csv and distances.csv, into a folder that is made if it is not there; and of these files,
/// back.svg and report.html.
[[nodiscard]] Result<void> write_session(const SessionResult& result, const session::Config& config,
                                         const std::string& json,
                                         const std::filesystem::path& folder);

/// Closes the record of a session, with the files attached that `write_session` has left in the
/// folder.
[[nodiscard]] Result<void> finish_record(SessionResult& result,
                                         const std::filesystem::path& folder);

/// What happened, in a few lines for people: sentences of a line follow each other.
using SentenceLine = std::vector<Sentence>;
[[nodiscard]] std::vector<SentenceLine> session_lines(const record::SessionFile& file);
/// Lines in English.
[[nodiscard]] std::string english_of(const std::vector<SentenceLine>& lines);
/// What happened, in English.
[[nodiscard]] std::string session_text(const record::SessionFile& file);

}  // namespace tuina::app
