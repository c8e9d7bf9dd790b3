// SPDX-License-Identifier: Apache-2.0
#include <libpq-fe.h>

#include <cctype>
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
    texts.reserve(values.size());
    for (const Value& value : values) texts.push_back(text_of(value));
    std::vector<const char*> given;
    given.reserve(texts.size());
    for (const auto& text : texts) given.push_back(text ? text->c_str() : nullptr);
    const std::unique_ptr<PGresult, Clear> result(
        PQexecParams(connection_.get(), sql.c_str(), static_cast<int>(given.size()), nullptr,
                     given.data(), nullptr, nullptr, 0));
    const ExecStatusType state = PQresultStatus(result.get());
    if (state != PGRES_TUPLES_OK && state != PGRES_COMMAND_OK) {
      const bool answers = PQstatus(connection_.get()) == CONNECTION_OK;
      return fail(answers ? Fault::file : Fault::device, "the history's server: {}",
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
  [[nodiscard]] bool has_accounts() const override { return true; }
  Result<void> scrub() override { return run("VACUUM FULL"); }

 private:
  std::unique_ptr<PGconn, Finish> connection_;
};

}  // namespace

Result<std::string> name_of_server(const std::string& address) {
  struct Free {
    void operator()(PQconninfoOption* parts) const { PQconninfoFree(parts); }
  };
  const std::unique_ptr<PQconninfoOption, Free> parts(PQconninfoParse(address.c_str(), nullptr));
  if (!parts) return fail(Fault::usage, "the address of the history's server cannot be read");
  const std::unique_ptr<PQconninfoOption, Free> usual(PQconndefaults());
  // What another port or account would be given is somebody else's.
  const auto value = [&](const std::string& keyword) -> std::string {
    for (const PQconninfoOption* all : {parts.get(), usual.get()}) {
      for (; all != nullptr && all->keyword != nullptr; ++all)
        if (all->keyword == keyword && all->val != nullptr) return all->val;
    }
    return {};
  };
  if (!value("service").empty())
    return fail(
        Fault::usage,
        "the address of the history's server names a service; name host, port, database and "
        "user instead, by which what waits for it is kept");
  std::string name;
  for (const char* keyword : {"host", "hostaddr", "port", "dbname", "user"}) {
    if (const std::string one = value(keyword); !one.empty())
      name += (name.empty() ? "" : "-") + one;
  }
  for (char& letter : name) {
    const bool plain = std::isalnum(static_cast<unsigned char>(letter)) != 0 || letter == '.';
    if (!plain) letter = '-';
  }
  return name;
}

Result<std::unique_ptr<Database>> open_postgres(const std::string& address) {
  // Without these a cable that is pulled keeps a program waiting for minutes. What the address
  // says comes after them, and so goes first.
  const char* names[] = {"connect_timeout", "tcp_user_timeout", "keepalives_idle", "dbname",
                         nullptr};
  const char* values[] = {"5", "10000", "5", address.c_str(), nullptr};
  std::unique_ptr<PGconn, Finish> connection(PQconnectdbParams(names, values, 1));
  if (PQstatus(connection.get()) != CONNECTION_OK) {
    // The address may hold a password, so it is not repeated.
    return fail(Fault::device, "the history's server does not answer: {}",
                first_line(PQerrorMessage(connection.get())));
  }
  auto database = std::make_unique<PostgresDatabase>(std::move(connection));
  // Notices are for whoever runs the server.
  if (const auto set = database->run("SET client_min_messages = error"); !set)
    return tl::unexpected(set.error());
  return database;
}

}  // namespace tuina::history
