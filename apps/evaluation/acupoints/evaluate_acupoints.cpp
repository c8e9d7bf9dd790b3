// SPDX-License-Identifier: Apache-2.0
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>

#include "apps/evaluation/acupoints/bad_scan_trials.hpp"
#include "apps/evaluation/acupoints/marked_people.hpp"
#include "apps/evaluation/acupoints/page.hpp"
#include "apps/evaluation/acupoints/person_fields.hpp"
#include "apps/evaluation/acupoints/scores.hpp"
#include "apps/evaluation/cells.hpp"
#include "apps/evaluation/verbs.hpp"
#include "apps/simulated/atlas_source.hpp"
#include "apps/simulated/labelled_phantom.hpp"
#include "tuina/core/io/file.hpp"

namespace tuina::app {
namespace {

constexpr int fresh_phantoms = 30;
constexpr int usual_depth_points = Scan{}.depth_points;
constexpr double share_of_learning = 0.75;  // of the time that a fold takes

/// Every method on every person of a folder, against the truth that lies beside each.
class EvaluateAcupoints final : public Verb {
 public:
  [[nodiscard]] const char* name() const override { return "evaluate acupoints"; }
  [[nodiscard]] const char* summary() const override {
    return "how far found acupoints are from the true ones";
  }
  [[nodiscard]] const char* example() const override {
    return "tuina evaluate acupoints --bodies people --scan laser --page acupoints.html\n"
           "  tuina evaluate acupoints --bodies people --folds 10";
  }
  void describe(Options& options) override {
    options.add("--bodies", bodies_,
                "labelled bodies to judge on; else 30 fresh phantoms in each position");
    options
        .add("--scan", scan_,
             "ideal; laser: through the simulated scanner and its calibration errors; depth: one "
             "picture of a depth camera (3 mm noise, 1 % holes, flying pixels, couch and floor)")
        .one_of({"ideal", "laser", "depth"})
        .show_default();
    options.add("--depth-points", depth_points_, "points of a picture, with --scan depth")
        .between(10000, 10000000)
        .show_default();
    auto atlas = options.add("--atlas", atlas_, "as for `map`; else the shipped one");
    auto train =
        options.add("--train", train_, "learn the atlas from this folder first").excludes(atlas);
    options.add("--folds", folds_, "learn from the other people of --bodies, in so many parts")
        .between(2, 100)
        .excludes(atlas)
        .excludes(train);
    options
        .add("--label-noise-mm", label_noise_mm_,
             "judge against marks of a therapist who is off by this RMS distance")
        .between(0.0, 50.0);
    options.add("--people-with-markers", marked_,
                "instead: scans NAME.ply of people with NAME.json beside them, the marks that "
                "somebody has felt (spinous_line, GV4_z_expected or L2L3_disc_z)");
    options
        .add("--bad-scans", bad_,
             "instead: rucksacks, coats, cut and bent backs, put on so many fresh phantoms in each "
             "position")
        .between(1, 1000);
    options.add("--page", page_,
                "the tables, plots and every back with its points, as one HTML file");
    cells_.describe(options);
  }

