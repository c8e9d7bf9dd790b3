// SPDX-License-Identifier: Apache-2.0
#include "tests/whole/command.hpp"

#include <sys/wait.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

namespace tuina::test {
namespace {

std::string content_of(const std::filesystem::path& path) {
  std::ostringstream text;
  text << std::ifstream(path, std::ios::binary).rdbuf();
  return text.str();
}

std::string quoted(const std::string& word) {
  std::string result = "'";
  for (const char letter : word)
    result += letter == '\'' ? std::string("'\\''") : std::string(1, letter);
  return result + "'";
}

}  // namespace

Outcome run_tuina(const std::vector<std::string>& arguments, int max_s) {
  const Folder folder;
  std::string command = max_s > 0 ? "timeout " + std::to_string(max_s) + " " : "";
  command += quoted(TUINA_BINARY);
  for (const std::string& argument : arguments) command += " " + quoted(argument);
  command += " >" + quoted(folder / "out") + " 2>" + quoted(folder / "err") + " </dev/null";
  const int status = std::system(command.c_str());
  return {.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : -1,
          .out = content_of(folder / "out"),
          .err = content_of(folder / "err")};
}

}  // namespace tuina::test
