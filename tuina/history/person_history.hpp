// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "tuina/history/change.hpp"
#include "tuina/history/history.hpp"

namespace tuina::history {

/// Everything that the history holds of somebody; sessions in the order of time.
struct PersonHistory {
  std::string who;
  std::vector<Visit> visits;
  std::vector<Note> notes;
};

/// What can be told of the last session against the one before it in the same position in which
/// places were felt.
struct LastChange {
  const Visit* before = nullptr;
  const Visit* after = nullptr;
  Changes changes;
};
/// Nothing when no place was felt in two sessions.
[[nodiscard]] std::optional<LastChange> last_change(std::span<const Visit> visits);

/// "2026-11-22 14:03" of "2026-11-22T14:03:05Z".
[[nodiscard]] std::string day_and_time(const std::string& stamp);

/// In words: whether the whole back has really changed, which places have, or that none has.
[[nodiscard]] std::string sentence_of(const LastChange& change);
/// The same as sentences that can be said in another language.
[[nodiscard]] std::vector<Sentence> sentences_of(const LastChange& change);

/// One JSON object; a number that is not known is null.
[[nodiscard]] std::string to_json(const PersonHistory& person);

/// The tissue of all sessions, a row for each press: name of the columns first.
[[nodiscard]] std::string to_csv(const PersonHistory& person);

}  // namespace tuina::history
