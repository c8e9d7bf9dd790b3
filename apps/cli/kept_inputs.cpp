// SPDX-License-Identifier: Apache-2.0
#include "apps/cli/kept_inputs.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <filesystem>
#include <string>

namespace tuina::app {
namespace {

/// Options that name a file which a verb writes.
constexpr std::array<std::string_view, 5> written_options = {"--out", "--picture", "--plot",
                                                             "--predict-out", "--report"};
/// Endings of what recordings and records consist of.
constexpr std::array<std::string_view, 4> recorded = {".json", ".mcap", ".csv", ".png"};

/// True when writing the file would lose what the command reads: the file itself, or one of a
/// folder with a recording.
bool reads(const std::string& input, const std::filesystem::path& written) {
  std::error_code error;
  if (std::filesystem::equivalent(input, written, error)) return true;
  const std::string ending = written.extension().string();
  if (std::find(recorded.begin(), recorded.end(), ending) == recorded.end()) return false;
  // A session.mcap is read with what lies beside it.
  std::filesystem::path of_record = input;
  if (of_record.extension() == ".mcap")
    of_record = std::filesystem::absolute(of_record, error).parent_path();
  if (!std::filesystem::is_directory(of_record, error)) return false;
  const auto folder = std::filesystem::canonical(of_record, error);
  const auto file = std::filesystem::canonical(written, error);
  return std::mismatch(folder.begin(), folder.end(), file.begin(), file.end()).first ==
         folder.end();
}

}  // namespace

Result<void> check_not_onto_inputs(const CLI::App& chosen) {
  std::error_code error;
  for (const std::string_view name : written_options) {
    const CLI::Option* option = chosen.get_option_no_throw(std::string(name));
    if (option == nullptr || option->count() == 0) continue;
    const std::string written = option->results().front();
    if (!std::filesystem::is_regular_file(written, error)) continue;
    for (const CLI::Option* other : chosen.get_options()) {
      if (other == option) continue;
      for (const std::string& word : other->results()) {
        if (reads(word, written))
          return fail(Fault::usage, "{} {}: is read by this command, and would be lost", name,
                      written);
      }
    }
  }
  return {};
}

}  // namespace tuina::app
