// SPDX-License-Identifier: Apache-2.0
#include "apps/cli/kept_inputs.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <filesystem>
#include <map>
#include <string>

#include "tuina/record/session_file.hpp"

namespace tuina::app {
namespace {

/// Options that name a file which a verb writes.
constexpr std::array<std::string_view, 12> written_options = {
    "--out",    "--picture", "--plot", "--predict-out", "--report", "--felt",
    "--joints", "--html",    "--page", "--figure",      "--look",   "--record"};
/// Tables of a recorded sweep, of a board's pictures and of touches.
constexpr std::array<std::string_view, 3> tables_of_recordings = {"frames.csv", "yaw.csv",
                                                                  "touches.csv"};
/// Folders of their pictures.
constexpr std::array<std::string_view, 2> picture_folders = {"frames", "dark"};

bool is_one_of(const auto& names, const std::string& name) {
  return std::ranges::find(names, name) != names.end();
}

/// True of what lies in the folder of a session or of a recording and is read with it. What a
/// session draws of itself may be drawn anew.
bool belongs_to_record(const std::filesystem::path& file) {
  const std::string ending = file.extension();
  const std::string name = file.filename();
  if (ending == ".png") return is_one_of(picture_folders, file.parent_path().filename());
  const bool read = ending == ".json" || ending == ".csv" || ending == ".mcap";
  if (read && is_one_of(record::files_of_session, name)) return true;
  if (is_one_of(tables_of_recordings, name)) return true;
  // The labels of a body are named as its skin is.
  std::error_code error;
  return ending == ".json" &&
         std::filesystem::exists(std::filesystem::path(file).replace_extension(".ply"), error);
}

/// True when writing the file would lose what the command reads: the file itself, or one of a
/// folder with a recording.
bool reads(const std::string& input, const std::filesystem::path& written) {
  std::error_code error;
  if (std::filesystem::equivalent(input, written, error)) return true;
  // A session.mcap is read for what lies beside it, too.
  std::filesystem::path of_record = input;
  if (of_record.extension() == ".mcap")
    of_record = std::filesystem::absolute(of_record, error).parent_path();
  if (!std::filesystem::is_directory(of_record, error)) return false;
  const auto folder = std::filesystem::canonical(of_record, error);
  const auto file = std::filesystem::canonical(written, error);
  return belongs_to_record(file) &&
         std::mismatch(folder.begin(), folder.end(), file.begin(), file.end()).first ==
             folder.end();
}

/// Two options that write the same file: the second would take the place of the first.
Result<void> check_apart(const CLI::App& chosen) {
  std::map<std::filesystem::path, std::string_view> writer_of;
  for (const std::string_view name : written_options) {
    const CLI::Option* option = chosen.get_option_no_throw(std::string(name));
    if (option == nullptr || option->count() == 0) continue;
    const std::string& word = option->results().front();
    std::error_code error;
    const auto file =
        std::filesystem::weakly_canonical(std::filesystem::absolute(word, error), error);
    // A device takes one after the other.
    if (std::filesystem::exists(file, error) && !std::filesystem::is_regular_file(file, error))
      continue;
    const auto [other, first] = writer_of.emplace(file, name);
    if (!first)
      return fail(Fault::usage, "{} and {} are both {}; each needs its own", other->second, name,
                  word);
  }
  return {};
}

}  // namespace

Result<void> check_not_onto_inputs(const CLI::App& chosen) {
  if (auto apart = check_apart(chosen); !apart) return apart;
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
