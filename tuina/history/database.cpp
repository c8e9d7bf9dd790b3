// SPDX-License-Identifier: Apache-2.0
#include "tuina/history/database.hpp"

#include <limits>
#include <utility>

namespace tuina::history {

std::string as_text(const Value& value) {
  const auto* held = std::get_if<std::string>(&value);
  return held ? *held : std::string();
}

std::int64_t as_whole(const Value& value) {
  const auto* held = std::get_if<std::int64_t>(&value);
  return held ? *held : 0;
}

double as_number(const Value& value) {
  if (const auto* held = std::get_if<double>(&value)) return *held;
  const auto* held = std::get_if<std::int64_t>(&value);
  return held ? static_cast<double>(*held) : std::numeric_limits<double>::quiet_NaN();
}

Result<void> Database::run(const std::string& sql, std::span<const Value> values) {
  if (const auto done = query(sql, values); !done) return tl::unexpected(done.error());
  return {};
}

bool is_server(const std::string& address) {
  return address.starts_with("postgresql://") || address.starts_with("postgres://");
}

Result<std::unique_ptr<Database>> open_database(const std::string& address) {
  return is_server(address) ? open_postgres(address) : open_sqlite(address);
}

Result<Transaction> Transaction::begin(Database& database) {
  if (const auto begun = database.run(database.begin()); !begun)
    return tl::unexpected(begun.error());
  return Transaction(database);
}

Transaction::Transaction(Transaction&& other) noexcept
    : database_(std::exchange(other.database_, nullptr)) {}

Transaction::~Transaction() {
  // A connection that is gone has rolled back by itself.
  if (database_ != nullptr) static_cast<void>(database_->run("ROLLBACK"));
}

Result<void> Transaction::commit() {
  auto committed = database_->run("COMMIT");
  if (committed) database_ = nullptr;
  return committed;
}

}  // namespace tuina::history
