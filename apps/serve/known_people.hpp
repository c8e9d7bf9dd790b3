// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "tuina/core/result.hpp"
#include "tuina/core/sentence.hpp"
#include "tuina/core/surface.hpp"
#include "tuina/record/session_file.hpp"

namespace tuina::app {

/// What earlier sessions of a person say for the next one.
enum class RememberedKind : std::uint8_t {
  by_hand,  ///< places ruled out, and points put right
  wish,     ///< how firm the last session ended
  tissue,   ///< what it has felt
};
inline constexpr std::array<const char*, 3> remembered_names = {"by_hand", "wish", "tissue"};
[[nodiscard]] constexpr const char* name_of(RememberedKind kind) noexcept {
  return remembered_names[static_cast<std::size_t>(kind)];
}

/// One of these, in words for people.
struct RememberedItem {
  RememberedKind kind = RememberedKind::by_hand;
  Sentence words;
};
/// Whether each is to be used; nothing: nobody has said.
using Confirmed = std::array<std::optional<bool>, remembered_names.size()>;

/// Somebody as their history knows them.
struct RememberedPerson {
  std::size_t sessions = 0;           ///< earlier ones
  std::vector<RememberedItem> items;  ///< to be confirmed before they are used
  std::vector<Sentence> changes;      ///< from the last but one session to the last one
};

/// The people of a history, for a page; empty where there is no history. All may be called from
/// any thread, and may take as long as a server does.
struct KnownPeople {
  /// Pseudonyms, in their order. Refused to an account that may know nobody.
  std::function<Result<std::vector<std::string>>()> names = {};
  /// What is remembered of somebody in a position, or in any.
  std::function<Result<RememberedPerson>(const std::string& who,
                                         std::optional<BodyPosture> position)>
      find = {};
  /// Puts what was confirmed into an order, and enters that a session of `folder` begins. Refused
  /// where something is remembered that nobody has confirmed or denied.
  std::function<Result<record::VisitLabel>(const std::string& who, const Confirmed& confirmed,
                                           record::SessionOrder& order,
                                           const std::filesystem::path& folder)>
      begin = {};
  /// Forgets that a session began which did not after all.
  std::function<void(const record::VisitLabel& visit)> take_back = {};
  /// Adds the session that has ended; what has changed since the one before.
  std::function<Result<std::vector<Sentence>>(const record::SessionFile& file,
                                              const std::filesystem::path& folder)>
      end = {};
};

}  // namespace tuina::app
