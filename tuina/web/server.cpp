// SPDX-License-Identifier: Apache-2.0
#include "tuina/web/server.hpp"

#include <civetweb.h>

#include <array>
#include <map>
#include <mutex>
#include <thread>

namespace tuina::web {
namespace {

constexpr const char* socket_path = "/live";
// The pages, and some for requests besides.
constexpr int threads = max_clients + 16;

std::string header(const mg_connection* connection, const char* name) {
  const char* value = mg_get_header(connection, name);
  return value != nullptr ? value : "";
}

Request request_of(const mg_connection* connection) {
  const mg_request_info* info = mg_get_request_info(connection);
  const auto text = [](const char* value) { return std::string(value != nullptr ? value : ""); };
  return {.method = text(info->request_method),
          .path = text(info->local_uri),
          .query = text(info->query_string),
          .host = header(connection, "Host"),
          .origin = header(connection, "Origin"),
          .cookie = header(connection, "Cookie"),
          .body_bytes = info->content_length,
          .upgrade = !header(connection, "Upgrade").empty()};
}

void send(mg_connection* connection, const Reply& reply) {
  std::string head = fmt::format(
      "HTTP/1.1 {} {}\r\nContent-Type: {}\r\nContent-Length: {}\r\nConnection: close\r\n"
      "Cache-Control: no-store\r\nX-Content-Type-Options: nosniff\r\nReferrer-Policy: "
      "no-referrer\r\n"
      "Cross-Origin-Opener-Policy: same-origin\r\nCross-Origin-Resource-Policy: same-origin\r\n",
      reply.status, mg_get_response_code_text(connection, reply.status), reply.type,
      reply.body.size());
  for (const auto& [name, value] : reply.headers) head += fmt::format("{}: {}\r\n", name, value);
  head += "\r\n";
  mg_write(connection, head.data(), head.size());
  mg_write(connection, reply.body.data(), reply.body.size());
}

}  // namespace

/// One page: what waits for it, and the thread that sends it.
struct Client {
  ClientId id = 0;
  std::shared_ptr<Outbox> outbox = std::make_shared<Outbox>();
  std::thread sender = {};
};

struct Server::Hall {
  explicit Hall(Site the_site) : site(std::move(the_site)) {}
  Site site;
  mg_context* context = nullptr;
  std::mutex mutex;
  std::map<ClientId, std::shared_ptr<Outbox>> outboxes;
  ClientId last = 0;

  [[nodiscard]] bool full() {
    const std::lock_guard lock(mutex);
    return outboxes.size() >= max_clients;
  }
  [[nodiscard]] std::shared_ptr<Outbox> outbox(ClientId client) {
    const std::lock_guard lock(mutex);
    const auto found = outboxes.find(client);
    return found == outboxes.end() ? nullptr : found->second;
  }

  static Hall& of(const mg_connection* connection) {
    return *static_cast<Hall*>(mg_get_user_data(mg_get_context(connection)));
  }

  // The status with which the request was answered, or 0: a WebSocket opens.
  static int on_request(mg_connection* connection) {
    Hall& hall = of(connection);
    const Request request = request_of(connection);
    auto reply = hall.site.answer(request);
    const bool opens = !reply && request.upgrade && request.path == socket_path;
    if (opens && !hall.full()) return 0;
    if (!reply) reply = Reply{.status = opens ? 503 : 404, .body = "\n"};
    send(connection, *reply);
    return reply->status;
  }

  static void on_ready(mg_connection* connection, void* data) {
    Hall& hall = *static_cast<Hall*>(data);
    auto* client = new Client;
    {
      const std::lock_guard lock(hall.mutex);
      client->id = ++hall.last;
      hall.outboxes[client->id] = client->outbox;
    }
    mg_set_user_connection_data(connection, client);
    client->sender = std::thread([connection, outbox = client->outbox] {
      while (const auto text = outbox->take())
        mg_websocket_write(connection, MG_WEBSOCKET_OPCODE_TEXT, text->data(), text->size());
    });
    hall.site.come(client->id);
  }

  static int on_data(mg_connection* connection, int bits, char* text, std::size_t size,
                     void* data) {
    constexpr int keep_open = 1, close = 0;
    Hall& hall = *static_cast<Hall*>(data);
    const auto* client = static_cast<Client*>(mg_get_user_connection_data(connection));
    const int opcode = bits & 0x0f;
    const bool whole = (bits & 0x80) != 0;
    if (opcode == MG_WEBSOCKET_OPCODE_PING || opcode == MG_WEBSOCKET_OPCODE_PONG) return keep_open;
    const bool good = whole && opcode == MG_WEBSOCKET_OPCODE_TEXT && size <= max_message_bytes;
    if (client == nullptr || !good) return close;
    hall.site.hear(client->id, std::string_view(text, size));
    return keep_open;
  }

  static void on_close(const mg_connection* connection, void* data) {
    Hall& hall = *static_cast<Hall*>(data);
    const std::unique_ptr<Client> client(
        static_cast<Client*>(mg_get_user_connection_data(connection)));
    if (!client) return;
    hall.site.go(client->id);
    {
      const std::lock_guard lock(hall.mutex);
      hall.outboxes.erase(client->id);
    }
    client->outbox->close();
    client->sender.join();
  }
};

Server::Server(std::unique_ptr<Hall> hall) : hall_(std::move(hall)) {}

Result<std::unique_ptr<Server>> Server::start(const std::string& address, int port, Site site) {
  auto hall = std::make_unique<Hall>(std::move(site));
  mg_callbacks callbacks{};
  callbacks.begin_request = &Hall::on_request;
  callbacks.log_message = [](const mg_connection*, const char*) { return 1; };  // said by nobody
  const std::string at = fmt::format("{}:{}", address, port);
  const std::string pool = fmt::format("{}", threads);
  const std::array<const char*, 13> options = {"listening_ports",
                                               at.c_str(),
                                               "num_threads",
                                               pool.c_str(),
                                               "request_timeout_ms",
                                               "10000",
                                               "websocket_timeout_ms",
                                               "10000",
                                               "max_request_size",
                                               "8192",
                                               "tcp_nodelay",
                                               "1",
                                               nullptr};
  mg_init_library(MG_FEATURES_WEBSOCKET);
  hall->context = mg_start(&callbacks, hall.get(), const_cast<const char**>(options.data()));
  if (hall->context == nullptr) {
    return fail(Fault::device, "{}: cannot be listened at; is another program there already?", at);
  }
  mg_set_websocket_handler(
      hall->context, socket_path, [](const mg_connection*, void*) { return 0; }, &Hall::on_ready,
      &Hall::on_data, &Hall::on_close, hall.get());
  return std::unique_ptr<Server>(new Server(std::move(hall)));
}

Server::~Server() {
  mg_stop(hall_->context);
  mg_exit_library();
}

int Server::port() const noexcept {
  mg_server_port port{};
  return mg_get_server_ports(hall_->context, 1, &port) == 1 ? port.port : 0;
}

void Server::put(ClientId client, Channel channel, std::string text) {
  if (const auto outbox = hall_->outbox(client)) outbox->put(channel, std::move(text));
}

void Server::reply(ClientId client, std::string text) {
  const auto outbox = hall_->outbox(client);
  if (outbox && !outbox->reply(std::move(text))) outbox->close();
}

}  // namespace tuina::web
