// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "tuina/history/database.hpp"
#include "tuina/history/visit.hpp"

namespace tuina::history {

/// Somebody who has had sessions.
struct Person {
  std::string name;
  std::string since;  ///< day and time of the first session
  std::int64_t sessions = 0;
};

/// Words of a therapist about a person.
struct Note {
  std::string at;  ///< day and time
  std::string words;
};

/// What rebuilding has found.
struct Rebuilt {
  std::int64_t sessions = 0;
  std::vector<std::string> left_out;  ///< folders and why
};

/// A folder that is left when its person is forgotten.
struct KeptFolder {
  std::string folder;
  bool other_session = false;  ///< or none that is whole; else files that no session leaves
};

/// People and their sessions over time: an index of session folders that can be made anew of them.
/// What is written is on the disk as a whole before a call returns, or not there at all.
class History {
 public:
  /// `address` as `open_database` takes it; the tables are made or brought up to date.
  [[nodiscard]] static Result<History> open(const std::string& address);

  /// A session begins: should nothing follow, it was cut short. One that is there already stays.
  [[nodiscard]] Result<void> begin(const record::VisitLabel& label,
                                   const std::filesystem::path& folder);
  /// A whole session; one with the same id is replaced.
  [[nodiscard]] Result<void> add(const Visit& visit);
  /// Adds words about somebody who is known. Fails as the database does.
  [[nodiscard]] Result<void> add_note(const std::string& who, const Note& note);

  /// Everybody, in the order of their names.
  [[nodiscard]] Result<std::vector<Person>> people();
  /// Takes back that a session has begun, where it was refused before anything was done; and its
  /// person, of whom nothing else is known. A session that has ended stays.
  [[nodiscard]] Result<void> take_back(const record::VisitLabel& label);
  /// In the order of time; empty for somebody who is not known.
  [[nodiscard]] Result<std::vector<Visit>> visits_of(const std::string& who);
  /// In the order of time; empty for somebody who is not known.
  [[nodiscard]] Result<std::vector<Note>> notes_of(const std::string& who);

  /// Removes the rows of somebody and the files of their sessions, and keeps only that somebody was
  /// forgotten `at`. Returned: the folders that stay.
  [[nodiscard]] Result<std::vector<KeptFolder>> forget(const std::string& who,
                                                       const std::string& at);
  /// Adds every session of somebody that lies in or below a folder.
  [[nodiscard]] Result<Rebuilt> rebuild(const std::filesystem::path& folder);

  /// Its connection.
  [[nodiscard]] Database& database() { return *database_; }

 private:
  explicit History(std::unique_ptr<Database> database) : database_(std::move(database)) {}
  [[nodiscard]] Result<void> insert(const Visit& visit);
  [[nodiscard]] Result<void> fill(Visit& visit);
  /// Whether the session was cut short and nothing has come into its folder since.
  [[nodiscard]] Result<bool> left_unfinished(const Visit& visit);

  std::unique_ptr<Database> database_;
};

}  // namespace tuina::history
