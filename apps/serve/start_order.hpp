// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "apps/serve/known_people.hpp"
#include "apps/simulated/session_order.hpp"

namespace tuina::app {

/// What a page orders of a session: names that are built in and numbers within limits, no paths.
struct StartOrder {
  SessionOrder order;
  int intensity = 3;  ///< 1 to 5; a factor on every force, as for a programme
  std::uint64_t seed = 1;
  std::string consent_toml;  ///< answers to the health questions
  std::string who;           ///< a pseudonym; empty: no history
  Confirmed confirmed = {};  ///< what is remembered of them
};

/// The devices that a server's sessions are driven on: no page chooses who is before them.
struct ServedDevices {
  SessionOrder order;        ///< what is known without a page: device file, robot, person, position
  std::uint64_t seed = 1;    ///< of that person
  bool own_scanner = false;  ///< nobody is simulated: who is before the scanner, it says
  std::string named;  ///< for people: the file's name, kind and addresses of the arms, the scanner
};
/// Of an order that names a device file, which is read; nothing of one that names none.
[[nodiscard]] Result<std::optional<ServedDevices>> served_devices(const SessionOrder& order,
                                                                  std::uint64_t seed);

/// Reads the JSON object of `start`; with `devices` it has neither person nor position nor seed.
/// Whatever is missing, unknown or out of range is refused with its key. Answers are only read, not
/// judged: `session::parse_consent` does that.
[[nodiscard]] Result<StartOrder> parse_start_order(
    std::string_view text, const std::optional<ServedDevices>& devices = {});

/// JSON object of what may be chosen, for the page of a server that keeps a history of people, or
/// none, and that drives devices, or none.
[[nodiscard]] std::string choices_json(bool keeps_people,
                                       const std::optional<ServedDevices>& devices = {});

}  // namespace tuina::app
