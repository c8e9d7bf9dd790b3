// SPDX-License-Identifier: Apache-2.0
#include <CLI/CLI.hpp>
#include <cstdio>
#include <map>

#include "apps/tuina/command_line.hpp"
#include "apps/tuina/verbs.hpp"
#include "tuina/core/file.hpp"

namespace {

using namespace tuina;
using namespace tuina::app;

int exit_code_of(Fault fault) {
  switch (fault) {
    case Fault::usage:
      return 1;
    case Fault::device:
      return 3;
    case Fault::stopped:
      return 4;
    default:
      return 2;
  }
}

void add_common_options(CLI::App& command, CommonOptions& common, std::string& out) {
  if (command.get_option_no_throw("--out") == nullptr) {
    command.add_option("--out", out, "write the JSON object to this file");
  }
  command.add_flag("--json", common.json, "write one JSON object to stdout and nothing else there");
  command.add_flag("--quiet", common.quiet, "no text and no progress bar");
  command.add_option("--seed", common.seed, "same seed, same result")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  command.add_option("--config", common.config_file, "a TOML file; see `tuina config show`");
  command.add_option("--set", common.settings, "section.key=value, over the file")
      ->allow_extra_args(false);
}

int explain(const Error& error) {
  fmt::print(stderr, "tuina: {}\n", error.message);
  return exit_code_of(error.fault);
}

int show(const Result<Answer>& answer, const CommonOptions& common, const std::string& out) {
  if (!answer) return explain(answer.error());
  if (!out.empty()) {
    if (const auto written = write_file(out, answer->json + "\n"); !written)
      return explain(written.error());
  }
  if (common.json) {
    fmt::print("{}\n", answer->json);
  } else if (!common.quiet) {
    fmt::print("{}", answer->product);
  }
  if (!common.quiet && !answer->text.empty()) fmt::print(stderr, "{}\n", answer->text);
  return answer->exit_code;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App tuina("tuina: a robot massages a person, here in simulation.", "tuina");
  tuina.set_version_flag("--version", TUINA_VERSION);
  tuina.require_subcommand(0, 1);

  CommonOptions common;
  std::string out;
  const auto verbs = make_verbs();
  std::map<const CLI::App*, Verb*> verb_of;
  std::map<std::string, CLI::App*> groups;
  for (const auto& verb : verbs) {
    // A name of two words is a verb within a group: `tissue fit`.
    CLI::App* parent = &tuina;
    std::string name = verb->name();
    if (const auto space = name.find(' '); space != std::string::npos) {
      const std::string group = name.substr(0, space);
      CLI::App*& known = groups[group];
      if (known == nullptr) {
        known = tuina.add_subcommand(group, fmt::format("see `tuina {} --help`", group));
        known->require_subcommand(0, 1);
      }
      parent = known;
      name = name.substr(space + 1);
    }
    CLI::App* command = parent->add_subcommand(name, verb->summary());
    command->footer(fmt::format("Example:\n  {}", verb->example()));
    verb->describe(*command);
    add_common_options(*command, common, out);
    verb_of[command] = verb.get();
  }

  try {
    tuina.parse(argc, argv);
  } catch (const CLI::CallForHelp&) {
    const CLI::App* deepest = &tuina;
    while (!deepest->get_subcommands().empty()) deepest = deepest->get_subcommands().front();
    fmt::print("{}", deepest->help());
    return 0;
  } catch (const CLI::CallForVersion&) {
    fmt::print("tuina {}\n", TUINA_VERSION);
    return 0;
  } catch (const CLI::ParseError& error) {
    fmt::print(stderr, "tuina: {}\nSee `tuina --help`.\n", error.what());
    return 1;
  }

  const CLI::App* chosen = &tuina;
  while (!chosen->get_subcommands().empty()) chosen = chosen->get_subcommands().front();
  const auto found = verb_of.find(chosen);
  if (found == verb_of.end()) {
    fmt::print(stderr, "{}", chosen->help());
    return 1;
  }
  return show(found->second->run(common), common, out);
}