  [[nodiscard]] Result<Answer> run(const CommonOptions& common) override {
    if (const auto good = check_folder_of(page_); !good) return tl::unexpected(good.error());
    if (depth_points_ != usual_depth_points && scan_ != "depth") {
      return fail(Fault::usage, "--depth-points is for --scan depth; this is --scan {}", scan_);
    }
    if (!marked_.empty() || bad_ > 0) return judge_others(common);
    const auto config = effective_config(common);
    if (!config) return tl::unexpected(config.error());
    if (auto opened = cells_.open(common, *config); !opened) return tl::unexpected(opened.error());
    // One atlas for all is judged before anyone is drawn or read.
    std::optional<body::Atlas> one;
    if (folds_ == 0) {
      auto given = atlas_for_all(common);
      if (!given) return tl::unexpected(given.error());
      one = std::move(*given);
    }
    auto bodies = people(common);
    if (!bodies) return tl::unexpected(bodies.error());
    if (static_cast<std::size_t>(folds_) > bodies->size()) {
      return fail(Fault::usage, "--folds {}: there are {} bodies, so at most {} parts", folds_,
                  bodies->size(), bodies->size());
    }
    if (folds_ > 0) scan_everybody(*bodies, learning_seed(common), progress_bar(common, "scan"));
    const auto bar = progress_bar(common, "evaluate");
    const std::size_t folds = folds_ > 0 ? static_cast<std::size_t>(folds_) : 1;
    std::map<std::string, Score> scores;
    Times times;
    for (std::size_t fold = 0; fold < folds; ++fold) {
      const auto tell = [&](double of_fold) {
        if (bar) bar((static_cast<double>(fold) + of_fold) / static_cast<double>(folds));
      };
      std::optional<Result<body::Atlas>> learned_atlas;
      const auto atlas = [&]() -> const Result<body::Atlas>& {
        if (!learned_atlas) {
          learned_atlas =
              one ? Result<body::Atlas>(*one) : atlas_of_others(*bodies, fold, [&](double done) {
                tell(share_of_learning * done);
              });
        }
        return *learned_atlas;
      };
      const double learned = one ? 0.0 : share_of_learning;
      const std::size_t in_fold = (bodies->size() - fold + folds - 1) / folds;
      std::size_t judged = 0;
      for (std::size_t i = 0; i < bodies->size(); ++i) {
        if (folds_ > 0 && i % folds != fold) continue;
        const body::LabelledBody& person = (*bodies)[i];
        const auto marks = label_noise_mm_ > 0.0
                               ? marked(person.acupoints, label_noise_mm_, common.seed + i)
                               : person.acupoints;
        const auto done = cells_.at<PersonJudged>(
            fmt::format("{} {}", i, person.id), [&]() -> Result<PersonJudged> {
              if (!atlas()) return tl::unexpected(atlas().error());
              return judge_person(person, i, *atlas(), marks, common.seed + i);
            });
        if (!done) return tl::unexpected(done.error());
        add(*done, scores, times);
        ++judged;
        tell(learned +
             (1.0 - learned) * static_cast<double>(judged) / static_cast<double>(in_fold));
      }
    }
    return cells_.answer([&] { return answer(*bodies, scores, times); });
  }

 private:
  [[nodiscard]] PersonJudged judge_person(const body::LabelledBody& person, std::size_t index,
                                          const body::Atlas& atlas,
                                          const std::vector<Acupoint>& marks,
                                          std::uint64_t seed) const {
    std::map<std::string, Score> scores;
    PersonJudged judged;
    judge(person, index,
          see(person, {.by = parse_scan(scan_), .depth_points = depth_points_}, seed), atlas, marks,
          seed, scores, judged.times);
    for (auto& [method, score] : scores) {
      judged.findings[method] = std::move(score.findings);
      judged.compute_ms[method] = std::move(score.compute_ms);
      judged.failures[method] = std::move(score.failures);
    }
    return judged;
  }

  static void add(const PersonJudged& judged, std::map<std::string, Score>& scores, Times& times) {
    const auto append = [](auto& all, const auto& more) {
      all.insert(all.end(), more.begin(), more.end());
    };
    for (const auto& [method, findings] : judged.findings)
      append(scores[method].findings, findings);
    for (const auto& [method, ms] : judged.compute_ms) append(scores[method].compute_ms, ms);
    for (const auto& [method, failures] : judged.failures)
      append(scores[method].failures, failures);
    append(times.scan_s, judged.times.scan_s);
    append(times.map_s, judged.times.map_s);
    append(times.plan_s, judged.times.plan_s);
  }

  [[nodiscard]] Result<Answer> answer(const std::vector<body::LabelledBody>& bodies,
                                      const std::map<std::string, Score>& scores,
                                      const Times& times) const {
    nlohmann::json table = nlohmann::json::object();
    for (const char* method : acupoint_methods) table[method] = to_json(scores.at(method));
    const nlohmann::json told{{"acupoints", table},
                              {"people", bodies.size()},
                              {"scan", scan_},
                              {"label_noise_mm", label_noise_mm_},
                              {"palpated", palpated_json(scores)},
                              {"times", to_json(times)}};
    if (!page_.empty()) {
      const auto written = write_file(page_, acupoint_page(told, scores, bodies));
      if (!written) return tl::unexpected(written.error());
    }
    std::string text = fmt::format("{} people, {} scan; millimetres over the seven points\n",
                                   bodies.size(), scan_) +
                       to_text(place_table(table)) + to_text(spread_table(table)) +
                       to_text(palpated_table(scores));
    for (const char* method : acupoint_methods) {
      for (const std::string& failure : scores.at(method).failures)
        text += fmt::format("{}: {}\n", method, failure);
    }
    text.pop_back();
    return Answer{.json = told.dump(2), .text = text};
  }

