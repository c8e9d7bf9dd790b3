// SPDX-License-Identifier: Apache-2.0
#include "tuina/history/visit.hpp"

#include <algorithm>

#include "tuina/core/io/file.hpp"

namespace tuina::history {

Result<void> check_name(const std::string& who) {
  const auto allowed = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' ||
           c == '_';
  };
  if (!who.empty() && who.size() <= 40 && std::ranges::all_of(who, allowed)) return {};
  return fail(Fault::usage,
              "`{}` is no name for the history: 1 to 40 letters, digits, - and _ are; a pseudonym "
              "is enough",
              who.substr(0, 40));
}

Result<record::SessionFile> read_session_of(const std::filesystem::path& folder) {
  const auto content = read_file(folder / "session.json");
  if (!content) return tl::unexpected(content.error());
  return record::parse_session(*content, (folder / "session.json").string());
}

Result<void> is_free(const std::filesystem::path& folder) {
  const auto file = read_session_of(folder);
  if (!file || !file->visit) return {};
  return fail(Fault::file, "{}: holds the session of {} that began at {}; name another folder",
              folder.string(), file->visit->who, file->visit->began);
}

Result<void> still_in_its_folder(const Visit& visit) {
  const auto file = read_session_of(visit.folder);
  if (!file) return tl::unexpected(file.error());
  if (!file->visit || file->visit->id != visit.id)
    return fail(Fault::bad_input, "{}: holds another session by now", visit.folder);
  return {};
}

Visit visit_of(const record::SessionFile& file, const std::filesystem::path& folder) {
  Visit visit{.id = file.visit->id,
              .who = file.visit->who,
              .began = file.visit->began,
              .folder = folder.string(),
              .ended = true,
              .position = name_of(file.position),
              .programme = file.order.programme,
              .robot = file.order.robot,
              .realism = file.realism,
              .version = file.version,
              .duration_s = file.massage.duration_s,
              .force_rmse_n = file.massage.force.rmse_n,
              .force_peak_n = file.massage.force.peak_n,
              .stops = static_cast<std::int64_t>(file.stops.size()),
              .stop_cause = file.stops.empty() ? "" : file.stops.front().cause.words,
              .consent_by = file.answered_by,
              .said = file.order.said ? record::to_json(*file.order.said) : "",
              .intensity = file.massage.intensity,
              .acupoints = {},
              .tissue = {}};
  for (const auto& [time_s, command] : file.order.commands) {
    if (command == session::LiveCommand::softer) ++visit.softer;
    if (command == session::LiveCommand::firmer) ++visit.firmer;
  }
  for (const telemetry::FoundAcupoint& found : file.acupoints.points)
    visit.acupoints.push_back(found.acupoint);
  for (const telemetry::FeltTissue& felt : file.tissue) {
    visit.tissue.push_back({.name = felt.name,
                            .alpha_n = felt.estimate.tissue.alpha_n,
                            .alpha_ci95_n = felt.estimate.alpha_ci95_n,
                            .beta_per_m = felt.estimate.tissue.beta_per_m,
                            .beta_ci95_per_m = felt.estimate.beta_ci95_per_m,
                            .stiffness_n_per_mm = felt.stiffness_n_per_mm,
                            .stiffness_ci95_n_per_mm = felt.stiffness_ci95_n_per_mm,
                            .presses = felt.estimate.presses,
                            .converged = felt.estimate.converged});
  }
  return visit;
}

}  // namespace tuina::history
