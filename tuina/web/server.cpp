// SPDX-License-Identifier: Apache-2.0
#include "tuina/web/server.hpp"

#include <civetweb.h>

#include <algorithm>
#include <array>
#include <map>
#include <mutex>
#include <set>
#include <thread>

#include "tuina/web/door.hpp"
#include "tuina/web/exchange.hpp"
#include "tuina/web/foxglove.hpp"
#include "tuina/web/frame_gate.hpp"

namespace tuina::web {
namespace {

// The clients, and some for requests besides.
constexpr int threads = max_clients + 16;

int opcode_of(Frame::Kind kind) {
  constexpr std::array<int, 4> opcodes = {MG_WEBSOCKET_OPCODE_TEXT, MG_WEBSOCKET_OPCODE_BINARY,
                                          MG_WEBSOCKET_OPCODE_PING, MG_WEBSOCKET_OPCODE_PONG};
  return opcodes[static_cast<std::size_t>(kind)];
}

std::optional<Frame::Kind> kind_of(int opcode) {
  for (const auto kind :
       {Frame::Kind::text, Frame::Kind::binary, Frame::Kind::ping, Frame::Kind::pong})
    if (opcode_of(kind) == opcode) return kind;
  return std::nullopt;
}

}  // namespace

/// What waits for one client, and the thread that sends it.
struct Client {
  ClientId id = 0;
  bool is_page = true;  ///< else another program
  std::shared_ptr<Outbox> outbox = std::make_shared<Outbox>();
  std::thread sender = {};
};

struct Server::Hall {
  Hall(Site the_site, bool tls) : site(std::move(the_site)), by_tls(tls) {}
  Site site;
  bool by_tls;
  mg_context* context = nullptr;
  std::mutex mutex;
  std::map<ClientId, std::shared_ptr<Outbox>> outboxes;
  std::set<ClientId> dismissed;
  ClientId last = 0;
  std::unique_ptr<Door> door = nullptr;

  [[nodiscard]] bool full() {
    const std::lock_guard lock(mutex);
    return outboxes.size() >= max_clients;
  }
  [[nodiscard]] std::shared_ptr<Outbox> outbox(ClientId client) {
    const std::lock_guard lock(mutex);
    const auto found = outboxes.find(client);
    return found == outboxes.end() ? nullptr : found->second;
  }

  [[nodiscard]] bool is_dismissed(ClientId client) {
    const std::lock_guard lock(mutex);
    return dismissed.contains(client);
  }

  static Hall& of(const mg_connection* connection) {
    return *static_cast<Hall*>(mg_get_user_data(mg_get_context(connection)));
  }

  // The machine that asks, not told where it is this one; nothing: it has gone around the door.
  [[nodiscard]] std::optional<std::string> caller(const mg_connection* connection) {
    const std::lock_guard lock(mutex);
    auto from = door ? door->caller(mg_get_request_info(connection)->remote_port) : std::nullopt;
    if (from && !by_tls) from->clear();
    return from;
  }

  // The status with which the request was answered, or 0: a WebSocket opens.
  static int on_request(mg_connection* connection) {
    Hall& hall = of(connection);
    const auto from = hall.caller(connection);
    if (!from) {
      send(connection, {.status = 403, .body = "\n"}, false);
      return 403;
    }
    Request request = read_request(connection);
    request.from = *from;
    auto reply = hall.site.answer(request);
    const bool is_socket = request.path == page_path || request.path == foxglove::path;
    const bool opens = !reply && request.upgrade && is_socket;
    if (opens && !hall.full()) return 0;
    if (!reply) reply = Reply{.status = opens ? 503 : 404, .body = "\n"};
    send(connection, *reply, hall.by_tls);
    return reply->status;
  }

  static void on_ready(mg_connection* connection, void* data) {
    Hall& hall = *static_cast<Hall*>(data);
    Request request = read_request(connection);
    request.from = hall.caller(connection).value_or("");
    auto* client = new Client{.is_page = request.path == page_path};
    {
      const std::lock_guard lock(hall.mutex);
      client->id = ++hall.last;
      hall.outboxes[client->id] = client->outbox;
    }
    mg_set_user_connection_data(connection, client);
    client->sender = std::thread([connection, outbox = client->outbox] {
      while (const auto frame = outbox->take())
        mg_websocket_write(connection, opcode_of(frame->kind), frame->bytes.data(),
                           frame->bytes.size());
    });
    hall.site.come(client->id, request);
  }