  /// People whom somebody has felt, or phantoms with something on the back.
  [[nodiscard]] Result<Answer> judge_others(const CommonOptions& common) const {
    if (!bodies_.empty() || folds_ > 0 || !page_.empty() || (!marked_.empty() && bad_ > 0)) {
      return fail(Fault::usage,
                  "--people-with-markers and --bad-scans judge their own people: one of them at a "
                  "time, and without --bodies, --folds and --page");
    }
    const auto atlas = atlas_for_all(common);
    if (!atlas) return tl::unexpected(atlas.error());
    const auto bar = progress_bar(common, "evaluate");
    if (bad_ > 0) {
      const nlohmann::json judged = judge_bad_scans(bad_, common.seed, *atlas, bar);
      return Answer{.json = nlohmann::json{{"bad_scans", judged}}.dump(2),
                    .text = bad_scans_text(judged)};
    }
    const auto people = read_marked_people(marked_);
    if (!people) return tl::unexpected(people.error());
    const nlohmann::json judged = judge_marked_people(*people, *atlas, bar);
    return Answer{.json = nlohmann::json{{"marked_people", judged}}.dump(2),
                  .text = marked_people_text(judged)};
  }

  /// Nobody is judged on a scan that was learned from.
  [[nodiscard]] static std::uint64_t learning_seed(const CommonOptions& common) {
    return common.seed + 1000003;
  }

  [[nodiscard]] Result<std::vector<body::LabelledBody>> people(const CommonOptions& common) const {
    if (!bodies_.empty()) return read_labelled({bodies_});
    std::vector<body::LabelledBody> drawn;
    for (int i = 0; i < fresh_phantoms; ++i) {
      // Seeds that the shipped atlas has not drawn.
      const auto shape =
          sim::draw_phantom(common.seed * 1000000007ULL + static_cast<std::uint64_t>(i));
      for (const BodyPosture position : {BodyPosture::sitting, BodyPosture::prone}) {
        drawn.push_back(labelled(sim::make_phantom(shape, position)));
      }
    }
    return drawn;
  }

  /// The one atlas that judges everybody.
  [[nodiscard]] Result<body::Atlas> atlas_for_all(const CommonOptions& common) const {
    if (train_.empty()) return open_atlas(atlas_, progress_bar(common, "learn"));
    auto others = read_labelled({train_});
    if (!others) return tl::unexpected(others.error());
    scan_everybody(*others, learning_seed(common), progress_bar(common, "scan"));
    return body::learn_atlas(*others, nullptr, progress_bar(common, "learn"), nullptr);
  }

  [[nodiscard]] Result<body::Atlas> atlas_of_others(const std::vector<body::LabelledBody>& bodies,
                                                    std::size_t fold,
                                                    const Progress& progress) const {
    std::vector<body::LabelledBody> others;
    for (std::size_t i = 0; i < bodies.size(); ++i) {
      if (i % static_cast<std::size_t>(folds_) != fold) others.push_back(bodies[i]);
    }
    return body::learn_atlas(others, nullptr, progress, nullptr);
  }

  std::string bodies_;
  std::string scan_ = "ideal";
  int depth_points_ = usual_depth_points;
  std::string atlas_;
  std::string train_;
  int folds_ = 0;
  double label_noise_mm_ = 0.0;
  std::string marked_;
  int bad_ = 0;
  std::string page_;
  Cells cells_;
};

}  // namespace

std::unique_ptr<Verb> make_evaluate_acupoints() {
  return std::make_unique<EvaluateAcupoints>();
}

}  // namespace tuina::app
