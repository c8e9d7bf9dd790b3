// SPDX-License-Identifier: Apache-2.0
#include "tuina/history/schema.hpp"

namespace tuina::history {
namespace {

/// What leads from one schema to the next. A step that has been released never changes; another one
/// follows it. What both databases understand alike is used, so it stands here once.
struct Step {
  std::vector<const char*> statements;
  std::vector<const char*> of_accounts = {};  ///< where each who comes has an account
};

const std::vector<Step> steps = {
    {{"CREATE TABLE person (name TEXT PRIMARY KEY, since TEXT NOT NULL)",
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
      "PRIMARY KEY (session, number))"}},
    {{"CREATE TABLE note (who TEXT NOT NULL REFERENCES person(name) ON DELETE CASCADE, "
      "at TEXT NOT NULL, words TEXT NOT NULL)",
      // That somebody was forgotten, and when: not who.
      "CREATE TABLE forgotten (at TEXT NOT NULL, sessions BIGINT NOT NULL)",
      "CREATE INDEX session_of_person ON session (who, began)"}},
    // What was ruled out or put right by hand, as in session.json.
    {{"ALTER TABLE session ADD COLUMN said TEXT"}},
    // Factor on every force as the wishes have left it; NULL of sessions before.
    {{"ALTER TABLE session ADD COLUMN intensity DOUBLE PRECISION"}},
    // Robots, and what they did: not a word of the people, so that who mends them may read it.
    {{"CREATE TABLE machine (name TEXT PRIMARY KEY, model TEXT, version TEXT, calibrated TEXT, "
      "seen TEXT NOT NULL, doing TEXT NOT NULL)",
      "CREATE TABLE machine_session (id TEXT PRIMARY KEY, machine TEXT NOT NULL REFERENCES "
      "machine(name) ON DELETE CASCADE, began TEXT NOT NULL, ended BIGINT NOT NULL, "
      "duration_s DOUBLE PRECISION, stops BIGINT, stop_cause TEXT, force_rmse_n DOUBLE PRECISION, "
      "force_peak_n DOUBLE PRECISION, scan_rms_m DOUBLE PRECISION, uncertainty_m DOUBLE PRECISION, "
      "left_zero_n DOUBLE PRECISION, right_zero_n DOUBLE PRECISION)",
      "CREATE INDEX session_of_machine ON machine_session (machine, began)",
      "ALTER TABLE person ADD COLUMN therapist TEXT"},
     // A person belongs to the account that entered them first; who owns the tables sees all.
     {"DO $$ BEGIN "
      "IF NOT EXISTS (SELECT FROM pg_roles WHERE rolname = 'tuina_therapist') "
      "THEN CREATE ROLE tuina_therapist NOLOGIN; END IF; "
      "IF NOT EXISTS (SELECT FROM pg_roles WHERE rolname = 'tuina_technician') "
      "THEN CREATE ROLE tuina_technician NOLOGIN; END IF; END $$",
      "ALTER TABLE person ALTER COLUMN therapist SET DEFAULT current_user",
      "GRANT SELECT ON migration, machine, machine_session TO tuina_technician, tuina_therapist",
      "GRANT INSERT, UPDATE ON machine, machine_session TO tuina_therapist",
      "GRANT SELECT, INSERT, UPDATE, DELETE ON person, session, acupoint, tissue, note "
      "TO tuina_therapist",
      "GRANT INSERT ON forgotten TO tuina_therapist",
      "ALTER TABLE person ENABLE ROW LEVEL SECURITY",
      "ALTER TABLE session ENABLE ROW LEVEL SECURITY",
      "ALTER TABLE acupoint ENABLE ROW LEVEL SECURITY",
      "ALTER TABLE tissue ENABLE ROW LEVEL SECURITY", "ALTER TABLE note ENABLE ROW LEVEL SECURITY",
      "CREATE POLICY own ON person TO tuina_therapist USING (therapist = current_user)",
      "CREATE POLICY own ON session TO tuina_therapist "
      "USING (EXISTS (SELECT FROM person WHERE name = who))",
      "CREATE POLICY own ON note TO tuina_therapist "
      "USING (EXISTS (SELECT FROM person WHERE name = who))",
      "CREATE POLICY own ON acupoint TO tuina_therapist "
      "USING (EXISTS (SELECT FROM session WHERE id = session))",
      "CREATE POLICY own ON tissue TO tuina_therapist "
      "USING (EXISTS (SELECT FROM session WHERE id = session))"}},
};

Result<void> run_all(Database& database, const std::vector<const char*>& statements) {
  for (const char* statement : statements) {
    if (auto done = database.run(statement); !done) return done;
  }
  return {};
}

Result<std::int64_t> schema_of(Database& database) {
  const auto numbers = database.query("SELECT COALESCE(MAX(number), 0) FROM migration", {});
  if (!numbers) return tl::unexpected(numbers.error());
  return as_whole(numbers->front().front());
}

}  // namespace

std::int64_t newest_schema() {
  return static_cast<std::int64_t>(steps.size());
}

Result<void> migrate(Database& database, std::int64_t to) {
  // An account that may only read finds the tables as they are to be.
  const auto known = schema_of(database);
  if (known && *known == newest_schema()) return {};
  auto transaction = Transaction::begin(database);
  if (!transaction) return tl::unexpected(transaction.error());
  if (auto made = database.run("CREATE TABLE IF NOT EXISTS migration (number BIGINT PRIMARY KEY)");
      !made) {
    return made;
  }
  const auto from = schema_of(database);
  if (!from) return tl::unexpected(from.error());
  if (*from > newest_schema()) {
    return fail(Fault::bad_input,
                "the history has schema {}, and this version of tuina knows schemas up to {}; a "
                "newer one has written it",
                *from, newest_schema());
  }
  for (std::int64_t number = *from + 1; number <= to; ++number) {
    const Step& step = steps[static_cast<std::size_t>(number - 1)];
    if (auto done = run_all(database, step.statements); !done) return done;
    if (database.has_accounts()) {
      if (auto done = run_all(database, step.of_accounts); !done) return done;
    }
    const Value done_step[] = {number};
    if (auto noted = database.run("INSERT INTO migration VALUES ($1)", done_step); !noted)
      return noted;
  }
  return transaction->commit();
}

}  // namespace tuina::history
