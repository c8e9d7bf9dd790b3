// SPDX-License-Identifier: Apache-2.0
#include "tuina/web/exchange.hpp"

#include <civetweb.h>
#include <fmt/format.h>

#include <algorithm>

namespace tuina::web {
namespace {

std::string header(const mg_connection* connection, const char* name) {
  const char* value = mg_get_header(connection, name);
  return value != nullptr ? value : "";
}

Request read_head(const mg_connection* connection) {
  const mg_request_info* info = mg_get_request_info(connection);
  const auto text = [](const char* value) { return std::string(value != nullptr ? value : ""); };
  return {.method = text(info->request_method),
          .path = text(info->local_uri),
          .query = text(info->query_string),
          .host = header(connection, "Host"),
          .origin = header(connection, "Origin"),
          .cookie = header(connection, "Cookie"),
          .body_bytes = info->content_length,
          .upgrade = !header(connection, "Upgrade").empty(),
          .subprotocols = header(connection, "Sec-WebSocket-Protocol"),
          .encodings = header(connection, "Accept-Encoding"),
          .fetch_site = header(connection, "Sec-Fetch-Site"),
          .known_tags = header(connection, "If-None-Match")};
}

// A form, as far as it has come when the server's patience ends.
std::string body_of(mg_connection* connection, std::int64_t announced) {
  std::string body(static_cast<std::size_t>(std::clamp<std::int64_t>(announced, 0, max_form_bytes)),
                   '\0');
  std::size_t read = 0;
  while (read < body.size()) {
    const int got = mg_read(connection, body.data() + read, body.size() - read);
    if (got <= 0) break;
    read += static_cast<std::size_t>(got);
  }
  body.resize(read);
  return body;
}

}  // namespace

Request read_request(mg_connection* connection) {
  Request request = read_head(connection);
  if (request.method == "POST" && request.body_bytes <= max_form_bytes)
    request.body = body_of(connection, request.body_bytes);
  return request;
}

// A page that named itself nowhere would post its form with the origin `null`.
void send(mg_connection* connection, const Reply& reply, bool by_tls) {
  std::string head = fmt::format(
      "HTTP/1.1 {} {}\r\nConnection: close\r\nCache-Control: {}\r\n"
      "X-Content-Type-Options: nosniff\r\nReferrer-Policy: same-origin\r\n"
      "Cross-Origin-Opener-Policy: same-origin\r\nCross-Origin-Resource-Policy: same-origin\r\n",
      reply.status, mg_get_response_code_text(connection, reply.status), reply.cache);
  constexpr int not_modified = 304;  // has no content
  if (reply.status != not_modified)
    head +=
        fmt::format("Content-Type: {}\r\nContent-Length: {}\r\n", reply.type, reply.body.size());
  if (by_tls) head += "Strict-Transport-Security: max-age=31536000\r\n";
  for (const auto& [name, value] : reply.headers) head += fmt::format("{}: {}\r\n", name, value);
  head += "\r\n";
  mg_write(connection, head.data(), head.size());
  mg_write(connection, reply.body.data(), reply.body.size());
}

}  // namespace tuina::web
