// SPDX-License-Identifier: Apache-2.0
#include "tuina/session/config.hpp"

#include <fmt/ranges.h>

#include <algorithm>
#include <map>
#include <type_traits>
#include <vector>

#include "tuina/core/io/file.hpp"
#include "tuina/core/io/near_miss.hpp"
#include "tuina/core/io/toml_reader.hpp"
#include "tuina/session/realism.hpp"

namespace tuina::session {
namespace {

/// The one list of keys. A visitor has number(key, value, low, high, why), flag(key, value) and
/// word(key, value, choices); the key is "section.name". One that reads also has names(key).
template <typename ConfigType, typename Visitor>
void each_key(ConfigType& config, Visitor& visit) {
  visit.number("scan.sweep_s", config.scan.sweep_s, 2.0, 60.0, "");
  visit.number("scan.sweep_deg", config.scan.sweep_deg, 10.0, 90.0, "");
  visit.word("scan.method", config.scan.method, {"centroid", "likelihood"});
  visit.number("massage.standoff_mm", config.massage.standoff_mm, 15.0, 100.0, "");
  visit.number("massage.force_scale", config.massage.force_scale, 0.1, 1.5, "");
  visit.flag("massage.steer", config.massage.steer);
  visit.flag("massage.cautious", config.massage.cautious);
  visit.number("safety.force_ceiling_n", config.safety.force_ceiling_n, 5.0, 45.0,
               "a file may lower this ceiling, never raise it");
  visit.word("simulation.realism", config.simulation.realism, {"ideal", "usual", "hard"});
  if constexpr (!std::is_const_v<ConfigType>) {
    if (visit.names("simulation.realism")) set_realism(config.simulation);
  }
  visit.word("simulation.arms", config.simulation.arms, {"torque", "position_500", "position_125"});
  visit.number("simulation.breathing_mm", config.simulation.breathing_mm, 0.0, 20.0, "");
  visit.number("simulation.breathing_hz", config.simulation.breathing_hz, 0.05, 1.0, "");
  visit.number("simulation.friction", config.simulation.friction, 0.0, 3.0, "");
  visit.number("simulation.room_light_dn", config.simulation.room_light_dn, 0.0, 150.0, "");
  visit.number("simulation.shift_mm", config.simulation.shift_mm, -200.0, 200.0, "");
  visit.number("simulation.shift_at_s", config.simulation.shift_at_s, 0.0, 3600.0, "");
  visit.number("simulation.tissue_change_share", config.simulation.tissue_change_share, -0.9, 2.0,
               "");
  for (const SimulatedEffect& effect : simulated_effects()) {
    visit.number(effect.key, config.simulation.*effect.value, effect.min, effect.max, "");
  }
}

using Choices = std::vector<std::string>;

/// Looks the keys up in a file; what it does not name stays as it is.
class Reader {
 public:
  explicit Reader(const TomlTable& root) {
    for (const std::string& section : root.keys()) sections_[section] = root.table(section);
  }

  void number(std::string_view key, double& value, double low, double high, std::string_view why) {
    if (const auto* table = section_of(key)) {
      value = table->number(name_in(key), low, high, why).value_or(value);
    }
  }
  void flag(std::string_view key, bool& value) {
    if (const auto* table = section_of(key)) value = table->flag(name_in(key)).value_or(value);
  }
  void word(std::string_view key, std::string& value, const Choices& choices) {
    if (const auto* table = section_of(key)) {
      if (const auto chosen = table->word(name_in(key), choices)) value = choices[*chosen];
    }
  }

  [[nodiscard]] bool names(std::string_view key) {
    const auto* table = section_of(key);
    return table != nullptr && table->has(name_in(key));
  }

  void reject_unknown() const {
    for (const auto& [section, table] : sections_) {
      if (!table) continue;
      for (const std::string& name : table->keys()) {
        const std::string key = fmt::format("{}.{}", section, name);
        if (std::find(known_.begin(), known_.end(), key) == known_.end()) {
          table->wrong(name, "is unknown; " + suggestion(key, known_));
        }
      }
    }
  }

 private:
  const TomlTable* section_of(std::string_view key) {
    known_.emplace_back(key);
    const auto found = sections_.find(std::string(key.substr(0, key.find('.'))));
    return found != sections_.end() && found->second ? &*found->second : nullptr;
  }
  static std::string_view name_in(std::string_view key) { return key.substr(key.find('.') + 1); }

  std::map<std::string, std::optional<TomlTable>> sections_;
  Choices known_;
};

struct Writer {
  std::string text = {};
  std::string section = {};

  void line(std::string_view key, const std::string& value, const std::string& comment) {
    const auto dot = key.find('.');
    if (key.substr(0, dot) != section) {
      section = key.substr(0, dot);
      text += fmt::format("{}[{}]\n", text.empty() ? "" : "\n", section);
    }
    const std::string assignment = fmt::format("{} = {}", key.substr(dot + 1), value);
    text += comment.empty() ? assignment + "\n" : fmt::format("{:<26} # {}\n", assignment, comment);
  }
  void number(std::string_view key, double value, double low, double high, std::string_view) {
    std::string shown = fmt::format("{}", value);
    if (shown.find_first_of(".e") == std::string::npos) shown += ".0";
    line(key, shown, fmt::format("{} to {}", low, high));
  }
  void flag(std::string_view key, bool value) { line(key, value ? "true" : "false", ""); }
  void word(std::string_view key, const std::string& value, const Choices& choices) {
    line(key, '"' + value + '"', fmt::format("{}", fmt::join(choices, ", ")));
  }
};

Result<void> read_over(Config& config, std::string_view text, std::string_view name, Fault fault) {
  return read_toml(text, name, fault, [&](const TomlTable& root) {
    Reader reader(root);
    each_key(config, reader);
    reader.reject_unknown();
  });
}

}  // namespace

Result<Config> parse_config(std::string_view text, std::string_view name) {
  Config config;
  if (auto read = read_over(config, text, name, Fault::config); !read) {
    return tl::unexpected(read.error());
  }
  return config;
}

Result<Config> load_config(const std::filesystem::path& file) {
  constexpr std::size_t max_bytes = 1 << 20;
  const auto text = read_file(file, max_bytes);
  if (!text) return tl::unexpected(text.error());
  return parse_config(*text, file.string());
}

Result<void> apply_setting(Config& config, std::string_view setting) {
  const auto dot = setting.find('.');
  const auto equals = setting.find('=');
  if (dot == std::string_view::npos || equals == std::string_view::npos || dot > equals) {
    return fail(Fault::usage, "--set {}: section.key=value is needed", setting);
  }
  // A bare word is a string here: nobody types --set 'scan.method="likelihood"'.
  const std::string_view value = setting.substr(equals + 1);
  const bool bare = !value.empty() &&
                    std::isalpha(static_cast<unsigned char>(value.front())) != 0 &&
                    value != "true" && value != "false" && value != "nan" && value != "inf";
  const std::string text = fmt::format("[{}]\n{} = {}\n", setting.substr(0, dot),
                                       setting.substr(dot + 1, equals - dot - 1),
                                       bare ? fmt::format("\"{}\"", value) : std::string(value));
  Config changed = config;
  auto read = read_over(changed, text, "--set", Fault::usage);
  if (!read) return tl::unexpected(read.error());
  config = changed;
  return {};
}

std::string to_toml(const Config& config) {
  Writer writer;
  each_key(config, writer);
  return writer.text;
}

}  // namespace tuina::session
