// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "apps/cli/command_line.hpp"

namespace tuina::app {

/// A verb, or group of verbs, that another program in the same folder has.
struct ProgramBeside {
  std::string verb;
  std::string summary;  ///< one line
  std::string program;
};

struct Program {
  std::vector<std::unique_ptr<Verb>> verbs;  ///< in the order in which --help shows them
  std::vector<ProgramBeside> beside = {};
  /// One line for --help about the verbs that begin with the same word.
  std::string (*summary_of_group)(std::string_view group);
};

/// Reads the command line, runs the verb that it names, prints the answer. Gives the exit code.
int run_program(int argc, char** argv, const Program& program);

/// Path of a program in the folder of this one.
[[nodiscard]] std::string program_beside(const std::string& name);

}  // namespace tuina::app
