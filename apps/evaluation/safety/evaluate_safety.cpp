// SPDX-License-Identifier: Apache-2.0
#include <filesystem>

#include "apps/evaluation/safety/report.hpp"
#include "apps/evaluation/verbs.hpp"
#include "tuina/core/io/file.hpp"

namespace tuina::app {
namespace {

/// The fault campaign of the guard (docs/safety.md).
class EvaluateSafety final : public Verb {
 public:
  [[nodiscard]] const char* name() const override { return "evaluate safety"; }
  [[nodiscard]] const char* summary() const override {
    return "faults of sensors, drives, clocks, controllers and people, by the true force";
  }
  [[nodiscard]] const char* example() const override {
    return "tuina evaluate safety --out campaign";
  }
  void describe(Options& options) override {
    options.flag("--full", full_,
                 "every place for every class, 3000 random trials, ten clean runs of 20 "
                 "minutes: half an hour");
    std::vector<std::string> names;
    for (const FaultClass& fault : fault_classes()) names.push_back(fault.name);
    options.add("--only", only_, "the cells of one class").one_of(names);
    options.add("--out", out_, "a folder for the page safety.html; made if need be");
  }

  [[nodiscard]] Result<Answer> run(const CommonOptions& common) override {
    if (!out_.empty()) {
      std::error_code error;
      std::filesystem::create_directories(out_, error);
      if (error) return fail(Fault::file, "the folder {}: {}", out_, error.message());
    }
    const auto campaign =
        run_campaign(campaign_order(full_, only_, common.seed), progress_bar(common, "safety"));
    if (!campaign) return tl::unexpected(campaign.error());
    if (!out_.empty()) {
      const auto page = page_of(*campaign);
      if (!page) return tl::unexpected(page.error());
      const auto path = std::filesystem::path(out_) / "safety.html";
      if (auto written = write_file(path, *page); !written) return tl::unexpected(written.error());
    }
    return Answer{.json = to_json(*campaign), .text = to_text(*campaign)};
  }

 private:
  bool full_ = false;
  std::string only_, out_;
};

}  // namespace

std::unique_ptr<Verb> make_evaluate_safety() {
  return std::make_unique<EvaluateSafety>();
}

}  // namespace tuina::app
