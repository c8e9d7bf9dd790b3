// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "apps/cli/options.hpp"
#include "tuina/core/progress.hpp"
#include "tuina/core/result.hpp"

namespace tuina::session {
struct Config;
}

namespace tuina::app {

/// The options that every verb has (docs: the contract of the command line).
struct CommonOptions {
  bool json = false;
  bool quiet = false;
  std::uint64_t seed = 1;
  std::string out;  ///< file for the JSON object, of verbs without an --out of their own
  std::string config_file;
  std::vector<std::string> settings;  ///< --set section.key=value
};

/// What a verb answers. Text is for people and goes to stderr; with --json the object goes to
/// stdout, else the product does, for the verbs whose product is text. A verb without an --out of
/// its own gets one that takes the object.
struct Answer {
  std::string json = {};  ///< one JSON object
  std::string text = {};
  std::string product = {};
  int exit_code = 0;
};

/// One verb of the command line. `describe` adds its options to the subcommand; `run` does the
/// work. Options bind to members that live as long as the program.
class Verb {
 public:
  virtual ~Verb() = default;
  [[nodiscard]] virtual const char* name() const = 0;
  [[nodiscard]] virtual const char* summary() const = 0;  ///< one line
  /// A second name, by which other programs know the verb; empty if it has none.
  [[nodiscard]] virtual const char* alias() const { return ""; }
  [[nodiscard]] virtual const char* example() const = 0;  ///< shown by --help
  virtual void describe(Options& options) = 0;
  [[nodiscard]] virtual Result<Answer> run(const CommonOptions& common) = 0;
};

/// --config with every --set over it.
[[nodiscard]] Result<session::Config> effective_config(const CommonOptions& common);

/// A bar on a terminal, else a line per 10 %, silent with --quiet; always on stderr.
[[nodiscard]] Progress progress_bar(const CommonOptions& common, std::string label);

/// Refuses a file that a verb is to write where there is no folder for it, or a folder in its
/// place: before the work, not after it. An empty path is none.
[[nodiscard]] Result<void> check_folder_of(const std::string& path);

/// Names of the robots that are built in, for --help.
[[nodiscard]] std::string shipped_robot_names();
/// `--robot NAME|FILE.toml`.
void add_robot_option(Options& options, std::string& robot);

}  // namespace tuina::app
