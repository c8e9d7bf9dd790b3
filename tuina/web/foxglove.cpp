// SPDX-License-Identifier: Apache-2.0
#include "tuina/web/foxglove.hpp"

#include <algorithm>
#include <bit>
#include <concepts>
#include <cstring>
#include <nlohmann/json.hpp>
#include <optional>

namespace tuina::web::foxglove {
namespace {

using nlohmann::json;

static_assert(std::endian::native == std::endian::little);

// First bytes of binary frames.
constexpr char message_data_op = 1, time_op = 2, service_response_op = 3;  // of the server
constexpr char service_request_op = 2;                                     // of a client
constexpr int error_level = 2;
// Topics are some twenty, and a client subscribes to each once.
constexpr std::size_t max_subscriptions = 256;

template <std::unsigned_integral T>
void append(std::string& out, T number) {
  out.append(reinterpret_cast<const char*>(&number), sizeof number);
}

/// Takes a number from the front; nothing where it does not fit.
std::optional<std::uint32_t> take_number(std::string_view& bytes) {
  std::uint32_t number = 0;
  if (bytes.size() < sizeof number) return std::nullopt;
  std::memcpy(&number, bytes.data(), sizeof number);
  bytes.remove_prefix(sizeof number);
  return number;
}

Frame text_frame(const json& object) {
  return {.bytes = object.dump(-1, ' ', true, json::error_handler_t::replace)};
}

bool is_number(const json& value) {
  return value.is_number_unsigned() && value.get<std::uint64_t>() <= 0xffff'ffffU;
}

Result<ClientMessage> parse_call(std::string_view bytes) {
  if (!bytes.starts_with(service_request_op))
    return fail(Fault::bad_input, "a binary message that calls no service");
  bytes.remove_prefix(1);
  const auto service = take_number(bytes), call = take_number(bytes), length = take_number(bytes);
  if (!length || *length > bytes.size())
    return fail(Fault::bad_input, "a call of a service that is cut off");
  return ServiceCall{.service = *service,
                     .call = *call,
                     .encoding = std::string(bytes.substr(0, *length)),
                     .request = std::string(bytes.substr(*length))};
}

/// The array of an object, of bounded length.
Result<json> list_of(const json& object, const char* key) {
  const auto found = object.find(key);
  if (found == object.end() || !found->is_array() || found->size() > max_subscriptions)
    return fail(Fault::bad_input, "{}: is no list of {} at most", key, max_subscriptions);
  return *found;
}

Result<ClientMessage> parse_subscribe(const json& object) {
  const auto list = list_of(object, "subscriptions");
  if (!list) return tl::unexpected(list.error());
  Subscribe wanted;
  for (const json& one : *list) {
    const bool whole = one.is_object() && one.contains("id") && one.contains("channelId") &&
                       is_number(one["id"]) && is_number(one["channelId"]);
    if (!whole)
      return fail(Fault::bad_input, "subscriptions: one without the numbers id and channelId");
    wanted.all.push_back({.subscription = one["id"].get<std::uint32_t>(),
                          .channel = one["channelId"].get<std::uint32_t>()});
  }
  return wanted;
}

Result<ClientMessage> parse_unsubscribe(const json& object) {
  const auto list = list_of(object, "subscriptionIds");
  if (!list) return tl::unexpected(list.error());
  Unsubscribe wanted;
  for (const json& one : *list) {
    if (!is_number(one)) return fail(Fault::bad_input, "subscriptionIds: one that is no number");
    wanted.subscriptions.push_back(one.get<std::uint32_t>());
  }
  return wanted;
}

}  // namespace

bool offers(std::string_view header) {
  while (!header.empty()) {
    const std::size_t end = std::min(header.find(','), header.size());
    std::string_view one = header.substr(0, end);
    while (one.starts_with(' ')) one.remove_prefix(1);
    while (one.ends_with(' ')) one.remove_suffix(1);
    if (std::find(subprotocols.begin(), subprotocols.end(), one) != subprotocols.end()) return true;
    header.remove_prefix(std::min(end + 1, header.size()));
  }
  return false;
}

Result<ClientMessage> parse(const Frame& frame) {
  if (frame.kind == Frame::Kind::binary) return parse_call(frame.bytes);
  const json object = json::parse(frame.bytes, nullptr, false);
  if (!object.is_object()) return fail(Fault::bad_input, "a message that is not a JSON object");
  const auto op = object.find("op");
  if (op != object.end() && *op == "subscribe") return parse_subscribe(object);
  if (op != object.end() && *op == "unsubscribe") return parse_unsubscribe(object);
  return fail(Fault::bad_input, "op: is not one of subscribe, unsubscribe");
}

Result<Ask> ask_of(const ServiceCall& call) {
  if (call.service == 0 || call.service > services.size())
    return fail(Fault::bad_input, "there is no service {}", call.service);
  const json request = json::parse(call.request, nullptr, false);
  if (call.encoding != "json" || !request.is_object() || !request.empty())
    return fail(Fault::bad_input, "the request is no empty JSON object");
  return services[call.service - 1];
}

Frame server_info(std::string_view session) {
  return text_frame({{"op", "serverInfo"},
                     {"name", "tuina"},
                     {"capabilities", json::array({"services", "time"})},
                     {"supportedEncodings", json::array({"json"})},
                     {"metadata", json::object()},
                     {"sessionId", session}});
}

Frame advertise(std::span<const Channel> channels) {
  json all = json::array();
  for (const Channel& channel : channels) {
    all.push_back({{"id", channel.id},
                   {"topic", channel.topic},
                   {"encoding", channel.encoding},
                   {"schemaName", channel.schema_name},
                   {"schemaEncoding", channel.schema_encoding},
                   {"schema", channel.schema}});
  }
  return text_frame({{"op", "advertise"}, {"channels", all}});
}

Frame advertise_services() {
  const auto message = [](const char* name, const json& properties) {
    const json schema = {
        {"type", "object"}, {"properties", properties}, {"additionalProperties", false}};
    return json{{"encoding", "json"},
                {"schemaName", name},
                {"schemaEncoding", "jsonschema"},
                {"schema", schema.dump()}};
  };
  json all = json::array();
  for (std::size_t i = 0; i < services.size(); ++i) {
    all.push_back(
        {{"id", i + 1},
         {"name", fmt::format("/tuina/{}", name_of(services[i]))},
         {"type", "tuina.Ask"},
         {"request", message("tuina.AskRequest", json::object())},
         {"response", message("tuina.AskResponse", {{"outcome", json{{"type", "string"}}}})}});
  }
  return text_frame({{"op", "advertiseServices"}, {"services", all}});
}

Frame status(std::string_view why) {
  return text_frame({{"op", "status"}, {"level", error_level}, {"message", why}});
}

Frame message_data(std::uint32_t subscription, std::uint64_t time_ns, std::string_view message) {
  Frame frame{.kind = Frame::Kind::binary};
  frame.bytes.reserve(1 + sizeof subscription + sizeof time_ns + message.size());
  frame.bytes.push_back(message_data_op);
  append(frame.bytes, subscription);
  append(frame.bytes, time_ns);
  frame.bytes.append(message);
  return frame;
}

Frame time(std::uint64_t time_ns) {
  Frame frame{.kind = Frame::Kind::binary, .bytes = {time_op}};
  append(frame.bytes, time_ns);
  return frame;
}

Frame service_done(const ServiceCall& call) {
  constexpr std::string_view encoding = "json", response = R"({"outcome":"done"})";
  Frame frame{.kind = Frame::Kind::binary, .bytes = {service_response_op}};
  append(frame.bytes, call.service);
  append(frame.bytes, call.call);
  append(frame.bytes, static_cast<std::uint32_t>(encoding.size()));
  frame.bytes.append(encoding).append(response);
  return frame;
}

Frame service_failed(const ServiceCall& call, std::string_view why) {
  return text_frame({{"op", "serviceCallFailure"},
                     {"serviceId", call.service},
                     {"callId", call.call},
                     {"message", why}});
}

}  // namespace tuina::web::foxglove