  static int on_data(mg_connection* connection, int bits, char* text, std::size_t size,
                     void* data) {
    constexpr int keep_open = 1, close = 0;
    Hall& hall = *static_cast<Hall*>(data);
    auto* client = static_cast<Client*>(mg_get_user_connection_data(connection));
    if (client == nullptr || hall.is_dismissed(client->id)) return close;
    if ((bits & 0x0f) == MG_WEBSOCKET_OPCODE_CONNECTION_CLOSE) {
      hall.see_off(connection, *client, {text, size});
      return close;
    }
    const auto kind = kind_of(bits & 0x0f);
    if (!kind) return close;
    if (*kind == Frame::Kind::ping || (*kind == Frame::Kind::pong && client->is_page))
      return keep_open;
    const bool whole = (bits & 0x80) != 0;
    const bool read = *kind != Frame::Kind::binary || !client->is_page;
    if (!whole || !read) return close;
    const auto& hear = client->is_page ? hall.site.hear : hall.site.hear_program;
    hear(client->id, {.kind = *kind, .bytes = std::string(text, size)});
    return keep_open;
  }

  // Who takes leave is answered with the same reason, after which nothing is sent.
  void see_off(mg_connection* connection, Client& client, std::string_view reason) {
    client.outbox->close();
    client.sender.join();
    const bool said_too_much = reason.size() >= 2 && reason[0] == char(message_too_big >> 8U) &&
                               reason[1] == char(message_too_big & 0xffU);
    if (said_too_much) site.say_too_much(client.id);
    constexpr std::size_t max_bytes = 125;
    mg_websocket_write(connection, MG_WEBSOCKET_OPCODE_CONNECTION_CLOSE, reason.data(),
                       std::min(reason.size(), max_bytes));
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
      hall.dismissed.erase(client->id);
    }
    client->outbox->close();
    if (client->sender.joinable()) client->sender.join();
  }
};

Server::Server(std::unique_ptr<Hall> hall) : hall_(std::move(hall)) {}

Result<std::unique_ptr<Server>> Server::start(const Place& place, Site site) {
  const bool by_tls = place.certificate.has_value();
  auto hall = std::make_unique<Hall>(std::move(site), by_tls);
  mg_callbacks callbacks{};
  callbacks.begin_request = &Hall::on_request;
  callbacks.log_message = [](const mg_connection*, const char*) { return 1; };  // said by nobody
  const std::string pool = fmt::format("{}", threads);
  const std::array<const char*, 13> options = {"listening_ports",
                                               "127.0.0.1:0",
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
    return fail(Fault::device, "127.0.0.1: this machine gives no port to listen at");
  }
  const auto come_in = [](const mg_connection*, void*) { return 0; };
  mg_set_websocket_handler(hall->context, page_path, come_in, &Hall::on_ready, &Hall::on_data,
                           &Hall::on_close, hall.get());
  // The library keeps the address of the list.
  static auto names = foxglove::subprotocols;
  static mg_websocket_subprotocols offered{.nb_subprotocols = static_cast<int>(names.size()),
                                           .subprotocols = names.data()};
  mg_set_websocket_handler_with_subprotocols(hall->context, foxglove::path, &offered, come_in,
                                             &Hall::on_ready, &Hall::on_data, &Hall::on_close,
                                             hall.get());
  std::unique_ptr<Server> server(new Server(std::move(hall)));
  mg_server_port inner{};
  mg_get_server_ports(server->hall_->context, 1, &inner);
  auto door = Door::open(place.address, place.port, place.certificate, inner.port);
  if (!door) return tl::unexpected(door.error());
  const std::lock_guard lock(server->hall_->mutex);
  server->hall_->door = std::move(*door);
  return server;
}

Server::~Server() {
  mg_stop(hall_->context);
  mg_exit_library();
}

int Server::port() const noexcept {
  return hall_->door->port();
}

void Server::put(ClientId client, Outbox::Slot slot, Frame frame, std::size_t keep) {
  if (const auto outbox = hall_->outbox(client)) outbox->put(slot, std::move(frame), keep);
}

void Server::drop(ClientId client, Outbox::Slot slot) {
  if (const auto outbox = hall_->outbox(client)) outbox->drop(slot);
}

void Server::dismiss(ClientId client) {
  const auto outbox = hall_->outbox(client);
  if (!outbox) return;
  outbox->close();
  const std::lock_guard lock(hall_->mutex);
  if (hall_->outboxes.contains(client)) hall_->dismissed.insert(client);
}

void Server::reply(ClientId client, Frame frame) {
  const auto outbox = hall_->outbox(client);
  if (outbox && !outbox->reply(std::move(frame))) outbox->close();
}

}  // namespace tuina::web
