// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "tuina/core/result.hpp"
#include "tuina/web/ask.hpp"
#include "tuina/web/outbox.hpp"

/// The WebSocket protocol of Foxglove [foxglove-ws], by which Foxglove, Lichtblick and programs of
/// others look at a running session. Both of its names are the same protocol. Channels that a
/// client would publish, parameters, assets and the connection graph are not offered.
namespace tuina::web::foxglove {

inline constexpr const char* path = "/foxglove";
/// The first of these that a client names is taken.
inline constexpr std::array<const char*, 2> subprotocols = {"foxglove.sdk.v1",
                                                            "foxglove.websocket.v1"};
/// Whether the header Sec-WebSocket-Protocol names one of them.
[[nodiscard]] bool offers(std::string_view header);

/// A stream of messages that clients may subscribe to.
struct Channel {
  std::uint32_t id = 0;
  std::string topic;
  std::string encoding;  ///< "cdr" or "json"
  std::string schema_name, schema_encoding, schema;
};
/// What may be asked for by a service `/tuina/<ask>`. A request is an empty JSON object; the
/// response has the key `outcome`, which is "done".
inline constexpr std::array<Ask, 9> services = {Ask::stop,   Ask::operate, Ask::hand_over,
                                                Ask::pause,  Ask::resume,  Ask::softer,
                                                Ask::firmer, Ask::skip,    Ask::repeat};

/// Asks for messages of channels.
struct Subscribe {
  /// One channel, by numbers.
  struct One {
    std::uint32_t subscription = 0;  ///< a number that the client chose
    std::uint32_t channel = 0;
  };
  std::vector<One> all;
};
/// Asks for no more messages.
struct Unsubscribe {
  std::vector<std::uint32_t> subscriptions;
};
/// Asks a service to do something.
struct ServiceCall {
  std::uint32_t service = 0;
  std::uint32_t call = 0;  ///< a number that the client chose
  std::string encoding;
  std::string request;
};
/// What a client may say.
using ClientMessage = std::variant<Subscribe, Unsubscribe, ServiceCall>;

/// Reads a frame, text or binary, of a client. Whatever else is refused.
[[nodiscard]] Result<ClientMessage> parse(const Frame& frame);
/// What a call asks for. Refused: a service that is none, or a request that is no empty object.
[[nodiscard]] Result<Ask> ask_of(const ServiceCall& call);

/// The first frame of a connection. `session` is another for every run of the server.
[[nodiscard]] Frame server_info(std::string_view session);
/// @{
/// Names the channels, and the services, with their schemas.
[[nodiscard]] Frame advertise(std::span<const Channel> channels);
[[nodiscard]] Frame advertise_services();
/// @}
/// Why a message of the client was not followed.
[[nodiscard]] Frame status(std::string_view why);
/// Times are nanoseconds of the session.
[[nodiscard]] Frame message_data(std::uint32_t subscription, std::uint64_t time_ns,
                                 std::string_view message);
/// The time of the session, for who has no other clock.
[[nodiscard]] Frame time(std::uint64_t time_ns);
/// @{
/// The answer to a call: it was done, or why not.
[[nodiscard]] Frame service_done(const ServiceCall& call);
[[nodiscard]] Frame service_failed(const ServiceCall& call, std::string_view why);
/// @}

}  // namespace tuina::web::foxglove
