// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "apps/evaluation/verbs.hpp"

namespace tuina::app {
namespace {

/// Every table of the documentation in one go, each as its own verb makes it by default.
class EvaluateAll final : public Verb {
 public:
  [[nodiscard]] const char* name() const override { return "evaluate all"; }
  [[nodiscard]] const char* summary() const override {
    return "every table, one after the other, each by default; this takes long";
  }
  [[nodiscard]] const char* example() const override {
    return "tuina evaluate all --json > tables.json";
  }
  void describe(Options&) override {}

  [[nodiscard]] Result<Answer> run(const CommonOptions& common) override {
    nlohmann::ordered_json all;
    Answer answer;
    for (const std::unique_ptr<Verb>& verb : make_evaluations()) {
      const std::string part = verb->name();
      const bool needs_a_folder = part == "evaluate atlas";  // of labelled people
      const bool joins_others = part == "evaluate merge";
      if (!part.starts_with("evaluate ") || part == name() || needs_a_folder || joins_others)
        continue;
      const auto found = verb->run(common);
      if (!found) return fail(found.error().fault, "{}: {}", part, found.error().message);
      // Each verb's tables stand under a key of their own name; the campaign has no such key.
      const auto tables = nlohmann::ordered_json::parse(found->json);
      if (part == "evaluate safety") {
        all["safety"] = tables;
      } else {
        all.update(tables);
      }
      answer.text += fmt::format("== {}\n{}\n\n", part, found->text);
      answer.exit_code = std::max(answer.exit_code, found->exit_code);
    }
    answer.json = all.dump(2);
    return answer;
  }
};

}  // namespace

std::unique_ptr<Verb> make_evaluate_all() {
  return std::make_unique<EvaluateAll>();
}

}  // namespace tuina::app
