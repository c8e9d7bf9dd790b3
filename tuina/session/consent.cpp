// SPDX-License-Identifier: Apache-2.0
#include "tuina/session/consent.hpp"

#include <fmt/ranges.h>

#include <toml++/toml.h>
#include <algorithm>
#include <vector>

#include "tuina/core/file.hpp"
#include "tuina/core/near_miss.hpp"

namespace tuina::session {
namespace {

using Words = std::vector<std::string>;

std::string at(std::string_view file, const toml::node& node) {
  return fmt::format("{}:{}: ", file, node.source().begin.line);
}

/// What is wrong with the answers, and what they rule out.
void judge(const toml::table& answers, std::string_view file, Words& faults, Words& refusals) {
  Words keys;
  for (const HealthQuestion& question : health_questions) {
    keys.emplace_back(question.key);
    const toml::node* node = answers.get(question.key);
    if (node == nullptr) {
      faults.push_back(at(file, answers) +
                       fmt::format("`{}` is not answered: {}?", question.key, question.text));
      continue;
    }
    const std::string answer = node->value_or<std::string>("");
    if (answer == "yes" || answer == "unknown") {
      refusals.push_back(at(file, *node) +
                         fmt::format("{} = \"{}\": {}", question.key, answer, question.text));
    } else if (answer != "no") {
      faults.push_back(at(file, *node) +
                       fmt::format("{} is not \"yes\", \"no\" or \"unknown\"", question.key));
    }
  }
  for (const auto& [key, node] : answers) {
    if (std::find(keys.begin(), keys.end(), key.str()) != keys.end()) continue;
    faults.push_back(at(file, node) + fmt::format("no question is called `{}`; {}", key.str(),
                                                  suggestion(key.str(), keys)));
  }
}

}  // namespace

Result<Consent> parse_consent(std::string_view text, std::string_view name) {
  try {
    const toml::table table = toml::parse(text, std::string(name));
    Words faults, refusals;
    Consent consent{.answered_by = table["answered_by"].value_or("")};
    if (consent.answered_by.empty()) faults.push_back(at(name, table) + "answered_by is missing");
    for (const auto& [key, node] : table) {
      if (key.str() != "answered_by" && key.str() != "answers") {
        faults.push_back(at(name, node) + fmt::format("`{}` is unknown; answered_by and [answers] "
                                                      "are known",
                                                      key.str()));
      }
    }
    const toml::table* answers = table["answers"].as_table();
    if (answers == nullptr) {
      faults.push_back(at(name, table) + "the table [answers] is missing");
    } else {
      judge(*answers, name, faults, refusals);
    }
    if (!faults.empty()) return fail(Fault::config, "{}", fmt::join(faults, "\n"));
    if (!refusals.empty()) {
      return fail(Fault::stopped, "{}\nno massage is given; ask a physician",
                  fmt::join(refusals, "\n"));
    }
    return consent;
  } catch (const toml::parse_error& error) {
    return fail(Fault::config, "{}:{}: {}", name, error.source().begin.line, error.description());
  }
}

Result<Consent> read_consent(const std::filesystem::path& file) {
  constexpr std::size_t largest_bytes = 1 << 20;
  const auto text = read_file(file, largest_bytes);
  if (!text) return tl::unexpected(text.error());
  return parse_consent(*text, file.string());
}

std::string consent_form(std::string_view answered_by, std::string_view answer) {
  std::string form = fmt::format(
      "answered_by = \"{}\"\n\n[answers]  # \"yes\", \"no\" or \"unknown\"\n", answered_by);
  for (const HealthQuestion& question : health_questions) {
    form += fmt::format("{} = \"{}\"  # {}\n", question.key, answer, question.text);
  }
  return form;
}

}  // namespace tuina::session
