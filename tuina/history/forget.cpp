// SPDX-License-Identifier: Apache-2.0
// Parts of `History` that remove: sessions that did not begin after all, and people.
#include <filesystem>
#include <system_error>

#include "tuina/core/io/file.hpp"
#include "tuina/history/history.hpp"
#include "tuina/history/schema.hpp"
#include "tuina/record/session_file.hpp"

namespace tuina::history {

namespace fs = std::filesystem;

Result<void> History::take_back(const record::VisitLabel& label) {
  const Value id[] = {label.id}, who[] = {label.who};
  auto transaction = Transaction::begin(*database_);
  if (!transaction) return tl::unexpected(transaction.error());
  if (auto gone = database_->run("DELETE FROM session WHERE id = $1 AND ended = 0", id); !gone)
    return gone;
  if (auto gone = database_->run(
          "DELETE FROM person WHERE name = $1 AND NOT EXISTS (SELECT 1 FROM session WHERE who = "
          "$1) AND NOT EXISTS (SELECT 1 FROM note WHERE who = $1)",
          who);
      !gone)
    return gone;
  return transaction->commit();
}

Result<bool> History::left_unfinished(const Visit& visit) {
  std::error_code fault;
  if (visit.ended || fs::exists(fs::path(visit.folder) / "session.json", fault)) return false;
  const Value where[] = {visit.folder, visit.began};
  const auto later =
      database_->query("SELECT 1 FROM session WHERE folder = $1 AND began > $2", where);
  if (!later) return tl::unexpected(later.error());
  return later->empty();
}

Result<std::vector<KeptFolder>> History::forget(const std::string& who, const std::string& at) {
  const auto visits = visits_of(who);
  if (!visits) return tl::unexpected(visits.error());
  std::vector<KeptFolder> kept;
  // Folders go first: a fault in between leaves rows that still say what there is to remove.
  for (const Visit& visit : *visits) {
    std::error_code fault;
    const bool there = fs::exists(visit.folder, fault);
    if (fault)
      return fail(Fault::file, "{}: {}; nobody is forgotten yet", visit.folder, fault.message());
    if (!there) continue;
    if (is_being_written(fs::path(visit.folder) / "session.mcap"))
      return fail(Fault::file, "{}: a session is running there; nobody is forgotten yet",
                  visit.folder);
    const auto unfinished = left_unfinished(visit);
    if (!unfinished) return tl::unexpected(unfinished.error());
    if (!*unfinished && !still_in_its_folder(visit)) {
      kept.push_back({visit.folder, true});
      continue;
    }
    // session.json is the last to go: until then a second attempt finds the session.
    for (const char* name : record::files_of_session) {
      // A program that was killed has left the file that it was writing.
      for (const char* end : {".part", ""}) {
        if (fs::remove(fs::path(visit.folder) / (name + std::string(end)), fault); fault)
          return fail(Fault::file, "{}/{}{}: {}; nobody is forgotten yet", visit.folder, name, end,
                      fault.message());
      }
    }
    // Whoever keeps something of their own beside a session keeps it.
    if (!fs::remove(visit.folder, fault)) kept.push_back({visit.folder, false});
  }
  auto transaction = Transaction::begin(*database_);
  if (!transaction) return tl::unexpected(transaction.error());
  const Value person[] = {who};
  const Value trace[] = {at, static_cast<std::int64_t>(visits->size())};
  if (const auto gone = database_->run("DELETE FROM person WHERE name = $1", person); !gone)
    return tl::unexpected(gone.error());
  if (const auto said = database_->run("INSERT INTO forgotten VALUES ($1, $2)", trace); !said)
    return tl::unexpected(said.error());
  if (const auto done = transaction->commit(); !done) return tl::unexpected(done.error());
  if (const auto clean = database_->scrub(); !clean) return tl::unexpected(clean.error());
  return kept;
}

}  // namespace tuina::history
