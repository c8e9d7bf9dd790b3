// SPDX-License-Identifier: Apache-2.0
#include "apps/cli/program.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <map>

#include "apps/cli/kept_inputs.hpp"
#include "apps/cli/manual.hpp"
#include "apps/cli/say.hpp"
#include "tuina/core/io/file.hpp"
#include "tuina/core/io/near_miss.hpp"
#include "tuina/core/io/text_lines.hpp"
#include "tuina/session/config.hpp"

namespace tuina::app {
namespace {

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

// The parser alone would take a number that does not fit as the largest one that does.
std::string whole_number(const std::string& text) {
  if (to_number<std::uint64_t>(text)) return {};
  return fmt::format("{} is not a whole number from 0 to {}", in_quotes(text), UINT64_MAX);
}

void add_common_options(CLI::App& command, CommonOptions& common) {
  if (command.get_option_no_throw("--out") == nullptr) {
    command.add_option("--out", common.out, "write the JSON object to this file");
  }
  command.add_flag("--json", common.json, "write one JSON object to stdout and nothing else there");
  command.add_flag("--quiet", common.quiet, "no text and no progress bar");
  command.add_option("--seed", common.seed, "same seed, same result")
      ->check(whole_number)
      ->capture_default_str();
  command.add_option("--config", common.config_file, "a TOML file; see `tuina config show`");
  command.add_option("--set", common.settings, "section.key=value, over the file")
      ->allow_extra_args(false);
}

/// An empty word is a slip, such as a shell variable without a value, and never means "none".
void refuse_empty_words(CLI::App& command) {
  for (CLI::Option* option : command.get_options()) {
    if (option->get_items_expected_max() == 0) continue;
    option->check([](const std::string& word) {
      return word.empty() ? "is empty; a value is needed, or leave it away" : std::string();
    });
  }
}

/// At most 300 letters of what is printed with a message: of a list of faults the first ones, of a
/// sentence its two ends.
std::string brief(const std::string& message) {
  constexpr std::size_t max_letters = 300 - std::string_view("tuina: \nSee `tuina --help`.").size();
  constexpr std::size_t end_letters = 100;
  if (message.size() <= max_letters) return message;
  std::vector<std::string> lines;
  TextLines text(message);
  while (const auto line = text.next()) lines.emplace_back(*line);
  constexpr std::string_view more = "\nand 9999 more";
  std::string first = listed(lines, "\n", max_letters - more.size());
  if (first.size() <= max_letters) return first;
  // Whole words, where there are any.
  constexpr std::string_view gap = " ... ";
  std::string head = message.substr(0, max_letters - end_letters - gap.size());
  std::string tail = message.substr(message.size() - end_letters);
  const auto last_space = head.rfind(' ');
  if (last_space != std::string::npos && last_space > head.size() / 2) head.resize(last_space);
  if (const auto space = tail.find(' '); space < tail.size() / 2) tail.erase(0, space + 1);
  return head + std::string(gap) + tail;
}

int explain(const Error& error) {
  say(fmt::format("tuina: {}\n", brief(error.message)));
  return exit_code_of(error.fault);
}

// A full disk behind stdout shows itself only when the buffer is flushed.
Result<void> print(const std::string& text) {
  if (text.empty()) return {};
  const bool put = std::fwrite(text.data(), 1, text.size(), stdout) == text.size();
  if (std::fflush(stdout) == 0 && put) return {};
  return fail(Fault::file, "stdout: cannot be written: {}", std::strerror(errno));
}

// What a verb could not foresee, memory first of all, still ends in one line.
Result<Answer> run(Verb& verb, const CommonOptions& common) {
  try {
    // Whoever misspells a setting is told so by verbs, too, that need none.
    if (const auto read = effective_config(common); !read) return tl::unexpected(read.error());
    return verb.run(common);
  } catch (const std::bad_alloc&) {
    return fail(Fault::bad_input, "{}: there is not enough memory for this input", verb.name());
  } catch (const std::filesystem::filesystem_error& error) {
    return fail(Fault::file, "{}: {}", error.path1().string(), error.code().message());
  } catch (const std::exception&) {
    return fail(Fault::bad_input, "{}: an input holds what this verb does not foresee",
                verb.name());
  }
}

int show(const Result<Answer>& answer, const CommonOptions& common) {
  if (!answer) return explain(answer.error());
  if (!common.out.empty()) {
    if (const auto written = write_file(common.out, answer->json + "\n"); !written)
      return explain(written.error());
  }
  std::string product = common.quiet ? std::string() : answer->product;
  if (common.json) product = answer->json + "\n";
  if (const auto told = print(product); !told) return explain(told.error());
  if (!common.quiet && !answer->text.empty()) say(fmt::format("{}\n", answer->text));
  return answer->exit_code;
}

/// Verbs as commands of the parser, and which verb each command is.
std::map<const CLI::App*, Verb*> add_verbs(CLI::App& tuina, const Program& program,
                                           CommonOptions& common) {
  std::map<const CLI::App*, Verb*> verb_of;
  std::map<std::string, CLI::App*> groups;
  for (const auto& verb : program.verbs) {
    // A name of two words is a verb within a group: `tissue fit`.
    CLI::App* parent = &tuina;
    std::string name = verb->name();
    if (const auto space = name.find(' '); space != std::string::npos) {
      const std::string group = name.substr(0, space);
      CLI::App*& known = groups[group];
      if (known == nullptr) {
        known = tuina.add_subcommand(group, program.summary_of_group(group));
        known->require_subcommand(0, 1);
      }
      parent = known;
      name = name.substr(space + 1);
    }
    CLI::App* command = parent->add_subcommand(name, verb->summary());
    if (const std::string alias = verb->alias(); !alias.empty()) command->alias(alias);
    command->footer(fmt::format("Example:\n  {}", verb->example()));
    Options options(*command);
    verb->describe(options);
    add_common_options(*command, common);
    refuse_empty_words(*command);
    verb_of[command] = verb.get();
  }
  return verb_of;
}

/// The deepest verb or group that the command line named.
const CLI::App& chosen_by(const CLI::App& tuina) {
  const CLI::App* chosen = &tuina;
  while (!chosen->get_subcommands().empty()) chosen = chosen->get_subcommands().front();
  return *chosen;
}

std::string help_of(const CLI::App& command) {
  std::string before;
  for (const CLI::App* parent = command.get_parent(); parent; parent = parent->get_parent()) {
    before.insert(0, parent->get_name() + (before.empty() ? "" : " "));
  }
  return command.help(before);
}

/// What is said of words that no verb and no option took; an option among them may be a slip.
std::string refusal_of_words(const CLI::App& chosen, const std::vector<std::string>& words) {
  std::string refusal = "nothing here takes " + listed(words, " ", 150);
  const auto slip = std::find_if(words.begin(), words.end(),
                                 [](const std::string& word) { return word.starts_with("--"); });
  if (slip == words.end()) return refusal;
  const std::string name = slip->substr(0, slip->find('='));
  std::vector<std::string> options;
  for (const CLI::Option* option : chosen.get_options())
    if (!option->get_positional()) options.push_back(option->get_name());
  return fmt::format("{}; {}", refusal, suggestion(name, options));
}

/// --help comes before the parser complains of words that nothing took; so documents can be held to
/// the program by it. Gives the exit code.
int refuse_unknown(const CLI::App& tuina) {
  const std::vector<std::string> words = tuina.remaining(true);
  if (words.empty()) return 0;
  say(fmt::format("tuina: {}\n", refusal_of_words(chosen_by(tuina), words)));
  return 1;
}

/// What is wrong with the words; a first one that is no verb may be a slip.
std::string refusal_of(const CLI::App& tuina, const std::string& first,
                       const CLI::ParseError& error) {
  std::vector<std::string> verbs;
  for (const CLI::App* verb : tuina.get_subcommands(nullptr)) {
    verbs.push_back(verb->get_name());
    verbs.insert(verbs.end(), verb->get_aliases().begin(), verb->get_aliases().end());
  }
  if (first.starts_with('-') || std::find(verbs.begin(), verbs.end(), first) != verbs.end()) {
    // An option that is lacking may be there misspelled.
    const std::vector<std::string> words = tuina.remaining(true);
    const bool lacks = dynamic_cast<const CLI::RequiredError*>(&error) != nullptr ||
                       dynamic_cast<const CLI::ExtrasError*>(&error) != nullptr;
    // "--out: At Most 1 required but received 2", of an option that is given twice.
    const std::string said = error.what();
    constexpr std::string_view too_many = ": At Most 1 required but received ";
    if (const auto at = said.find(too_many); at != std::string::npos)
      return brief(fmt::format("{} is given {} times; once is right", said.substr(0, at),
                               said.substr(at + too_many.size())));
    return brief(lacks && !words.empty() ? refusal_of_words(chosen_by(tuina), words) : said);
  }
  return brief(fmt::format("there is no verb `{}`; {}", first, suggestion(first, verbs)));
}

/// This process becomes another program, with the same words.
int become(const ProgramBeside& other, char** argv) {
  const std::string path = program_beside(other.program);
  execv(path.c_str(), argv);
  return explain(Error{
      Fault::usage,
      fmt::format("`{}` belongs to the program {}, which ./run build makes", other.verb, path)});
}

/// A file that is opened while stderr is closed would get its number, and with it all that is said.
void open_what_is_closed() {
  for (const int standard : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
    if (::fcntl(standard, F_GETFD) < 0) (void)::open("/dev/null", O_RDWR);
}

}  // namespace

std::string program_beside(const std::string& name) {
  return (std::filesystem::read_symlink("/proc/self/exe").parent_path() / name).string();
}

int run_program(int argc, char** argv, const Program& program) {
  open_what_is_closed();
  for (const ProgramBeside& other : program.beside)
    if (argc > 1 && std::string_view(argv[1]) == other.verb) return become(other, argv);
  CLI::App tuina("tuina: a robot massages a person, here in simulation.", "tuina");
  tuina.set_version_flag("--version", TUINA_VERSION);
  tuina.require_subcommand(0, 1);
  tuina.footer("Exit codes: 0 done, 1 wrong use, 2 bad input, 3 device, 4 stopped for safety.");

  CommonOptions common;
  std::string shell;
  const auto verb_of = add_verbs(tuina, program, common);
  for (const ProgramBeside& other : program.beside) tuina.add_subcommand(other.verb, other.summary);
  CLI::App* completion = tuina.add_subcommand("completion", "a script by which a shell completes");
  completion->add_option("shell", shell, "bash, zsh or fish")
      ->required()
      ->check(CLI::IsMember({"bash", "zsh", "fish"}));
  completion->footer("Example:\n  source <(tuina completion bash)");
  CLI::App* manual = tuina.add_subcommand("manual", "this help as a page for man(1)");
  manual->footer("Example:\n  tuina manual > tuina.1");

  try {
    tuina.parse(argc, argv);
  } catch (const CLI::CallForHelp&) {
    if (const int refused = refuse_unknown(tuina); refused != 0) return refused;
    const auto told = print(help_of(chosen_by(tuina)));
    return told ? 0 : explain(told.error());
  } catch (const CLI::CallForVersion&) {
    const auto told = print(fmt::format("tuina {}\n", TUINA_VERSION));
    return told ? 0 : explain(told.error());
  } catch (const CLI::ParseError& error) {
    say(fmt::format("tuina: {}\nSee `tuina --help`.\n", refusal_of(tuina, argv[1], error)));
    return 1;
  }

  const CLI::App& chosen = chosen_by(tuina);
  if (&chosen == completion || &chosen == manual) {
    const auto told = print(&chosen == manual ? manual_page(tuina, TUINA_VERSION)
                                              : completion_script(tuina, shell));
    return told ? 0 : explain(told.error());
  }
  const auto found = verb_of.find(&chosen);
  if (found == verb_of.end()) {
    say(help_of(chosen));
    return 1;
  }
  if (const auto good = check_folder_of(common.out); !good) return explain(good.error());
  if (const auto kept = check_not_onto_inputs(chosen); !kept) return explain(kept.error());
  return show(run(*found->second, common), common);
}

}  // namespace tuina::app
