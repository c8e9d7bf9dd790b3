// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "tuina/core/result.hpp"

namespace tuina::history {

/// What one field of a table holds; nothing is NULL. A number that is not finite is stored as NULL.
using Value = std::variant<std::monostate, std::int64_t, double, std::string>;
using Row = std::vector<Value>;  ///< in the order of its columns

/// @{
/// What a value holds; of another kind: nothing, zero, and no number.
[[nodiscard]] std::string as_text(const Value& value);
[[nodiscard]] std::int64_t as_whole(const Value& value);
[[nodiscard]] double as_number(const Value& value);
/// @}

/// One connection to a database that speaks SQL: SQLite in a file, or a PostgreSQL server. Not for
/// two threads at once. A statement that fails is a `Fault::file` with the database's own words; a
/// server that does not answer, or not any more, a `Fault::device`.
class Database {
 public:
  virtual ~Database() = default;

  /// Carries out one statement; `values` stand for its `$1`, `$2`, ..., each used once, in order.
  [[nodiscard]] virtual Result<std::vector<Row>> query(const std::string& sql,
                                                       std::span<const Value> values) = 0;
  /// Statement that begins a transaction which may write.
  [[nodiscard]] virtual const char* begin() const = 0;
  /// Whether each who comes has an account with rights of its own.
  [[nodiscard]] virtual bool has_accounts() const = 0;
  /// Overwrites on the disk what deleted rows have left there.
  [[nodiscard]] virtual Result<void> scrub() = 0;

  /// Runs a statement and drops its rows. Fails as `query` does.
  [[nodiscard]] Result<void> run(const std::string& sql, std::span<const Value> values = {});
};

/// `postgresql://...` or `postgres://...` is a server, anything else a SQLite file, which is made
/// if it is not there. Refused: a file that is no database.
[[nodiscard]] Result<std::unique_ptr<Database>> open_database(const std::string& address);

/// Whether an address is that of a server, which may be away.
[[nodiscard]] bool is_server(const std::string& address);
/// Host and database of a server's address, as a part of a file's name: no account, no password.
[[nodiscard]] Result<std::string> name_of_server(const std::string& address);

/// What is done until `commit` is done as a whole or, without it, not at all.
class Transaction {
 public:
  /// Begins one. Fails as the database does.
  [[nodiscard]] static Result<Transaction> begin(Database& database);
  Transaction(Transaction&& other) noexcept;
  Transaction(const Transaction&) = delete;
  Transaction& operator=(const Transaction&) = delete;
  Transaction& operator=(Transaction&&) = delete;
  ~Transaction();

  /// Makes it lasting. Fails as the database does.
  [[nodiscard]] Result<void> commit();

 private:
  explicit Transaction(Database& database) : database_(&database) {}

  Database* database_;  // nothing once it is committed
};

/// @{
/// The two kinds; `open_database` chooses.
[[nodiscard]] Result<std::unique_ptr<Database>> open_sqlite(const std::string& path);
[[nodiscard]] Result<std::unique_ptr<Database>> open_postgres(const std::string& address);
/// @}

}  // namespace tuina::history
