// SPDX-License-Identifier: Apache-2.0
#include "tuina/history/schema.hpp"

namespace tuina::history {
namespace {

/// Statements that lead from one schema to the next. A step that has been released never changes;
/// another one follows it. What both databases understand alike is used, so it stands here once.
const std::vector<std::vector<const char*>> steps = {
    {"CREATE TABLE person (name TEXT PRIMARY KEY, since TEXT NOT NULL)",
     "CREATE TABLE session (id TEXT PRIMARY KEY, who TEXT NOT NULL REFERENCES person(name) "
     "ON DELETE CASCADE, began TEXT NOT NULL, folder TEXT NOT NULL, ended BIGINT NOT NULL, "
     "position TEXT, programme TEXT, robot TEXT, realism TEXT, version TEXT, "
     "duration_s DOUBLE PRECISION, force_rmse_n DOUBLE PRECISION, force_peak_n DOUBLE PRECISION, "
     "softer BIGINT, firmer BIGINT, stops BIGINT, stop_cause TEXT, consent_by TEXT)",
     "CREATE TABLE acupoint (session TEXT NOT NULL REFERENCES session(id) ON DELETE CASCADE, "
     "name TEXT NOT NULL, x_m DOUBLE PRECISION, y_m DOUBLE PRECISION, z_m DOUBLE PRECISION, "
     "uncertainty_m DOUBLE PRECISION, PRIMARY KEY (session, name))",
     "CREATE TABLE tissue (session TEXT NOT NULL REFERENCES session(id) ON DELETE CASCADE, "
     "number BIGINT NOT NULL, name TEXT NOT NULL, alpha_n DOUBLE PRECISION, "
     "alpha_ci95_n DOUBLE PRECISION, beta_per_m DOUBLE PRECISION, "
     "beta_ci95_per_m DOUBLE PRECISION, stiffness_n_per_mm DOUBLE PRECISION, "
     "stiffness_ci95_n_per_mm DOUBLE PRECISION, presses BIGINT, converged BIGINT, "
     "PRIMARY KEY (session, number))"},
    {"CREATE TABLE note (who TEXT NOT NULL REFERENCES person(name) ON DELETE CASCADE, "
     "at TEXT NOT NULL, words TEXT NOT NULL)",
     // That somebody was forgotten, and when: not who.
     "CREATE TABLE forgotten (at TEXT NOT NULL, sessions BIGINT NOT NULL)",
     "CREATE INDEX session_of_person ON session (who, began)"},
    // What was ruled out or put right by hand, as in session.json.
    {"ALTER TABLE session ADD COLUMN said TEXT"},
    // Factor on every force as the wishes have left it; NULL of sessions before.
    {"ALTER TABLE session ADD COLUMN intensity DOUBLE PRECISION"},
};

}  // namespace

std::int64_t newest_schema() {
  return static_cast<std::int64_t>(steps.size());
}

Result<void> migrate(Database& database, std::int64_t to) {
  auto transaction = Transaction::begin(database);
  if (!transaction) return tl::unexpected(transaction.error());
  if (auto made = database.run("CREATE TABLE IF NOT EXISTS migration (number BIGINT PRIMARY KEY)");
      !made) {
    return made;
  }
  const auto numbers = database.query("SELECT COALESCE(MAX(number), 0) FROM migration", {});
  if (!numbers) return tl::unexpected(numbers.error());
  const auto from = std::get<std::int64_t>(numbers->front().front());
  if (from > newest_schema()) {
    return fail(Fault::bad_input,
                "the history has schema {}, and this version of tuina knows schemas up to {}; a "
                "newer one has written it",
                from, newest_schema());
  }
  for (std::int64_t number = from + 1; number <= to; ++number) {
    for (const char* statement : steps[static_cast<std::size_t>(number - 1)]) {
      if (auto done = database.run(statement); !done) return done;
    }
    const Value done_step[] = {number};
    if (auto noted = database.run("INSERT INTO migration VALUES ($1)", done_step); !noted)
      return noted;
  }
  return transaction->commit();
}

}  // namespace tuina::history
