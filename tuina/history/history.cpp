// SPDX-License-Identifier: Apache-2.0
#include "tuina/history/history.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "tuina/history/schema.hpp"

namespace tuina::history {

namespace fs = std::filesystem;

namespace {

/// What is no text could be stored and never be given out again as JSON.
Result<void> check_text(const std::string& words, const char* what) {
  try {
    (void)nlohmann::json(words).dump();
    return {};
  } catch (const nlohmann::json::exception&) {
    return fail(Fault::usage, "{}: is no text in UTF-8; is the terminal set to another encoding?",
                what);
  }
}

}  // namespace

Result<History> History::open(const std::string& address) {
  auto database = open_database(address);
  if (!database) return tl::unexpected(database.error());
  if (const auto migrated = migrate(**database); !migrated) return tl::unexpected(migrated.error());
  return History(std::move(*database));
}

Result<void> History::insert(const Visit& visit) {
  const Value person[] = {visit.who, visit.began};
  if (auto added = database_->run(
          "INSERT INTO person (name, since) VALUES ($1, $2) ON CONFLICT (name) DO NOTHING", person);
      !added) {
    return added;
  }
  const Value id[] = {visit.id};
  if (auto gone = database_->run("DELETE FROM session WHERE id = $1", id); !gone) return gone;
  const Value session[] = {visit.id,
                           visit.who,
                           visit.began,
                           visit.folder,
                           std::int64_t{visit.ended},
                           visit.position,
                           visit.programme,
                           visit.robot,
                           visit.realism,
                           visit.version,
                           visit.duration_s,
                           visit.force_rmse_n,
                           visit.force_peak_n,
                           visit.softer,
                           visit.firmer,
                           visit.stops,
                           visit.stop_cause,
                           visit.consent_by,
                           visit.said,
                           visit.intensity};
  return database_->run(
      "INSERT INTO session (id, who, began, folder, ended, position, programme, robot, realism, "
      "version, duration_s, force_rmse_n, force_peak_n, softer, firmer, stops, stop_cause, "
      "consent_by, said, intensity) VALUES ($1, $2, $3, $4, $5, $6, $7, $8, $9, $10, $11, $12, "
      "$13, $14, $15, "
      "$16, $17, $18, $19, $20)",
      session);
}

Result<void> History::begin(const record::VisitLabel& label, const fs::path& folder) {
  if (auto text = check_text(folder.string(), "the name of the session's folder"); !text)
    return text;
  auto transaction = Transaction::begin(*database_);
  if (!transaction) return tl::unexpected(transaction.error());
  // One that has ended, told of once more by whoever was late, stays as it is.
  const Value id[] = {label.id};
  const auto there = database_->query("SELECT ended FROM session WHERE id = $1", id);
  if (!there) return tl::unexpected(there.error());
  if (!there->empty()) return {};
  Visit visit;
  visit.id = label.id;
  visit.who = label.who;
  visit.began = label.began;
  visit.folder = folder.string();
  if (auto inserted = insert(visit); !inserted) return inserted;
  return transaction->commit();
}

Result<void> History::add(const Visit& visit) {
  auto transaction = Transaction::begin(*database_);
  if (!transaction) return tl::unexpected(transaction.error());
  if (auto inserted = insert(visit); !inserted) return inserted;
  for (const Acupoint& point : visit.acupoints) {
    const Value row[] = {visit.id,
                         point.name,
                         point.at_in_couch.x(),
                         point.at_in_couch.y(),
                         point.at_in_couch.z(),
                         point.uncertainty_m};
    if (auto added =
            database_->run("INSERT INTO acupoint (session, name, x_m, y_m, z_m, uncertainty_m) "
                           "VALUES ($1, $2, $3, $4, $5, $6)",
                           row);
        !added) {
      return added;
    }
  }
  std::int64_t place = 0;
  for (const VisitTissue& felt : visit.tissue) {
    const Value row[] = {visit.id,
                         place++,
                         felt.name,
                         felt.alpha_n,
                         felt.alpha_ci95_n,
                         felt.beta_per_m,
                         felt.beta_ci95_per_m,
                         felt.stiffness_n_per_mm,
                         felt.stiffness_ci95_n_per_mm,
                         felt.presses,
                         std::int64_t{felt.converged}};
    if (auto added = database_->run(
            "INSERT INTO tissue (session, number, name, alpha_n, alpha_ci95_n, beta_per_m, "
            "beta_ci95_per_m, stiffness_n_per_mm, stiffness_ci95_n_per_mm, presses, converged) "
            "VALUES ($1, $2, $3, $4, $5, $6, $7, $8, $9, $10, $11)",
            row);
        !added) {
      return added;
    }
  }
  return transaction->commit();
}

Result<void> History::add_note(const std::string& who, const Note& note) {
  if (auto text = check_text(note.words, "the note"); !text) return text;
  const Value row[] = {who, note.at, note.words};
  return database_->run("INSERT INTO note (who, at, words) VALUES ($1, $2, $3)", row);
}

Result<std::vector<Person>> History::people() {
  const auto rows = database_->query(
      "SELECT name, COALESCE(MIN(began), since), COUNT(id) FROM person LEFT JOIN session ON who = "
      "name "
      "GROUP BY name, since ORDER BY name",
      {});
  if (!rows) return tl::unexpected(rows.error());
  std::vector<Person> people;
  for (const Row& row : *rows)
    people.push_back({as_text(row[0]), as_text(row[1]), as_whole(row[2])});
  return people;
}

Result<std::vector<Note>> History::notes_of(const std::string& who) {
  const Value values[] = {who};
  const auto rows =
      database_->query("SELECT at, words FROM note WHERE who = $1 ORDER BY at", values);
  if (!rows) return tl::unexpected(rows.error());
  std::vector<Note> notes;
  for (const Row& row : *rows) notes.push_back({as_text(row[0]), as_text(row[1])});
  return notes;
}

Result<void> History::fill(Visit& visit) {
  const Value id[] = {visit.id};
  const auto points = database_->query(
      "SELECT name, x_m, y_m, z_m, uncertainty_m FROM acupoint WHERE session = $1 ORDER BY name",
      id);
  if (!points) return tl::unexpected(points.error());
  for (const Row& row : *points) {
    Acupoint point;
    point.name = as_text(row[0]);
    point.at_in_couch = Vector3(as_number(row[1]), as_number(row[2]), as_number(row[3]));
    point.uncertainty_m = as_number(row[4]);
    visit.acupoints.push_back(point);
  }
  const auto felt = database_->query(
      "SELECT name, alpha_n, alpha_ci95_n, beta_per_m, beta_ci95_per_m, stiffness_n_per_mm, "
      "stiffness_ci95_n_per_mm, presses, converged FROM tissue WHERE session = $1 ORDER BY number",
      id);
  if (!felt) return tl::unexpected(felt.error());
  for (const Row& row : *felt) {
    visit.tissue.push_back({.name = as_text(row[0]),
                            .alpha_n = as_number(row[1]),
                            .alpha_ci95_n = as_number(row[2]),
                            .beta_per_m = as_number(row[3]),
                            .beta_ci95_per_m = as_number(row[4]),
                            .stiffness_n_per_mm = as_number(row[5]),
                            .stiffness_ci95_n_per_mm = as_number(row[6]),
                            .presses = as_whole(row[7]),
                            .converged = as_whole(row[8]) != 0});
  }
  return {};
}

Result<std::vector<Visit>> History::visits_of(const std::string& who) {
  const Value values[] = {who};
  const auto rows = database_->query(
      "SELECT id, began, folder, ended, position, programme, robot, realism, version, duration_s, "
      "force_rmse_n, force_peak_n, softer, firmer, stops, stop_cause, consent_by, said, intensity "
      "FROM session WHERE who = $1 ORDER BY began, id",
      values);
  if (!rows) return tl::unexpected(rows.error());
  std::vector<Visit> visits;
  for (const Row& row : *rows) {
    visits.push_back({.id = as_text(row[0]),
                      .who = who,
                      .began = as_text(row[1]),
                      .folder = as_text(row[2]),
                      .ended = as_whole(row[3]) != 0,
                      .position = as_text(row[4]),
                      .programme = as_text(row[5]),
                      .robot = as_text(row[6]),
                      .realism = as_text(row[7]),
                      .version = as_text(row[8]),
                      .duration_s = as_number(row[9]),
                      .force_rmse_n = as_number(row[10]),
                      .force_peak_n = as_number(row[11]),
                      .softer = as_whole(row[12]),
                      .firmer = as_whole(row[13]),
                      .stops = as_whole(row[14]),
                      .stop_cause = as_text(row[15]),
                      .consent_by = as_text(row[16]),
                      .said = as_text(row[17]),
                      .intensity = as_number(row[18]),
                      .acupoints = {},
                      .tissue = {}});
    if (const auto filled = fill(visits.back()); !filled) return tl::unexpected(filled.error());
  }
  return visits;
}

Result<Rebuilt> History::rebuild(const fs::path& folder) {
  std::error_code fault;
  fs::recursive_directory_iterator entries(folder, fault);
  if (fault) return fail(Fault::file, "{}: {}", folder.string(), fault.message());
  std::vector<fs::path> found;
  for (; entries != fs::recursive_directory_iterator(); entries.increment(fault)) {
    if (fault) return fail(Fault::file, "{}: {}", folder.string(), fault.message());
    if (entries->path().filename() == "session.json")
      found.push_back(entries->path().parent_path());
  }
  std::ranges::sort(found);
  Rebuilt rebuilt;
  for (const fs::path& one : found) {
    const auto file = read_session_of(one);
    if (!file) {
      rebuilt.left_out.push_back(file.error().message);
      continue;
    }
    if (!file->visit) {
      rebuilt.left_out.push_back(one.string() + ": a session of nobody (without `--who`)");
      continue;
    }
    if (const auto right = check_name(file->visit->who); !right) {
      rebuilt.left_out.push_back(one.string() + ": " + right.error().message);
      continue;
    }
    if (const auto added = add(visit_of(*file, fs::absolute(one).lexically_normal())); !added)
      return tl::unexpected(added.error());
    ++rebuilt.sessions;
  }
  return rebuilt;
}

}  // namespace tuina::history
