// SPDX-License-Identifier: Apache-2.0
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#ifdef TUINA_CALIBRATION
#include "apps/evaluation/scanner/synthetic_calibrations.hpp"
#endif
#include "apps/evaluation/scanner/proof.hpp"
#include "apps/evaluation/verbs.hpp"
#include "tuina/core/io/file.hpp"
#include "tuina/core/units.hpp"

namespace tuina::app {
namespace {

using nlohmann::json;

json to_json(const DepthErrors& errors) {
  return {{"rms_mm", to_mm(errors.rms_m)},
          {"systematic_mm", to_mm(errors.systematic_m)},
          {"random_mm", to_mm(errors.random_m)}};
}

json to_json(const std::vector<WallTrial>& walls) {
  json table = json::array();
  for (const WallTrial& wall : walls) {
    table.push_back({{"depth_m", wall.depth_m},
                     {"nominal", to_json(wall.nominal)},
                     {"fitted", to_json(wall.fitted)},
                     {"tuina", to_json(wall.ours)},
                     {"line_px", wall.line_px},
                     {"bound_px", wall.bound_px},
                     {"predicted_random_mm", to_mm(wall.predicted_m)}});
  }
  return table;
}

json to_json(const BackTrial& back) {
  if (back.refused) return {{"refused", true}};
  return {{"rms_mm", to_mm(back.rms_m)},
          {"expected_mm", to_mm(back.expected_m)},
          {"outliers_percent", 100.0 * back.outlier_share},
          {"seen_percent", 100.0 * back.seen_share},
          {"acupoints_covered_percent", 100.0 * back.covered_points}};
}

json to_json(const ScannerProof& proof) {
  json all = {{"people", proof.people}};
  for (const Target& target : proof.targets) {
    all["targets"].push_back({{"name", target.name},
                              {target.at_least ? "at_least" : "at_most", target.wanted},
                              {"measured", target.measured},
                              {"reached", target.reached()}});
  }
  if (!proof.walls.empty()) {
    all["figure_4_9"] = to_json(proof.walls);
    all["figure_4_9_with_speckle"] = to_json(proof.speckled_walls);
  }
  for (const auto& [name, back] : proof.backs) all["back"][name] = to_json(back);
  for (const Curve& curve : proof.curves) {
    json& points = all["curves"][curve.name] = json::array();
    for (std::size_t i = 0; i < curve.x.size(); ++i) {
      json point = to_json(curve.y[i]);
      point["x"] = curve.x[i];
      points.push_back(point);
    }
  }
  if (proof.box) {
    for (const double edge_m : proof.box->found.edges_m)
      all["box"]["edges_mm"].push_back(to_mm(edge_m));
    for (const double angle : proof.box->found.angles_rad) {
      all["box"]["angles_deg"].push_back(to_deg(angle));
    }
    all["box"]["flatness_mm"] = to_mm(proof.box->found.flatness_m);
  }
  if (proof.sphere) {
    all["sphere"] = {{"radius_mm", to_mm(0.5 * proof.sphere->found.diameter_m)},
                     {"rms_mm", to_mm(proof.sphere->found.rms_m)}};
  }
  return all;
}

std::string text_of(const ScannerProof& proof) {
  std::string text = "Simulated scanner; nothing here was measured with light.\n";
  if (!proof.walls.empty()) {
    text += fmt::format("{:>8} {:>11} {:>11} {:>9} {:>11} {:>9} {:>9} {:>11}\n", "wall, m",
                        "nominal, mm", "fitted, mm", "ours, mm", "systematic", "random", "line, px",
                        "predicted");
  }
  for (const WallTrial& wall : proof.walls) {
    text += fmt::format("{:8.2f} {:11.2f} {:11.2f} {:9.2f} {:11.2f} {:9.2f} {:9.3f} {:11.2f}\n",
                        wall.depth_m, to_mm(wall.nominal.rms_m), to_mm(wall.fitted.rms_m),
                        to_mm(wall.ours.rms_m), to_mm(wall.ours.systematic_m),
                        to_mm(wall.ours.random_m), wall.line_px, to_mm(wall.predicted_m));
  }
  const auto row = [](const std::string& name, const BackTrial& back) {
    if (back.refused) return fmt::format("{:<34} refused\n", name);
    return fmt::format("{:<34} {:8.2f} {:12.2f} {:12.3f} {:8.2f} {:10.1f}\n", name,
                       to_mm(back.rms_m), to_mm(back.expected_m), 100.0 * back.outlier_share,
                       100.0 * back.seen_share, 100.0 * back.covered_points);
  };
  if (!proof.backs.empty() || !proof.curves.empty()) {
    text += fmt::format("{:<34} {:>8} {:>12} {:>12} {:>8} {:>10}\n", "back at 1.1 m", "RMS, mm",
                        "expected, mm", "outliers, %", "seen, %", "points, %");
  }
  for (const auto& [name, back] : proof.backs) text += row(name, back);
  for (const Curve& curve : proof.curves) {
    for (std::size_t i = 0; i < curve.x.size(); ++i) {
      text += row(fmt::format("{} {}", curve.name, curve.x[i]), curve.y[i]);
    }
  }
  if (proof.box) {
    text += fmt::format(
        "box 150 x 150 x 200 mm: edges {:.2f}, {:.2f}, {:.2f} mm; angles {:.2f}, {:.2f}, {:.2f} "
        "degrees; faces flat to {:.2f} mm\n",
        to_mm(proof.box->found.edges_m[0]), to_mm(proof.box->found.edges_m[1]),
        to_mm(proof.box->found.edges_m[2]), to_deg(proof.box->found.angles_rad[0]),
        to_deg(proof.box->found.angles_rad[1]), to_deg(proof.box->found.angles_rad[2]),
        to_mm(proof.box->found.flatness_m));
  }
  if (proof.sphere) {
    text +=
        fmt::format("sphere of radius 75 mm: {:.2f} mm, round to {:.2f} mm\n",
                    to_mm(0.5 * proof.sphere->found.diameter_m), to_mm(proof.sphere->found.rms_m));
  }
  for (const Target& target : proof.targets) {
    text += fmt::format("{:<46} {:9.3f}, wanted {} {:<5} {}\n", target.name, target.measured,
                        target.at_least ? ">=" : "<=", target.wanted,
                        target.reached() ? "" : "NOT REACHED");
  }
  text.pop_back();
  return text;
}

/// Walls, backs, a box and a sphere before the simulated scanner (docs/scanner.md).
class EvaluateScanner final : public Verb {
 public:
  [[nodiscard]] const char* name() const override { return "evaluate scanner"; }
  [[nodiscard]] const char* summary() const override {
    return "walls, backs, a box and a sphere before the simulated scanner";
  }
  [[nodiscard]] const char* example() const override {
    return "tuina evaluate scanner --page scanner.html";
  }
  void describe(CLI::App& command) override {
    command.add_option("--only", only_, "one part only")
        ->check(CLI::IsMember({"walls", "backs", "curves", "bodies"}));
    command.add_option("--people", people_, "phantoms per condition")
        ->check(CLI::Range(1, 1000))
        ->capture_default_str();
    command
        .add_option("--scanners", scanners_,
                    "scanners, each built a little off its drawing and calibrated")
        ->check(CLI::Range(1, 1000))
        ->capture_default_str();
    command
        .add_option("--calibration", calibration_,
                    "rehearsed (40 poses are photographed and found again, half a minute per "
                    "scanner) or drawn (the errors that this leaves are drawn)")
        ->check(CLI::IsMember(kinds))
        ->capture_default_str();
    command.add_option("--page", page_, "one HTML page with plots and pictures");
  }

