// SPDX-License-Identifier: Apache-2.0
#include "apps/cli/manual.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <functional>

namespace tuina::app {
namespace {

/// Every verb and group, with the words that lead to it: "atlas learn".
void for_each_command(const CLI::App& command, const std::string& words,
                      const std::function<void(const CLI::App&, const std::string&)>& look) {
  for (const CLI::App* sub : command.get_subcommands(nullptr)) {
    const std::string path = words.empty() ? sub->get_name() : words + " " + sub->get_name();
    look(*sub, path);
    for_each_command(*sub, path, look);
  }
}

/// Names of its options and of the verbs below it.
std::vector<std::string> words_after(const CLI::App& command) {
  std::vector<std::string> words;
  for (const CLI::App* sub : command.get_subcommands(nullptr)) words.push_back(sub->get_name());
  for (const CLI::Option* option : command.get_options())
    for (const std::string& name : option->get_lnames()) words.push_back("--" + name);
  return words;
}

/// Text as roff shows it: nothing in it is an order to roff.
std::string as_it_stands(const std::string& text) {
  std::string roff;
  bool line_begins = true;
  for (const char letter : text) {
    if (line_begins && (letter == '.' || letter == '\'')) roff += "\\&";
    if (letter == '\\')
      roff += "\\e";
    else if (letter == '-')
      roff += "\\-";
    else
      roff += letter;
    line_begins = letter == '\n';
  }
  return roff;
}

/// What --help says of a command; the parser's own would speak of the verb that was called.
std::string help_of(const CLI::App& command, const std::string& words) {
  return command.get_formatter()->make_help(&command, words, CLI::AppFormatMode::Normal);
}

std::string bash_script(const CLI::App& program) {
  const std::string& name = program.get_name();
  std::string cases;
  for_each_command(program, "", [&](const CLI::App& command, const std::string& path) {
    cases +=
        fmt::format("    \"{}\") words=\"{}\" ;;\n", path, fmt::join(words_after(command), " "));
  });
  return fmt::format(
      "_{0}() {{\n"
      "  local words=\"{1}\" at=\"\" i\n"
      "  for ((i = 1; i < COMP_CWORD && i <= 2; ++i)); do\n"
      "    [[ ${{COMP_WORDS[i]}} == -* ]] || at=\"${{at:+$at }}${{COMP_WORDS[i]}}\"\n"
      "  done\n"
      "  _{0}_after \"$at\" || _{0}_after \"${{at%% *}}\"\n"
      "  COMPREPLY=($(compgen -W \"$words\" -- \"${{COMP_WORDS[COMP_CWORD]}}\"))\n"
      "}}\n"
      "_{0}_after() {{\n"
      "  case \"$1\" in\n"
      "{2}"
      "    *) return 1 ;;\n"
      "  esac\n"
      "}}\n"
      "complete -o default -F _{0} {0}\n",
      name, fmt::join(words_after(program), " "), cases);
}

/// In single quotes, as fish reads them.
std::string in_fish_quotes(const std::string& text) {
  std::string quoted = "'";
  for (const char letter : text) {
    if (letter == '\'' || letter == '\\') quoted += '\\';
    quoted += letter == '\n' ? ' ' : letter;
  }
  return quoted + "'";
}

std::string fish_script(const CLI::App& program) {
  const std::string& name = program.get_name();
  std::string script;
  for (const CLI::App* verb : program.get_subcommands(nullptr)) {
    script += fmt::format("complete -c {} -n __fish_use_subcommand -f -a {} -d {}\n", name,
                          verb->get_name(), in_fish_quotes(verb->get_description()));
  }
  for_each_command(program, "", [&](const CLI::App& command, const std::string& path) {
    std::string seen;
    for (const std::string& word : CLI::detail::split(path, ' '))
      seen += fmt::format("{}__fish_seen_subcommand_from {}", seen.empty() ? "" : "; and ", word);
    for (const CLI::App* sub : command.get_subcommands(nullptr)) {
      script += fmt::format("complete -c {} -n '{}' -f -a {} -d {}\n", name, seen, sub->get_name(),
                            in_fish_quotes(sub->get_description()));
    }
    for (const CLI::Option* option : command.get_options()) {
      for (const std::string& word : option->get_lnames())
        script += fmt::format("complete -c {} -n '{}' -l {} -d {}\n", name, seen, word,
                              in_fish_quotes(option->get_description()));
    }
  });
  return script;
}

}  // namespace

std::string manual_page(const CLI::App& program, const std::string& version) {
  const std::string& name = program.get_name();
  const std::string said = program.get_description();  // "tuina: what it does"
  const std::string what = said.starts_with(name + ": ") ? said.substr(name.size() + 2) : said;
  std::string page = fmt::format(
      ".TH {} 1 \"\" \"{} {}\"\n.SH NAME\n{} \\- {}\n.SH SYNOPSIS\n.B {}\n.I verb\n[options]\n"
      ".SH DESCRIPTION\n",
      name, name, version, name, as_it_stands(what), name);
  const auto add = [&](const std::string& help) {
    page += fmt::format(".nf\n{}\n.fi\n", as_it_stands(help));
  };
  add(help_of(program, name));
  page += ".SH VERBS\n";
  for_each_command(program, "", [&](const CLI::App& command, const std::string& path) {
    if (!command.get_subcommands(nullptr).empty()) return;
    page += fmt::format(".SS {} {}\n", name, path);
    add(help_of(command, name + " " + path));
  });
  page += ".SH EXIT STATUS\n0 done, 1 wrong use, 2 bad input, 3 a device, 4 stopped for safety.\n";
  return page;
}

std::string completion_script(const CLI::App& program, const std::string& shell) {
  if (shell == "fish") return fish_script(program);
  if (shell == "bash") return bash_script(program);
  return fmt::format("#compdef {}\nautoload -U +X bashcompinit && bashcompinit\n{}",
                     program.get_name(), bash_script(program));
}

}  // namespace tuina::app
