// SPDX-License-Identifier: Apache-2.0
#include "apps/cli/command_line.hpp"

#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <memory>

#include "apps/cli/say.hpp"
#include "tuina/core/io/text_lines.hpp"
#include "tuina/core/io/unfinished_file.hpp"
#include "tuina/robot/robot_model.hpp"
#include "tuina/session/config.hpp"

namespace tuina::app {

Result<session::Config> effective_config(const CommonOptions& common) {
  session::Config config;
  if (!common.config_file.empty()) {
    auto loaded = session::load_config(common.config_file);
    if (!loaded) return loaded;
    config = *loaded;
  }
  for (const std::string& setting : common.settings) {
    if (auto applied = session::apply_setting(config, setting); !applied) {
      return tl::unexpected(applied.error());
    }
  }
  return config;
}

Progress progress_bar(const CommonOptions& common, std::string label) {
  if (common.quiet) return {};
  const bool terminal = ::isatty(STDERR_FILENO) == 1;
  const auto start = std::chrono::steady_clock::now();
  // Shared by the copies that the stages of a long work make, so that no step is told twice.
  const auto shown = std::make_shared<int>(-1);
  return [terminal, start, label = std::move(label), shown](double done) {
    const int step =
        terminal ? static_cast<int>(done * 40.0) : static_cast<int>(done * 10.0 + 1e-9);
    if (step <= *shown) return;
    *shown = step;
    const double elapsed_s =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    if (!terminal) {
      say(fmt::format("{} {} %\n", label, 10 * step));
      return;
    }
    const double left_s = done > 0.02 ? elapsed_s * (1.0 - done) / done : 0.0;
    say(fmt::format("\r\033[K{:<10} [{:<40}] {:3.0f} %  {:.1f} s{}", label,
                    std::string(static_cast<std::size_t>(step), '#'), 100.0 * done, elapsed_s,
                    done < 1.0 ? fmt::format(", {:.1f} s left", left_s) : "\n"));
  };
}

Result<void> check_folder_of(const std::string& path) {
  const std::filesystem::path folder = std::filesystem::path(path).parent_path();
  std::error_code error;
  if (std::filesystem::is_directory(path, error))
    return fail(Fault::file, "{}: is a folder, and a file is to be written", path);
  if (path.empty()) return {};
  if (folder.empty() || std::filesystem::is_directory(folder, error)) return check_can_begin(path);
  return fail(Fault::file, "{}: there is no folder {}", path, folder.string());
}

std::string shipped_robot_names() {
  std::string names;
  for (const robot::ShippedRobot& shipped : robot::shipped_robots())
    names += (names.empty() ? "" : ", ") + std::string(shipped.name);
  return names;
}

void add_robot_option(Options& options, std::string& robot) {
  options.add("--robot", robot, "a TOML file (docs/robot.md), or one of " + shipped_robot_names())
      .show_default();
}

}  // namespace tuina::app
