// SPDX-License-Identifier: Apache-2.0
#include "tuina/web/ask.hpp"

#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

namespace tuina::web {

std::optional<session::LiveCommand> live_command(Ask ask) noexcept {
  const std::string_view name = name_of(ask);
  for (std::size_t i = 0; i < session::live_command_names.size(); ++i) {
    if (name == session::live_command_names[i]) return static_cast<session::LiveCommand>(i);
  }
  return std::nullopt;
}

Result<Message> parse_message(std::string_view text) {
  if (text.size() > max_message_bytes) {
    return fail(Fault::bad_input, "a message of {} bytes; {} are the limit", text.size(),
                max_message_bytes);
  }
  const auto json = nlohmann::json::parse(text, nullptr, false);
  if (!json.is_object()) return fail(Fault::bad_input, "a message that is not a JSON object");
  for (const auto& [key, value] : json.items()) {
    if (key != "ask" && key != "sequence" && key != "clock_s" && key != "order" && key != "review")
      return fail(Fault::bad_input, "an unknown key of {} letters", key.size());
  }
  Message message;
  const auto ask = json.find("ask");
  if (ask == json.end() || !ask->is_string()) return fail(Fault::bad_input, "ask: is no text");
  const auto& name = ask->get_ref<const std::string&>();
  const auto known = std::find(ask_names.begin(), ask_names.end(), std::string_view(name));
  if (known == ask_names.end()) {
    return fail(Fault::bad_input, "ask: a word of {} letters is not one of {}", name.size(),
                fmt::join(ask_names, ", "));
  }
  message.ask = static_cast<Ask>(known - ask_names.begin());
  const auto sequence = json.find("sequence");
  if (sequence == json.end() || !sequence->is_number_unsigned())
    return fail(Fault::bad_input, "sequence: is no whole number");
  message.sequence = sequence->get<std::uint64_t>();
  const auto clock = json.find("clock_s");
  if (clock == json.end() || !clock->is_number())
    return fail(Fault::bad_input, "clock_s: is no number");
  message.clock_s = clock->get<double>();
  if (!std::isfinite(message.clock_s)) return fail(Fault::bad_input, "clock_s: is not finite");
  if (const auto review = json.find("review"); review != json.end()) {
    if (!review->is_number_unsigned()) return fail(Fault::bad_input, "review: is no whole number");
    message.review = review->get<std::uint64_t>();
  }
  const auto order = json.find("order");
  if ((order != json.end()) != (message.ask == Ask::start || message.ask == Ask::change))
    return fail(Fault::bad_input, "order: belongs to `start` and `change`, and only there");
  if (order != json.end()) message.order = order->dump();
  return message;
}

}  // namespace tuina::web
