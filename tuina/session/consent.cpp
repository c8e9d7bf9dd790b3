// SPDX-License-Identifier: Apache-2.0
#include "tuina/session/consent.hpp"

#include <vector>

#include "tuina/core/io/file.hpp"
#include "tuina/core/io/text_lines.hpp"
#include "tuina/core/io/toml_reader.hpp"

namespace tuina::session {

Result<Consent> parse_consent(std::string_view text, std::string_view name) {
  Consent consent;
  std::vector<std::string> refusals;
  const auto read = read_toml(text, name, Fault::config, [&](const TomlTable& root) {
    root.only({}, {"answered_by", "answers"});
    consent.answered_by = root.text("answered_by").value_or("");
    if (root.has("answered_by") && only_white_space(consent.answered_by)) {
      root.reject("answered_by", "answered_by is empty");
    }
    const auto answers = root.table("answers");
    if (!answers) return;
    TomlTable::Words keys;
    for (const HealthQuestion& question : health_questions) {
      keys.emplace_back(question.key);
      const auto answer = answers->text(question.key);
      if (!answers->has(question.key)) {
        answers->reject(question.key,
                        fmt::format("`{}` is not answered: {}?", question.key, question.text));
      } else if (answer == "yes" || answer == "unknown") {
        refusals.push_back(fmt::format("{}{} = \"{}\": {}", answers->at(question.key), question.key,
                                       *answer, question.text));
      } else if (answer && answer != "no") {
        answers->wrong(question.key, "is not \"yes\", \"no\" or \"unknown\"");
      }
    }
    answers->only(keys);
  });
  if (!read) return tl::unexpected(read.error());
  if (!refusals.empty()) {
    constexpr std::size_t max_letters = 200;  // the last line must be read, too
    return fail(Fault::stopped, "{}\nno massage is given; ask a physician",
                listed(refusals, "\n", max_letters));
  }
  return consent;
}

Result<Consent> read_consent(const std::filesystem::path& file) {
  constexpr std::size_t max_bytes = 1 << 20;
  const auto text = read_file(file, max_bytes);
  if (!text) return tl::unexpected(text.error());
  return parse_consent(*text, file.string());
}

std::string consent_form(std::string_view answered_by, std::string_view answer) {
  std::string form =
      fmt::format("answered_by = {}\n\n[answers]  # \"yes\", \"no\" or \"unknown\"\n",
                  toml_string(answered_by));
  for (const HealthQuestion& question : health_questions) {
    form += fmt::format("{} = \"{}\"  # {}\n", question.key, answer, question.text);
  }
  return form;
}

}  // namespace tuina::session
