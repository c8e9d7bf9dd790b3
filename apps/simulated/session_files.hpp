// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "apps/simulated/felt_back.hpp"
#include "apps/simulated/simulated_session.hpp"

namespace tuina::app {

/// The JSON object of `massage`.
[[nodiscard]] std::string session_json(const SessionResult& result, const FeltBack& felt_back,
                                       const SessionOrder& order, std::uint64_t seed);

/// session.json, config.toml, consent.toml, scan.ply, acupoints.json, plan.json, trace.csv,
/// joints.csv and distances.csv, into a folder that is made if it is not there; and of these files,
/// back.svg and report.html.
[[nodiscard]] Result<void> write_session(const SessionResult& result, const session::Config& config,
                                         const std::string& json,
                                         const std::filesystem::path& folder);

/// What happened, in a few lines for people.
[[nodiscard]] std::string session_text(const SessionResult& result);

}  // namespace tuina::app
