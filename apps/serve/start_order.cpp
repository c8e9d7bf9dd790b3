// SPDX-License-Identifier: Apache-2.0
#include "apps/serve/start_order.hpp"

#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <span>

#include "apps/cli/position_option.hpp"
#include "apps/simulated/devices/device_arms.hpp"
#include "tuina/session/consent.hpp"
#include "tuina/telemetry/plot/colours.hpp"

namespace tuina::app {
namespace {

using nlohmann::json;

constexpr std::array<const char*, 3> people = {"phantom:slim", "phantom:medium", "phantom:hefty"};
constexpr std::array<const char*, 3> positions = {"sitting", "prone", "auto"};
constexpr std::array<const char*, 3> answers = {"yes", "no", "unknown"};
constexpr std::array<const char*, 9> keys = {"person",    "position",  "seed",
                                             "programme", "intensity", "answered_by",
                                             "answers",   "who",       "remember"};
constexpr std::size_t of_person = 3;  // of these, the first
constexpr std::size_t max_name_bytes = 80;
constexpr std::ptrdiff_t max_name_letters = 40;
constexpr std::uint64_t max_seed = 1'000'000;

template <typename Words>
Result<std::string> one_of(const json& object, const char* key, const Words& words) {
  const auto found = object.find(key);
  if (found != object.end() && found->is_string()) {
    for (const auto& word : words) {
      if (found->template get_ref<const std::string&>() == word) return std::string(word);
    }
  }
  return fail(Fault::bad_input, "{}: is not one of {}", key, fmt::join(words, ", "));
}

Result<std::uint64_t> whole_number(const json& object, const char* key, std::uint64_t low,
                                   std::uint64_t high) {
  const auto found = object.find(key);
  if (found == object.end() || !found->is_number_unsigned() || found->get<std::uint64_t>() < low ||
      found->get<std::uint64_t>() > high) {
    return fail(Fault::bad_input, "{}: is not a whole number from {} to {}", key, low, high);
  }
  return found->get<std::uint64_t>();
}

std::vector<std::string> programme_names() {
  std::vector<std::string> names;
  for (const auto& shipped : massage::shipped_programmes()) names.emplace_back(shipped.name);
  return names;
}

/// Blanks are those of keyboards: of ASCII, the one that does not break, and the wide one.
std::string without_blanks_around(std::string_view text) {
  constexpr std::array<std::string_view, 3> blanks = {" ", "\u00a0", "\u3000"};
  for (bool found = true; found;) {
    found = false;
    for (const std::string_view blank : blanks) {
      if (text.starts_with(blank)) text.remove_prefix(blank.size()), found = true;
      if (text.ends_with(blank)) text.remove_suffix(blank.size()), found = true;
    }
  }
  return std::string(text);
}

/// A name as a TOML string, without blanks around it: what is no printable text is refused.
Result<std::string> quoted_name(const json& object) {
  const auto found = object.find("answered_by");
  const std::string name = without_blanks_around(
      found != object.end() && found->is_string() ? found->get<std::string>() : "");
  const bool printable = std::none_of(name.begin(), name.end(), [](unsigned char letter) {
    return letter < 0x20 || letter == 0x7f;
  });
  // Of a letter in UTF-8 all bytes but the first begin with the bits 10.
  const auto letters = std::count_if(name.begin(), name.end(),
                                     [](unsigned char byte) { return (byte & 0xC0) != 0x80; });
  if (name.empty() || letters > max_name_letters || !printable) {
    return fail(Fault::bad_input, "answered_by: is no name of 1 to {} letters", max_name_letters);
  }
  std::string quoted = "\"";
  for (const char letter : name) {
    if (letter == '"' || letter == '\\') quoted += '\\';
    quoted += letter;
  }
  return quoted + "\"";
}

Result<std::string> consent_of(const json& object) {
  auto name = quoted_name(object);
  if (!name) return tl::unexpected(name.error());
  std::string toml = fmt::format("answered_by = {}\n\n[answers]\n", *name);
  const auto given = object.find("answers");
  if (given == object.end() || !given->is_object())
    return fail(Fault::bad_input, "answers: is no object");
  for (const auto& answer : given->items()) {
    const bool known =
        std::any_of(session::health_questions.begin(), session::health_questions.end(),
                    [&](const auto& question) { return answer.key() == question.key; });
    if (!known) return fail(Fault::bad_input, "answers: to a question that is not asked");
  }
  for (const auto& question : session::health_questions) {
    auto answer = one_of(*given, question.key, answers);
    if (!answer) return tl::unexpected(answer.error());
    toml += fmt::format("{} = \"{}\"  # {}\n", question.key, *answer, question.text);
  }
  return toml;
}

/// A pseudonym; whether it is a right one is for the history to say. Not there: nobody's.
Result<std::string> who_of(const json& object) {
  const auto found = object.find("who");
  if (found == object.end()) return "";
  if (!found->is_string() || found->get_ref<const std::string&>().size() > max_name_bytes)
    return fail(Fault::bad_input, "who: is no pseudonym");
  return found->get<std::string>();
}

/// What is remembered, each to be used or not.
Result<Confirmed> confirmed_of(const json& object) {
  Confirmed confirmed = {};
  const auto given = object.find("remember");
  if (given == object.end()) return confirmed;
  if (!given->is_object()) return fail(Fault::bad_input, "remember: is no object");
  for (const auto& [key, use] : given->items()) {
    const auto kind = std::find(remembered_names.begin(), remembered_names.end(), key);
    if (kind == remembered_names.end() || !use.is_boolean()) {
      return fail(Fault::bad_input, "remember: is not true or false for one of {}",
                  fmt::join(remembered_names, ", "));
    }
    confirmed[static_cast<std::size_t>(kind - remembered_names.begin())] = use.get<bool>();
  }
  return confirmed;
}

/// Who is simulated.
Result<void> read_person(const json& object, StartOrder& start) {
  auto person = one_of(object, "person", people);
  const auto position = one_of(object, "position", positions);
  const auto seed = whole_number(object, "seed", 1, max_seed);
  if (!person) return tl::unexpected(person.error());
  if (!position) return tl::unexpected(position.error());
  if (!seed) return tl::unexpected(seed.error());
  start.order.person = std::move(*person);
  start.order.position = posture_of(*position);
  start.seed = *seed;
  return {};
}

}  // namespace

Result<std::optional<ServedDevices>> served_devices(const SessionOrder& order, std::uint64_t seed) {
  if (order.device.empty()) return std::optional<ServedDevices>();
  const auto file = read_arms(order.device);
  if (!file) return tl::unexpected(file.error());
  const std::string name = std::filesystem::path(order.device).filename().string();
  const bool sees = file->camera && file->turntable;
  if (sees && (order.calibration.empty() || order.robot_pose.empty())) {
    return fail(Fault::usage, "{}: a scanner of one's own needs {}", order.device,
                order.calibration.empty() ? "--calibration FILE.toml, by `tuina calibrate`"
                                          : "--robot-pose FILE.toml, by `tuina calibrate --robot`");
  }
  const std::string scanner =
      sees ? fmt::format("; {}, {}", file->camera->address, file->turntable->address) : "";
  return ServedDevices{.order = order,
                       .seed = seed,
                       .own_scanner = sees,
                       .named = fmt::format("{}: {}{}", name, name_of_arms(*file), scanner)};
}

Result<StartOrder> parse_start_order(std::string_view text,
                                     const std::optional<ServedDevices>& devices) {
  const json object = json::parse(text, nullptr, false);
  if (!object.is_object()) return fail(Fault::bad_input, "order: is no JSON object");
  const std::span<const char* const> known =
      devices ? std::span(keys).subspan(of_person) : std::span(keys);
  for (const auto& [key, value] : object.items()) {
    if (std::find(known.begin(), known.end(), key) == known.end())
      return fail(Fault::bad_input, "order: has a key that is none of {}", fmt::join(known, ", "));
  }
  StartOrder start;
  if (devices) {
    start.order = devices->order;
    start.seed = devices->seed;
  } else if (auto read = read_person(object, start); !read) {
    return tl::unexpected(read.error());
  }
  auto programme = one_of(object, "programme", programme_names());
  const auto intensity = whole_number(object, "intensity", 1, 5);
  auto consent = consent_of(object);
  auto who = who_of(object);
  const auto confirmed = confirmed_of(object);
  if (!programme) return tl::unexpected(programme.error());
  if (!intensity) return tl::unexpected(intensity.error());
  if (!consent) return tl::unexpected(consent.error());
  if (!who) return tl::unexpected(who.error());
  if (!confirmed) return tl::unexpected(confirmed.error());
  start.order.programme = std::move(*programme);
  start.intensity = static_cast<int>(*intensity);
  start.consent_toml = std::move(*consent);
  start.who = std::move(*who);
  start.confirmed = *confirmed;
  return start;
}

std::string choices_json(bool keeps_people, const std::optional<ServedDevices>& devices) {
  json programmes = json::array();
  for (const auto& shipped : massage::shipped_programmes()) {
    const auto read = massage::parse_programme(shipped.toml, shipped.name);
    programmes.push_back({{"name", shipped.name}, {"description", read ? read->description : ""}});
  }
  json techniques = json::array();
  for (const auto& row : technique_table)
    techniques.push_back({{"name", row.name}, {"colour", telemetry::css(row.colour)}});
  json questions = json::array();
  for (const auto& question : session::health_questions)
    questions.push_back({{"key", question.key}, {"text", question.text}});
  json zones = json::array();
  for (const auto& rule : massage::zone_rules)
    zones.push_back({{"name", rule.name}, {"cap_n", rule.cap_n}});
  json driven;
  if (devices) {
    const auto& position = devices->order.position;
    driven = {{"named", devices->named},
              {"person", devices->own_scanner ? json() : json(devices->order.person)},
              {"position", position ? name_of(*position) : "auto"},
              {"seed", devices->seed}};
  }
  return json{{"people", people},
              {"positions", positions},
              {"programmes", programmes},
              {"techniques", techniques},
              {"questions", questions},
              {"zones", zones},
              {"max_seed", max_seed},
              {"max_name_letters", max_name_letters},
              {"keeps_people", keeps_people},
              {"devices", driven}}
      .dump();
}

}  // namespace tuina::app
