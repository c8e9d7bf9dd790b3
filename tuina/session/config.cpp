// SPDX-License-Identifier: Apache-2.0
#include "tuina/session/config.hpp"

#include <fmt/ranges.h>

#include <toml++/toml.h>
#include <algorithm>
#include <cmath>
#include <sstream>
#include <vector>

#include "tuina/core/file.hpp"
#include "tuina/core/near_miss.hpp"

namespace tuina::session {
namespace {

/// The one list of keys. A visitor has number(key, value, low, high, why), flag(key, value) and
/// word(key, value, choices); the key is "section.name".
template <typename ConfigType, typename Visitor>
void each_key(ConfigType& config, Visitor& visit) {
  visit.number("scan.sweep_s", config.scan.sweep_s, 2.0, 60.0, "");
  visit.number("scan.sweep_deg", config.scan.sweep_deg, 10.0, 90.0, "");
  visit.word("scan.method", config.scan.method, {"centroid", "likelihood"});
  visit.number("massage.standoff_mm", config.massage.standoff_mm, 15.0, 100.0, "");
  visit.number("massage.force_scale", config.massage.force_scale, 0.1, 1.5, "");
  visit.flag("massage.steer", config.massage.steer);
  visit.number("safety.force_ceiling_n", config.safety.force_ceiling_n, 5.0, 45.0,
               "a file may lower this ceiling, never raise it");
  visit.number("simulation.breathing_mm", config.simulation.breathing_mm, 0.0, 20.0, "");
  visit.number("simulation.breathing_hz", config.simulation.breathing_hz, 0.05, 1.0, "");
  visit.number("simulation.torso_n_per_mm", config.simulation.torso_n_per_mm, 5.0, 1000.0, "");
  visit.number("simulation.friction", config.simulation.friction, 0.0, 3.0, "");
  visit.number("simulation.room_light_dn", config.simulation.room_light_dn, 0.0, 150.0, "");
  visit.number("simulation.shift_mm", config.simulation.shift_mm, -200.0, 200.0, "");
  visit.number("simulation.shift_at_s", config.simulation.shift_at_s, 0.0, 3600.0, "");
}

using Choices = std::vector<std::string>;

/// Looks the keys up in a parsed table, checks their values and collects what is wrong.
struct Reader {
  const toml::table& table;
  std::string_view name;
  bool has_lines = true;  ///< false for one setting of the command line
  std::vector<std::string> known = {};
  std::vector<std::string> faults = {};

  const toml::node* find(std::string_view key) {
    known.emplace_back(key);
    return table.at_path(key).node();
  }
  void reject(const toml::node& node, std::string_view key, std::string_view what) {
    std::ostringstream value;
    if (node.is_value()) node.visit([&](const auto& n) { value << " = " << n; });
    const std::string where =
        has_lines ? fmt::format("{}:{}", name, node.source().begin.line) : std::string(name);
    faults.push_back(fmt::format("{}: {}{} {}", where, key, value.str(), what));
  }

  void number(std::string_view key, double& value, double low, double high, std::string_view why) {
    const toml::node* node = find(key);
    if (node == nullptr) return;
    const auto given = node->value<double>();
    if (!node->is_number() || !given) return reject(*node, key, "is not a number");
    // Written so that NaN is outside.
    if (!(*given >= low && *given <= high)) {
      const std::string reason = why.empty() ? "" : fmt::format(": {}", why);
      return reject(*node, key, fmt::format("is outside {} to {}{}", low, high, reason));
    }
    value = *given;
  }
  void flag(std::string_view key, bool& value) {
    const toml::node* node = find(key);
    if (node == nullptr) return;
    if (!node->is_boolean()) return reject(*node, key, "is not true or false");
    value = node->as_boolean()->get();
  }
  void word(std::string_view key, std::string& value, const Choices& choices) {
    const toml::node* node = find(key);
    if (node == nullptr) return;
    const auto given = node->value<std::string>();
    if (!given || std::find(choices.begin(), choices.end(), *given) == choices.end()) {
      return reject(*node, key, fmt::format("is not one of {}", fmt::join(choices, ", ")));
    }
    value = *given;
  }

  void reject_unknown() {
    for (const auto& [section_name, section] : table) {
      const std::string prefix(section_name.str());
      if (!section.is_table()) {
        reject(section, prefix, unknown(prefix));
        continue;
      }
      for (const auto& [key_name, node] : *section.as_table()) {
        const std::string key = prefix + "." + std::string(key_name.str());
        if (std::find(known.begin(), known.end(), key) == known.end()) {
          reject(node, key, unknown(key));
        }
      }
    }
  }
  [[nodiscard]] std::string unknown(const std::string& key) const {
    return "is unknown; " + suggestion(key, known);
  }
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
  try {
    const toml::table table = toml::parse(text, std::string(name));
    Reader reader{.table = table, .name = name, .has_lines = fault != Fault::usage};
    each_key(config, reader);
    reader.reject_unknown();
    if (!reader.faults.empty()) return fail(fault, "{}", fmt::join(reader.faults, "\n"));
    return {};
  } catch (const toml::parse_error& error) {
    if (fault == Fault::usage) return fail(fault, "{}: {}", name, error.description());
    return fail(fault, "{}:{}: {}", name, error.source().begin.line, error.description());
  }
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
  constexpr std::size_t largest_bytes = 1 << 20;
  const auto text = read_file(file, largest_bytes);
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
