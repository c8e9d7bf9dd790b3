// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <functional>
#include <map>
#include <mutex>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "apps/cli/command_line.hpp"
#include "tuina/session/config.hpp"

namespace tuina::app {

/// The cells of an evaluation: trials with a name each that know nothing of each other, so that a
/// campaign may be done in pieces, on any machines, in any order. `--shard K/N` does those whose
/// names fall to K and writes them into a file, a line each; `--merged FILE` takes them from such
/// files and makes the tables that one run makes, computing times aside. `at` may be called from
/// many threads.
class Cells {
 public:
  using Json = nlohmann::ordered_json;

  /// Adds the options. `out`: the --out that the verb has already; it names the file of a shard.
  void describe(Options& options, std::string* out = nullptr);
  /// Reads what was done before. Fails with file and line: other files, cells of another version,
  /// configuration or command line.
  [[nodiscard]] Result<void> open(const CommonOptions& common, const session::Config& config);
  /// Does not do again what stands in this file, and adds what does not. The names of the cells say
  /// all that the command line does, but for `words`.
  void keep(const std::string& file, std::vector<std::string> words) {
    file_ = file;
    words_ = std::move(words);
  }
  [[nodiscard]] bool sharded() const { return !shard_.empty(); }

  /// The result of a cell: taken from a file, or computed and kept. A cell of another shard, and
  /// one that a merge misses, has an empty result. `Outcome` has `visit_fields(outcome, visit)`.
  template <typename Outcome, typename Compute>
  [[nodiscard]] Result<Outcome> at(const std::string& name, const Compute& compute) {
    Outcome outcome{};
    if (const Json* known = find(name)) {
      try {
        visit_fields(outcome, [&](const char* key, auto& value) { take(known->at(key), value); });
      } catch (const std::exception&) {
        return fail(Fault::bad_input,
                    "the cell \"{}\" has other fields than this version writes: begin a new file",
                    name);
      }
      return outcome;
    }
    if (!mine(name)) return outcome;
    Result<Outcome> computed = compute();
    if (!computed) return computed;
    Json line;
    visit_fields(*computed, [&](const char* key, auto& value) { line[key] = written(value); });
    if (auto added = add(name, line); !added) return tl::unexpected(added.error());
    return computed;
  }

  /// The tables; of a shard only what it did. Fails with the names of the cells that a merge
  /// misses.
  [[nodiscard]] Result<Answer> answer(const std::function<Result<Answer>()>& tables) const;

 private:
  // JSON has no word for what is no number.
  static Json written(const double& value) {
    return std::isfinite(value) ? Json(value) : Json(fmt::format("{}", value));
  }
  static Json written(const std::vector<double>& values) {
    Json list = Json::array();
    for (const double value : values) list.push_back(written(value));
    return list;
  }
  template <typename Value>
  static Json written(const Value& value) {
    return value;
  }
  static void take(const Json& json, double& value) {
    value = json.is_string() ? std::stod(json.get<std::string>()) : json.get<double>();
  }
  static void take(const Json& json, std::vector<double>& values) {
    for (const Json& one : json) take(one, values.emplace_back());
  }
  template <typename Value>
  static void take(const Json& json, Value& value) {
    json.get_to(value);
  }

  [[nodiscard]] Result<void> read_file_of(const std::string& file, const Json& header);
  [[nodiscard]] const Json* find(const std::string& name);
  [[nodiscard]] bool mine(const std::string& name);
  [[nodiscard]] Result<void> add(const std::string& name, const Json& line);

  std::string shard_, file_, own_out_;
  std::string* out_ = &own_out_;
  std::vector<std::string> merged_;
  std::optional<std::vector<std::string>> words_;
  std::uint64_t part_ = 1, parts_ = 1;
  std::mutex mutex_;
  std::map<std::string, Json> known_;
  std::size_t asked_ = 0, done_ = 0;
  std::vector<std::string> lost_, repeated_;
};

/// What two runs of one evaluation have in common when their cells may be joined: the words of the
/// command line but those that only say where results go.
[[nodiscard]] std::vector<std::string> campaign_words(const std::vector<std::string>& words);
/// The first line of a file of cells.
[[nodiscard]] Result<Cells::Json> read_header(const std::string& file);

}  // namespace tuina::app
