// SPDX-License-Identifier: Apache-2.0
#include "tuina/history/database.hpp"

#include <utility>

namespace tuina::history {

Result<void> Database::run(const std::string& sql, std::span<const Value> values) {
  if (const auto done = query(sql, values); !done) return tl::unexpected(done.error());
  return {};
}

Result<std::unique_ptr<Database>> open_database(const std::string& address) {
  const bool server = address.starts_with("postgresql://") || address.starts_with("postgres://");
  return server ? open_postgres(address) : open_sqlite(address);
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
