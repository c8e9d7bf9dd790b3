// SPDX-License-Identifier: Apache-2.0
#include "apps/cli/mark_words.hpp"

#include <algorithm>
#include <set>
#include <string_view>

#include "tuina/core/io/near_miss.hpp"
#include "tuina/scanner/stickers/label_dots.hpp"

namespace tuina::app {
namespace {

constexpr const char* right_form = "magenta=SI11,BL47,BL50 yellow=GV4 is a right one";

std::vector<std::string> split(std::string_view text, char at) {
  std::vector<std::string> parts;
  for (;;) {
    const auto end = text.find(at);
    parts.emplace_back(text.substr(0, end));
    if (end == std::string_view::npos) return parts;
    text.remove_prefix(end + 1);
  }
}

/// The point or the pair that a name means.
Result<std::vector<std::string>> level_of(const std::string& name,
                                          const std::vector<std::string>& known,
                                          const char* option) {
  const auto has = [&](const std::string& word) {
    return std::find(known.begin(), known.end(), word) != known.end();
  };
  if (has(name)) return std::vector<std::string>{name};
  if (has(name + "_L") && has(name + "_R")) return std::vector{name + "_L", name + "_R"};
  std::vector<std::string> words;
  for (const std::string& word : known) {
    const bool sided = word.ends_with("_L") || word.ends_with("_R");
    const std::string base = sided ? word.substr(0, word.size() - 2) : word;
    if (words.empty() || words.back() != base) words.push_back(base);
  }
  return fail(Fault::usage, "{}: no point is called '{}'; {}", option, name,
              suggestion(name, words));
}

/// Which scans show a kind of marks, for who has named it with another one.
const char* where_told(const std::string& kind) {
  if (kind == bump_kind) return " here, but in a cloud (.ply, .pcd)";
  const auto colours = sticker_kinds();
  const bool is_colour = std::find(colours.begin(), colours.end(), kind) != colours.end();
  return is_colour ? " here, but in a recorded sweep (a folder)" : "";
}

}  // namespace

std::vector<std::string> sticker_kinds() {
  std::vector<std::string> kinds;
  kinds.reserve(scanner::sticker_colours.size());
  for (const auto colour : scanner::sticker_colours) kinds.emplace_back(scanner::name_of(colour));
  return kinds;
}

std::size_t MarkGroup::count() const {
  std::size_t sum = 0;
  for (const auto& level : levels) sum += level.size();
  return sum;
}

Result<std::vector<MarkGroup>> parse_marks(const std::vector<std::string>& words,
                                           const std::vector<std::string>& kinds,
                                           const std::vector<std::string>& known,
                                           const char* option) {
  std::vector<MarkGroup> groups;
  std::set<std::string> named;
  for (const std::string& word : words) {
    const auto equals = word.find('=');
    if (equals == std::string::npos) {
      return fail(Fault::usage, "{}: '{}' names no kind of marks and points; {}", option, word,
                  right_form);
    }
    const std::string kind = word.substr(0, equals);
    if (std::find(kinds.begin(), kinds.end(), kind) == kinds.end()) {
      return fail(Fault::usage, "{}: no marks are told by '{}'{}; {}", option, kind,
                  where_told(kind), suggestion(kind, kinds));
    }
    for (const MarkGroup& other : groups) {
      if (other.kind == kind) {
        return fail(Fault::usage, "{}: {} stands there twice; all its points go into one list",
                    option, kind);
      }
    }
    MarkGroup group{.kind = kind, .levels = {}};
    for (const std::string& name : split(std::string_view(word).substr(equals + 1), ',')) {
      auto level = level_of(name, known, option);
      if (!level) return tl::unexpected(level.error());
      for (const std::string& point : *level) {
        if (!named.insert(point).second) {
          return fail(Fault::usage, "{}: {} is named twice", option, point);
        }
      }
      group.levels.push_back(std::move(*level));
    }
    groups.push_back(std::move(group));
  }
  return groups;
}

}  // namespace tuina::app