  [[nodiscard]] Result<Answer> run(const CommonOptions& common) override {
    if (const auto good = check_folder_of(page_); !good) return tl::unexpected(good.error());
    ProofOptions options{.people = people_};
    if (!only_.empty()) {
      options.walls = only_ == "walls";
      options.backs = only_ == "backs";
      options.curves = only_ == "curves";
      options.bodies = only_ == "bodies";
    }
    if (const auto built = build_scanners(common, options); !built) {
      return tl::unexpected(built.error());
    }
    const auto proof = prove_scanner(options, common.seed, progress_bar(common, "scanner"));
    if (!proof) return tl::unexpected(proof.error());
    if (!page_.empty()) {
      if (const auto written = write_file(page_, page_of(*proof)); !written) {
        return tl::unexpected(written.error());
      }
    }
    return Answer{.json = json{{"seed", common.seed}, {"scanner", to_json(*proof)}}.dump(2),
                  .text = text_of(*proof)};
  }

 private:
  Result<void> build_scanners(const CommonOptions& common, ProofOptions& options) const {
#ifdef TUINA_CALIBRATION
    if (calibration_ == "rehearsed") {
      if (options.backs || options.curves) {
        auto upright =
            rehearsed_scanners(scanners_, common.seed, true, progress_bar(common, "calibrate"));
        if (!upright) return tl::unexpected(upright.error());
        options.upright = std::move(*upright);
      }
      if (options.walls || options.backs) {
        auto across = rehearsed_scanners(scanners_, common.seed, false,
                                         progress_bar(common, "calibrate, for walls"));
        if (!across) return tl::unexpected(across.error());
        options.across = std::move(*across);
      }
      return {};
    }
#endif
    if (options.walls) options.across = drawn_scanners(scanners_, common.seed);
    return {};
  }

#ifdef TUINA_CALIBRATION
  static inline const std::vector<std::string> kinds = {"rehearsed", "drawn"};
#else
  static inline const std::vector<std::string> kinds = {"drawn"};
#endif
  std::string only_;
  std::string page_;
  std::string calibration_ = kinds.front();
  int people_ = 6;
  int scanners_ = 3;
};

}  // namespace

std::unique_ptr<Verb> make_evaluate_scanner() {
  return std::make_unique<EvaluateScanner>();
}

}  // namespace tuina::app
