// SPDX-License-Identifier: Apache-2.0
#include "tuina/web/foxglove.hpp"

#include <doctest/doctest.h>

#include <nlohmann/json.hpp>

#include "tuina/web/access.hpp"

namespace tuina::web {
namespace {

using nlohmann::json;

Frame binary(std::string_view bytes) {
  return {.kind = Frame::Kind::binary, .bytes = std::string(bytes)};
}

TEST_CASE("subscriptions and calls are read, and nothing else is") {
  const auto subscribe =
      foxglove::parse({.bytes = R"({"op":"subscribe","subscriptions":[{"id":7,"channelId":2}]})"});
  REQUIRE(subscribe.has_value());
  const auto& all = std::get<foxglove::Subscribe>(*subscribe).all;
  REQUIRE(all.size() == 1);
  CHECK(all[0].subscription == 7);
  CHECK(all[0].channel == 2);
  const auto left = foxglove::parse({.bytes = R"({"op":"unsubscribe","subscriptionIds":[7]})"});
  REQUIRE(left.has_value());
  CHECK(std::get<foxglove::Unsubscribe>(*left).subscriptions == std::vector<std::uint32_t>{7});

  using namespace std::string_view_literals;
  const auto call = foxglove::parse(binary("\2\1\0\0\0\5\0\0\0\4\0\0\0json{}"sv));
  REQUIRE(call.has_value());
  CHECK(std::get<foxglove::ServiceCall>(*call).call == 5);
  CHECK(foxglove::ask_of(std::get<foxglove::ServiceCall>(*call)).value() == Ask::stop);

  for (const char* text :
       {"", "[]", "{}", R"({"op":7})", R"({"op":"advertise","channels":[]})",
        R"({"op":"subscribe"})", R"({"op":"subscribe","subscriptions":[7]})",
        R"({"op":"subscribe","subscriptions":[{"id":-1,"channelId":2}]})",
        R"({"op":"subscribe","subscriptions":[{"id":4294967296,"channelId":2}]})",
        R"({"op":"unsubscribe","subscriptionIds":["7"]})"}) {
    CAPTURE(text);
    CHECK_FALSE(foxglove::parse({.bytes = text}).has_value());
  }
  for (const std::string_view bytes :
       {""sv, "\1"sv, "\2"sv, "\2\1\0\0\0\5\0\0\0"sv, "\2\1\0\0\0\5\0\0\0\xff\xff\xff\xffjson"sv})
    CHECK_FALSE(foxglove::parse(binary(bytes)).has_value());
}

TEST_CASE("a service is asked for by an empty object, and there are nine") {
  const auto asks = [](std::uint32_t service, const char* encoding, const char* request) {
    return foxglove::ask_of({.service = service, .encoding = encoding, .request = request})
        .has_value();
  };
  CHECK(asks(1, "json", "{}"));
  CHECK(asks(9, "json", "{}"));
  CHECK_FALSE(asks(0, "json", "{}"));
  CHECK_FALSE(asks(10, "json", "{}"));
  CHECK_FALSE(asks(1, "cdr", "{}"));
  CHECK_FALSE(asks(1, "json", ""));
  CHECK_FALSE(asks(1, "json", R"({"force_n":99})"));
  const json told = json::parse(foxglove::advertise_services().bytes);
  REQUIRE(told["services"].size() == foxglove::services.size());
  CHECK(told["services"][0]["name"] == "/tuina/stop");
  CHECK(told["services"][0]["id"] == 1);
}

TEST_CASE("messages stand behind the number of the subscription and their time") {
  using namespace std::string_view_literals;
  CHECK(foxglove::message_data(0x0201, 3, "abc").bytes == "\1\1\2\0\0\3\0\0\0\0\0\0\0abc"sv);
  CHECK(foxglove::time(0x0102).bytes == "\2\2\1\0\0\0\0\0\0"sv);
  CHECK(foxglove::service_done({.service = 1, .call = 5}).bytes ==
        "\3\1\0\0\0\5\0\0\0\4\0\0\0json{\"outcome\":\"done\"}"sv);
  const json info = json::parse(foxglove::server_info("x").bytes);
  CHECK(info["supportedEncodings"] == json::array({"json"}));
  CHECK(info["capabilities"] == json::array({"services", "time"}));
}

Request program(const Access& access) {
  return {.method = "GET",
          .path = foxglove::path,
          .query = "token=" + access.program_token(),
          .host = "127.0.0.1:8642",
          .upgrade = true,
          .subprotocols = "other, foxglove.websocket.v1"};
}

TEST_CASE("another program comes in by its token, as often as it wants, and by nothing else") {
  Access access(8642);
  const auto status = [&](const Request& request) {
    const auto reply = access.judge(request, 0.0);
    return reply ? reply->status : 200;
  };
  for (const char* origin : {"", "http://localhost:8642", "https://app.foxglove.dev", "file://"}) {
    Request request = program(access);
    request.origin = origin;
    CAPTURE(origin);
    CHECK(status(request) == 200);
    CHECK(status(request) == 200);
  }
  for (const char* origin : {"https://evil.example", "null", "http://localhost:8643",
                             "https://app.foxglove.dev.evil.example"}) {
    Request request = program(access);
    request.origin = origin;
    CAPTURE(origin);
    CHECK(status(request) == 403);
  }
  Request request = program(access);
  request.host = "evil.example:8642";
  CHECK(status(request) == 403);
  request = program(access);
  request.upgrade = false;
  CHECK(status(request) == 405);
  request = program(access);
  request.subprotocols = "foxglove.websocket.v2";
  CHECK(status(request) == 400);
  // The cookie of a page is no token, and the token opens no page.
  request = program(access);
  request.query.clear();
  request.cookie = "tuina_8642=" + access.program_token();
  CHECK(status(request) == 401);
  request = program(access);
  request.path = "/";
  request.upgrade = false;
  CHECK(status(request) == 401);
  for (int i = 0; i < 3; ++i) {
    request = program(access);
    request.query.back() = request.query.back() == '0' ? '1' : '0';
    CHECK(status(request) == 401);
  }
  CHECK(status(request) == 429);
}

}  // namespace
}  // namespace tuina::web
