// SPDX-License-Identifier: Apache-2.0
#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>

#include "apps/tuina/atlas_source.hpp"
#include "apps/tuina/labelled_phantom.hpp"
#include "apps/tuina/verbs.hpp"
#include "tuina/body/baselines.hpp"
#include "tuina/core/units.hpp"
#include "tuina/scanner/sweep.hpp"
#include "tuina/sim/laser_scanner.hpp"

namespace tuina::app {
namespace {

constexpr std::array<const char*, 4> methods = {"field_morphing", "surface", "rigid_icp", "axis_scaling"};
constexpr int fresh_phantoms = 30;

/// One acupoint of one person found by one method.
struct Finding {
  std::string type, position, point;
  double error_mm = 0.0;
  double uncertainty_mm = 0.0;
  bool of_the_seven = false;
};

struct Score {
  std::vector<Finding> findings;
  std::vector<double> compute_ms;
  std::vector<std::string> failures;
};

double mean_of(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double value : values) sum += value;
  return values.empty() ? 0.0 : sum / static_cast<double>(values.size());
}

double quantile_of(std::vector<double> values, double share) {
  if (values.empty()) return 0.0;
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(share * static_cast<double>(values.size() - 1) + 0.5)];
}

nlohmann::json summary(const std::vector<double>& errors) {
  const double mean = mean_of(errors);
  double squared = 0.0;
  for (const double error : errors) squared += (error - mean) * (error - mean);
  return {{"mean_mm", mean},
          {"sd_mm", errors.empty() ? 0.0 : std::sqrt(squared / static_cast<double>(errors.size()))},
          {"p95_mm", quantile_of(errors, 0.95)},
          {"max_mm", quantile_of(errors, 1.0)}};
}

template <typename Chosen>
std::vector<double> errors_of(const Score& score, const Chosen& chosen) {
  std::vector<double> errors;
  for (const Finding& finding : score.findings) {
    if (chosen(finding)) errors.push_back(finding.error_mm);
  }
  return errors;
}

/// Every method on every person of a folder, against the truth that lies beside each.
class EvaluateAcupoints final : public Verb {
 public:
  [[nodiscard]] const char* name() const override { return "evaluate acupoints"; }
  [[nodiscard]] const char* summary() const override { return "how far found acupoints are from the true ones"; }
  [[nodiscard]] const char* example() const override {
    return "tuina evaluate acupoints --bodies people --scan laser\n"
           "  tuina evaluate acupoints --bodies people --train others";
  }
  void describe(CLI::App& command) override {
    command.add_option("--bodies", bodies_, "labelled bodies to judge on; else 30 fresh phantoms in each position");
    command.add_option("--scan", scan_, "ideal, or laser: through the simulated scanner and its calibration errors")
        ->check(CLI::IsMember({"ideal", "laser"}))
        ->capture_default_str();
    auto* atlas = command.add_option("--atlas", atlas_, "as for `map`; else the shipped one");
    auto* train = command.add_option("--train", train_, "learn the atlas from this folder first")->excludes(atlas);
    command.add_option("--folds", folds_, "learn from the other people of --bodies, in so many parts")
        ->check(number_between(2, 100))
        ->excludes(atlas)
        ->excludes(train);
  }

  [[nodiscard]] Result<Answer> run(const CommonOptions& common) override {
    // One atlas for all is judged before anyone is drawn or read.
    std::optional<body::Atlas> one;
    if (folds_ == 0) {
      auto given = atlas_for({}, 0);
      if (!given) return tl::unexpected(given.error());
      one = std::move(*given);
    }
    auto bodies = people(common);
    if (!bodies) return tl::unexpected(bodies.error());
    const auto bar = progress_bar(common, "evaluate");
    const std::size_t folds = folds_ > 0 ? static_cast<std::size_t>(folds_) : 1;
    std::map<std::string, Score> scores;
    std::size_t done = 0;
    for (std::size_t fold = 0; fold < folds; ++fold) {
      const auto atlas = one ? Result<body::Atlas>(*one) : atlas_for(*bodies, fold);
      if (!atlas) return tl::unexpected(atlas.error());
      for (std::size_t i = 0; i < bodies->size(); ++i) {
        if (folds_ > 0 && i % folds != fold) continue;
        judge((*bodies)[i], *atlas, common.seed + i, scores);
        if (bar) bar(static_cast<double>(++done) / static_cast<double>(bodies->size()));
      }
    }
    return answer(scores, bodies->size());
  }

 private:
  [[nodiscard]] Result<std::vector<body::LabelledBody>> people(const CommonOptions& common) const {
    if (!bodies_.empty()) return read_labelled({bodies_});
    std::vector<body::LabelledBody> drawn;
    for (int i = 0; i < fresh_phantoms; ++i) {
      // Seeds that the shipped atlas has not drawn.
      const auto shape = sim::draw_phantom(common.seed * 1000000007ULL + static_cast<std::uint64_t>(i));
      for (const Position position : {Position::sitting, Position::prone}) {
        drawn.push_back(labelled(sim::make_phantom(shape, position)));
      }
    }
    return drawn;
  }

  [[nodiscard]] Result<body::Atlas> atlas_for(const std::vector<body::LabelledBody>& bodies, std::size_t fold) const {
    if (!train_.empty()) {
      const auto others = read_labelled({train_});
      if (!others) return tl::unexpected(others.error());
      return body::learn_atlas(*others, nullptr, {}, nullptr);
    }
    if (folds_ == 0) return open_atlas(atlas_);
    std::vector<body::LabelledBody> others;
    for (std::size_t i = 0; i < bodies.size(); ++i) {
      if (i % static_cast<std::size_t>(folds_) != fold) others.push_back(bodies[i]);
    }
    return body::learn_atlas(others, nullptr, {}, nullptr);
  }

