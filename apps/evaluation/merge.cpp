// SPDX-License-Identifier: Apache-2.0
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "apps/evaluation/cells.hpp"
#include "apps/evaluation/verbs.hpp"

namespace tuina::app {
namespace {

/// Joins the shards of one evaluation: the evaluation itself, with their cells in place of trials.
class Merge final : public Verb {
 public:
  [[nodiscard]] const char* name() const override { return "evaluate merge"; }
  [[nodiscard]] const char* summary() const override {
    return "the tables of an evaluation whose shards were done apart";
  }
  [[nodiscard]] const char* example() const override {
    return "for k in 1 2 3 4; do tuina evaluate massage --sessions 100 --shard $k/4 --out "
           "$k.cells; done\n"
           "  tuina evaluate merge 1.cells 2.cells 3.cells 4.cells";
  }
  void describe(Options& options) override {
    options.add("--out", out_, "the page of the tables, where the evaluation makes one by --out");
    options.add("files", files_, "files of `evaluate ... --shard K/N --out FILE`").required();
  }

  [[nodiscard]] Result<Answer> run(const CommonOptions& common) override {
    std::vector<std::string> words = {"tuina"};
    for (std::size_t i = 0; i < files_.size(); ++i) {
      const auto header = read_header(files_[i]);
      if (!header) return tl::unexpected(header.error());
      auto of_this = header->at("words").get<std::vector<std::string>>();
      if (i == 0) words.insert(words.end(), of_this.begin(), of_this.end());
      const std::vector<std::string> first(words.begin() + 1, words.end());
      if (of_this != first) {
        return fail(Fault::bad_input, "{}:1: holds cells of another command line than {}",
                    files_[i], files_[0]);
      }
    }
    for (const std::string& file : files_) {
      words.emplace_back("--merged");
      words.push_back(file);
    }
    if (!out_.empty()) words.insert(words.end(), {"--out", out_});
    if (common.json) words.emplace_back("--json");
    if (common.quiet) words.emplace_back("--quiet");
    std::vector<char*> arguments;
    arguments.reserve(words.size() + 1);
    for (std::string& word : words) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    ::execv("/proc/self/exe", arguments.data());
    return fail(Fault::device, "the evaluation cannot be begun: {}", std::strerror(errno));
  }

 private:
  std::vector<std::string> files_;
  std::string out_;
};

}  // namespace

std::unique_ptr<Verb> make_evaluate_merge() {
  return std::make_unique<Merge>();
}

}  // namespace tuina::app
