// SPDX-License-Identifier: Apache-2.0
#include <filesystem>

#include "apps/evaluation/safety/report.hpp"
#include "apps/evaluation/verbs.hpp"
#include "tuina/core/io/file.hpp"

namespace tuina::app {
namespace {

/// The fault campaign of the guard (docs/safety_campaign.md).
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
                 "every place for every class, 3000 random trials, 300 people, ten clean sessions "
                 "of 20 minutes: hours");
    std::vector<std::string> names;
    for (const FaultClass& fault : fault_classes()) names.push_back(fault.name);
    options.add("--only", only_, "the cells, or the search, of one class").one_of(names);
    const auto part = [&](const char* option, std::uint64_t& count, const char* what) {
      options.add(option, count, std::string("this and nothing else: ") + what).between(1, 100'000);
    };
    options.flag("--pairs", pairs_, "this and nothing else: pairs of faults within 20 ms");
    part("--random", random_, "random faults at random moments; other seeds are other trials");
    part("--clean", clean_, "whole sessions of 20 minutes without a fault");
    part("--presses", presses_, "presses of half a minute without a fault, place after place");
    part("--people", people_, "people who breathe deeply, cough and shift");
    part("--search", search_, "trials of each class that seek its largest force");
    options.add("--out", out_,
                "a folder for the page safety.html and for what a search found, worst_trials.json; "
                "made if need be");
    cells_.describe(options, &out_);
  }

  [[nodiscard]] Result<Answer> run(const CommonOptions& common) override {
    const auto config = effective_config(common);
    if (!config) return tl::unexpected(config.error());
    if (auto opened = cells_.open(common, *config); !opened) return tl::unexpected(opened.error());
    if (!out_.empty() && !cells_.sharded()) {
      std::error_code error;
      std::filesystem::create_directories(out_, error);
      if (error) return fail(Fault::file, "the folder {}: {}", out_, error.message());
    }
    CampaignOrder order = campaign_order(full_, only_, common.seed, *config);
    if (pairs_ || random_ + clean_ + presses_ + people_ + search_ > 0) {
      order.cells = false;
      order.pairs = pairs_;
      order.clean_runs = presses_;
      order.random_trials = random_;
      order.clean_sessions = clean_;
      order.people = people_;
      order.search_trials = search_;
    }
    const auto campaign = run_campaign(order, cells_, progress_bar(common, "safety"));
    if (!campaign) return tl::unexpected(campaign.error());
    return cells_.answer([&] { return answer(*campaign); });
  }

 private:
  [[nodiscard]] Result<Answer> answer(const Campaign& campaign) const {
    if (!out_.empty()) {
      const auto page = page_of(campaign);
      if (!page) return tl::unexpected(page.error());
      const auto path = std::filesystem::path(out_) / "safety.html";
      if (auto written = write_file(path, *page); !written) return tl::unexpected(written.error());
    }
    const std::string json = to_json(campaign);
    if (!out_.empty() && !campaign.worst.empty()) {
      const auto path = std::filesystem::path(out_) / "worst_trials.json";
      if (auto written = write_file(path, to_json(campaign.worst) + "\n"); !written)
        return tl::unexpected(written.error());
    }
    return Answer{.json = json, .text = to_text(campaign)};
  }

  bool full_ = false, pairs_ = false;
  std::uint64_t random_ = 0, clean_ = 0, presses_ = 0, people_ = 0, search_ = 0;
  std::string only_, out_;
  Cells cells_;
};

}  // namespace

std::unique_ptr<Verb> make_evaluate_safety() {
  return std::make_unique<EvaluateSafety>();
}

}  // namespace tuina::app
