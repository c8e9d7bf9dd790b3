// SPDX-License-Identifier: Apache-2.0
#include <libpq-fe.h>

#include <charconv>
#include <cmath>
#include <optional>

#include "tuina/history/database.hpp"

namespace tuina::history {
namespace {

// Numbers by which the server's wire protocol names types: catalogue pg_type.
constexpr Oid type_int8 = 20, type_int4 = 23, type_float8 = 701;

struct Finish {
  void operator()(PGconn* connection) const { PQfinish(connection); }
};
struct Clear {
  void operator()(PGresult* result) const { PQclear(result); }
};

/// The first line of what the server or the library says.
std::string first_line(const char* words) {
  const std::string all(words);
  return all.substr(0, all.find('\n'));
}

std::optional<std::string> text_of(const Value& value) {
  if (const auto* whole = std::get_if<std::int64_t>(&value)) return fmt::format("{}", *whole);
  if (const auto* number = std::get_if<double>(&value))
    return std::isfinite(*number) ? std::optional(fmt::format("{}", *number)) : std::nullopt;
  if (const auto* text = std::get_if<std::string>(&value)) return *text;
  return std::nullopt;
}

Value value_of(const PGresult* result, int row, int column) {
  if (PQgetisnull(result, row, column) == 1) return {};
  const char* text = PQgetvalue(result, row, column);
  const char* end = text + PQgetlength(result, row, column);
  const Oid type = PQftype(result, column);
  if (type == type_int8 || type == type_int4) {
    std::int64_t whole = 0;
    std::from_chars(text, end, whole);
    return whole;
  }
  if (type == type_float8) {
    double number = 0.0;
    std::from_chars(text, end, number);
    return number;
  }
  return std::string(text, end);
}

class PostgresDatabase final : public Database {
 public:
  explicit PostgresDatabase(std::unique_ptr<PGconn, Finish> connection)
      : connection_(std::move(connection)) {}

  Result<std::vector<Row>> query(const std::string& sql, std::span<const Value> values) override {
    std::vector<std::optional<std::string>> texts;
    for (const Value& value : values) texts.push_back(text_of(value));
    std::vector<const char*> given;
    for (const auto& text : texts) given.push_back(text ? text->c_str() : nullptr);
    const std::unique_ptr<PGresult, Clear> result(
        PQexecParams(connection_.get(), sql.c_str(), static_cast<int>(given.size()), nullptr,
                     given.data(), nullptr, nullptr, 0));
    const ExecStatusType state = PQresultStatus(result.get());
    if (state != PGRES_TUPLES_OK && state != PGRES_COMMAND_OK) {
      return fail(Fault::file, "the history's server: {}",
                  first_line(PQerrorMessage(connection_.get())));
    }
    std::vector<Row> rows(static_cast<std::size_t>(PQntuples(result.get())));
    for (std::size_t i = 0; i < rows.size(); ++i) {
      for (int k = 0; k < PQnfields(result.get()); ++k)
        rows[i].push_back(value_of(result.get(), static_cast<int>(i), k));
    }
    return rows;
  }
  [[nodiscard]] const char* begin() const override { return "BEGIN"; }
  Result<void> scrub() override { return run("VACUUM FULL"); }

 private:
  std::unique_ptr<PGconn, Finish> connection_;
};

}  // namespace

Result<std::unique_ptr<Database>> open_postgres(const std::string& address) {
  std::unique_ptr<PGconn, Finish> connection(PQconnectdb(address.c_str()));
  if (PQstatus(connection.get()) != CONNECTION_OK) {
    // The address may hold a password, so it is not repeated.
    return fail(Fault::file, "the history's server does not answer: {}",
                first_line(PQerrorMessage(connection.get())));
  }
  auto database = std::make_unique<PostgresDatabase>(std::move(connection));
  // Notices are for whoever runs the server.
  if (const auto set = database->run("SET client_min_messages = warning"); !set)
    return tl::unexpected(set.error());
  return database;
}

}  // namespace tuina::history
