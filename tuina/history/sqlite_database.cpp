// SPDX-License-Identifier: Apache-2.0
#include <sqlite3.h>

#include <cmath>
#include <cstring>
#include <filesystem>

#include "tuina/history/database.hpp"

namespace tuina::history {
namespace {

struct Close {
  void operator()(sqlite3* connection) const { sqlite3_close(connection); }
};
struct Finalize {
  void operator()(sqlite3_stmt* statement) const { sqlite3_finalize(statement); }
};
using Statement = std::unique_ptr<sqlite3_stmt, Finalize>;

class SqliteDatabase final : public Database {
 public:
  SqliteDatabase(std::unique_ptr<sqlite3, Close> connection, std::string path)
      : connection_(std::move(connection)), path_(std::move(path)) {}

  Result<std::vector<Row>> query(const std::string& sql, std::span<const Value> values) override {
    sqlite3_stmt* prepared = nullptr;
    const int length = static_cast<int>(sql.size());
    if (sqlite3_prepare_v2(connection_.get(), sql.c_str(), length, &prepared, nullptr) != SQLITE_OK)
      return refused();
    const Statement statement(prepared);
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (bind(prepared, static_cast<int>(i) + 1, values[i]) != SQLITE_OK) return refused();
    }
    std::vector<Row> rows;
    int state = sqlite3_step(prepared);
    for (; state == SQLITE_ROW; state = sqlite3_step(prepared)) rows.push_back(row_of(prepared));
    if (state != SQLITE_DONE) return refused();
    return rows;
  }
  // Two that read first and write then would wait for each other.
  [[nodiscard]] const char* begin() const override { return "BEGIN IMMEDIATE"; }
  [[nodiscard]] bool has_accounts() const override { return false; }
  Result<void> scrub() override {
    if (auto done = run("VACUUM"); !done) return done;
    const auto busy = query("PRAGMA wal_checkpoint(TRUNCATE)", {});
    if (!busy) return tl::unexpected(busy.error());
    if (!busy->empty() && as_whole(busy->front().front()) != 0)
      return fail(
          Fault::file,
          "{}: is forgotten, but another program reads the file, in which deleted bytes stay "
          "until it ends and somebody is forgotten again",
          path_);
    return {};
  }

 private:
  [[nodiscard]] tl::unexpected<Error> refused() const {
    const bool broken = (sqlite3_errcode(connection_.get()) & 0xFF) == SQLITE_CORRUPT;
    return fail(Fault::file, "{}: {}{}", path_, sqlite3_errmsg(connection_.get()),
                broken ? "; `tuina history rebuild FOLDER --history NEW.sqlite` makes another one "
                         "of the folders of sessions"
                       : "");
  }
  static int bind(sqlite3_stmt* statement, int place, const Value& value) {
    if (const auto* whole = std::get_if<std::int64_t>(&value))
      return sqlite3_bind_int64(statement, place, *whole);
    if (const auto* number = std::get_if<double>(&value))
      return std::isfinite(*number) ? sqlite3_bind_double(statement, place, *number)
                                    : sqlite3_bind_null(statement, place);
    if (const auto* text = std::get_if<std::string>(&value))
      return sqlite3_bind_text(statement, place, text->c_str(), static_cast<int>(text->size()),
                               SQLITE_TRANSIENT);
    return sqlite3_bind_null(statement, place);
  }
  static Row row_of(sqlite3_stmt* statement) {
    Row row;
    for (int i = 0; i < sqlite3_column_count(statement); ++i) {
      switch (sqlite3_column_type(statement, i)) {
        case SQLITE_INTEGER:
          row.emplace_back(static_cast<std::int64_t>(sqlite3_column_int64(statement, i)));
          break;
        case SQLITE_FLOAT:
          row.emplace_back(sqlite3_column_double(statement, i));
          break;
        case SQLITE_NULL:
          row.emplace_back();
          break;
        default: {
          const auto* text = reinterpret_cast<const char*>(sqlite3_column_text(statement, i));
          const int bytes = sqlite3_column_bytes(statement, i);
          row.emplace_back(std::string(text, static_cast<std::size_t>(bytes)));
        }
      }
    }
    return row;
  }

  std::unique_ptr<sqlite3, Close> connection_;
  std::string path_;
};

/// As a file that nobody changes. Who may not write could not lay beside it what SQLite needs for
/// readers and writers at once.
int open_unchanging(const std::string& path, std::unique_ptr<sqlite3, Close>& connection) {
  std::string address = "file:";
  for (const char letter : std::filesystem::absolute(path).string()) {
    if (letter == '%' || letter == '?' || letter == '#') {
      address += fmt::format("%{:02X}", static_cast<unsigned char>(letter));
    } else {
      address += letter;
    }
  }
  sqlite3* opened = nullptr;
  const int state = sqlite3_open_v2((address + "?immutable=1").c_str(), &opened,
                                    SQLITE_OPEN_READONLY | SQLITE_OPEN_URI, nullptr);
  connection.reset(opened);
  return state;
}

/// Who may not write may read: SQLite opens it so by itself. While somebody writes, their log lies
/// beside it, and it is read as it changes.
int open_file(const std::string& path, std::unique_ptr<sqlite3, Close>& connection) {
  sqlite3* opened = nullptr;
  const int state =
      sqlite3_open_v2(path.c_str(), &opened, SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE, nullptr);
  connection.reset(opened);
  std::error_code ignored;
  const bool still = state == SQLITE_OK && sqlite3_db_readonly(opened, "main") == 1 &&
                     !std::filesystem::exists(path + "-wal", ignored);
  return still ? open_unchanging(path, connection) : state;
}

}  // namespace

Result<std::unique_ptr<Database>> open_sqlite(const std::string& path) {
  std::error_code ignored;
  const bool made = !std::filesystem::exists(path, ignored);
  std::unique_ptr<sqlite3, Close> connection;
  const int state = open_file(path, connection);
  if (state != SQLITE_OK) {
    return fail(Fault::file,
                "{}: {}; it is to be a file that can be written, in a folder that "
                "is there",
                path, sqlite3_errstr(state));
  }
  // It tells of people. The files that SQLite lays beside it are readable by whom it is.
  if (made) {
    namespace fs = std::filesystem;
    fs::permissions(path, fs::perms::owner_read | fs::perms::owner_write, ignored);
  }
  auto database = std::make_unique<SqliteDatabase>(std::move(connection), path);
  const auto tables = database->query(
      "SELECT COUNT(*), COALESCE(SUM(name = 'migration'), 0) FROM sqlite_master", {});
  if (!tables) return tl::unexpected(tables.error());
  if (as_whole(tables->front()[0]) > 0 && as_whole(tables->front()[1]) == 0)
    return fail(Fault::bad_input, "{}: is a database of another program, and no history", path);
  // With FULL an acknowledged row is on the disk; deleted rows are overwritten at once.
  for (const char* setting :
       {"PRAGMA busy_timeout = 5000", "PRAGMA journal_mode = WAL", "PRAGMA synchronous = FULL",
        "PRAGMA foreign_keys = ON", "PRAGMA secure_delete = ON"}) {
    if (const auto set = database->run(setting); !set) return tl::unexpected(set.error());
  }
  return database;
}

}  // namespace tuina::history