  [[nodiscard]] Result<PointCloud> scan_of(const body::LabelledBody& person, std::uint64_t seed) const {
    if (scan_ == "ideal") return body::sample(person.skin_in_couch, 4_mm);
    sim::LaserScanner scanner(person.skin_in_couch, person.position, {}, seed);
    const auto calibration = sim::believed_calibration(scanner.true_calibration(), seed);
    auto scan = scanner::scan_sweep(scanner, scanner, calibration);
    if (!scan) return tl::unexpected(scan.error());
    return std::move(scan->cloud_in_couch);
  }

  void judge(const body::LabelledBody& person, const body::Atlas& atlas, std::uint64_t seed,
             std::map<std::string, Score>& scores) const {
    const auto scan = scan_of(person, seed);
    for (const char* method : methods) {
      Score& score = scores[method];
      const auto start = std::chrono::steady_clock::now();
      auto found = scan ? map(*scan, atlas, method) : Result<body::Mapping>(tl::unexpected(scan.error()));
      score.compute_ms.push_back(
          std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count());
      if (!found) {
        score.failures.push_back(fmt::format("{}: {}", person.id, found.error().message));
        continue;
      }
      for (const Acupoint& truth : person.acupoints) {
        for (const Acupoint& point : found->acupoints) {
          if (point.name != truth.name) continue;
          const bool seven = std::find(seven_acupoints.begin(), seven_acupoints.end(), truth.name) != seven_acupoints.end();
          score.findings.push_back({person.body_type, name_of(person.position), truth.name,
                                    to_mm((point.at_in_couch - truth.at_in_couch).norm()), to_mm(point.uncertainty_m), seven});
        }
      }
    }
  }

  static Result<body::Mapping> map(const PointCloud& scan, const body::Atlas& atlas, std::string_view method) {
    const auto back = body::fit_back(scan);
    if (!back) return tl::unexpected(back.error());
    if (method == "rigid_icp") return body::rigid_icp(*back, atlas);
    if (method == "axis_scaling") return body::scale_axes(*back, atlas);
    return body::locate_acupoints(*back, atlas, *body::parse_method(method));
  }

  [[nodiscard]] Result<Answer> answer(const std::map<std::string, Score>& scores, std::size_t people) const {
    nlohmann::json table = nlohmann::json::object();
    std::string text = fmt::format("{} people, {} scan; millimetres over the seven points\n{:<15} {:>8} {:>6} {:>6} {:>6} {:>6} {:>6} {:>6} {:>6} {:>5} {:>8} {:>6}",
                                   people, scan_, "", "sitting", "prone", "p95", "max", "slim", "medium", "hefty", "all 27",
                                   "95 %", "failures", "ms");
    for (const char* method : methods) {
      const Score& score = scores.at(method);
      const auto seven = [](const Finding& f) { return f.of_the_seven; };
      nlohmann::json row = tuina::app::summary(errors_of(score, seven));
      for (const char* position : {"sitting", "prone"}) {
        row["by_position"][position] = tuina::app::summary(
            errors_of(score, [&](const Finding& f) { return f.of_the_seven && f.position == position; }));
      }
      for (const char* type : {"slim", "medium", "hefty"}) {
        row["by_type"][type] = tuina::app::summary(
            errors_of(score, [&](const Finding& f) { return f.of_the_seven && f.type == type; }));
      }
      for (const char* point : seven_acupoints) {
        row["by_point"][point] = tuina::app::summary(errors_of(score, [&](const Finding& f) { return f.point == point; }));
      }
      row["all_points"] = tuina::app::summary(errors_of(score, [](const Finding&) { return true; }));
      double covered = 0.0;
      double counted = 0.0;
      for (const Finding& finding : score.findings) {
        if (!finding.of_the_seven) continue;
        counted += 1.0;
        covered += finding.error_mm <= finding.uncertainty_mm ? 1.0 : 0.0;
      }
      row["coverage"] = counted > 0.0 ? covered / counted : 0.0;
      row["failures"] = score.failures.size();
      row["failed"] = score.failures;
      row["compute_ms_median"] = quantile_of(score.compute_ms, 0.5);
      const auto shown = [&](const char* group, const char* key) { return row[group][key]["mean_mm"].get<double>(); };
      text += fmt::format("\n{:<15} {:8.1f} {:6.1f} {:6.1f} {:6.1f} {:6.1f} {:6.1f} {:6.1f} {:6.1f} {:5.0f} {:8} {:6.0f}", method,
                          shown("by_position", "sitting"), shown("by_position", "prone"), row["p95_mm"].get<double>(),
                          row["max_mm"].get<double>(), shown("by_type", "slim"), shown("by_type", "medium"),
                          shown("by_type", "hefty"), row["all_points"]["mean_mm"].get<double>(),
                          100.0 * row["coverage"].get<double>(), score.failures.size(),
                          row["compute_ms_median"].get<double>());
      for (const auto& failure : score.failures) text += fmt::format("\n  {}", failure);
      table[method] = row;
    }
    return Answer{.json = nlohmann::json{{"acupoints", table}, {"people", people}, {"scan", scan_}}.dump(2), .text = text};
  }

  std::string bodies_;
  std::string scan_ = "ideal";
  std::string atlas_;
  std::string train_;
  int folds_ = 0;
};

}  // namespace

std::unique_ptr<Verb> make_evaluate_acupoints() { return std::make_unique<EvaluateAcupoints>(); }

}  // namespace tuina::app
