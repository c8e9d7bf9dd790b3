// SPDX-License-Identifier: Apache-2.0
#include <nlohmann/json.hpp>

#ifdef TUINA_CALIBRATION
#include "apps/evaluation/scanner/synthetic_calibrations.hpp"
#endif
#include "apps/cli/table.hpp"
#include "apps/evaluation/scanner/light.hpp"
#include "apps/evaluation/scanner/proof.hpp"
#include "apps/evaluation/scanner/tables.hpp"
#include "apps/evaluation/verbs.hpp"
#include "tuina/core/io/file.hpp"
#include "tuina/core/units.hpp"

namespace tuina::app {
namespace {

using nlohmann::json;

json json_of(const ScannerProof& proof) {
  json all = {{"people", proof.people}};
  if (!proof.targets.empty()) all["targets"] = to_json(target_table(proof.targets));
  if (!proof.walls.empty()) {
    all["figure_4_9"] = to_json(wall_table(proof.walls));
    all["figure_4_9_with_speckle"] = to_json(wall_table(proof.speckled_walls));
  }
  if (!proof.backs.empty()) all["back"] = to_json_by_name(back_table(proof.backs));
  for (const Curve& curve : proof.curves) all["curves"][curve.name] = to_json(curve_table(curve));
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
  if (!proof.walls.empty()) text += to_text(wall_table(proof.walls));
  if (!proof.backs.empty()) text += to_text(back_table(proof.backs));
  for (const Curve& curve : proof.curves) text += to_text(curve_table(curve));
  if (proof.box) text += sentence_of(proof.box->found) + "\n";
  if (proof.sphere) text += sentence_of(proof.sphere->found) + "\n";
  if (!proof.targets.empty()) text += to_text(target_table(proof.targets));
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
  void describe(Options& options) override {
    options
        .add("--only", only_,
             "one part only; light: red and infrared side by side, which the whole has not")
        .one_of({"walls", "backs", "curves", "bodies", "light"});
    options.add("--people", people_, "phantoms per condition").between(1, 1000).show_default();
    options
        .add("--scanners", scanners_,
             "scanners, each built a little off its drawing and calibrated")
        .between(1, 1000)
        .show_default();
    options
        .add("--calibration", calibration_,
             "rehearsed (40 poses are photographed and found again, half a minute per "
             "scanner) or drawn (the errors that this leaves are drawn)")
        .one_of(kinds)
        .show_default();
    options.add("--page", page_, "one HTML page with plots and pictures");
    cells_.describe(options);
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
    const auto config = effective_config(common);
    if (!config) return tl::unexpected(config.error());
    if (auto opened = cells_.open(common, *config); !opened) return tl::unexpected(opened.error());
    if (only_ == "light") return light(common);
    options.of_walls = [&] { return built(common, Use::walls); };
    options.of_backs = [&](bool upright) {
      return built(common, upright ? Use::upright : Use::across);
    };
    const auto proof = prove_scanner(options, cells_, common.seed, progress_bar(common, "scanner"));
    if (!proof) return tl::unexpected(proof.error());
    return cells_.answer([&]() -> Result<Answer> {
      if (!page_.empty()) {
        if (const auto written = write_file(page_, page_of(*proof)); !written)
          return tl::unexpected(written.error());
      }
      return Answer{.json = json{{"seed", common.seed}, {"scanner", json_of(*proof)}}.dump(2),
                    .text = text_of(*proof)};
    });
  }

 private:
  Result<Answer> light(const CommonOptions& common) {
    CalibrateLit calibrate;
#ifdef TUINA_CALIBRATION
    if (calibration_ == "rehearsed") {
      calibrate = [&](double line_share) {
        return rehearsed_scanners(scanners_, common.seed, true, progress_bar(common, "calibrate"),
                                  line_share);
      };
    }
#endif
    const auto proof =
        prove_light(people_, calibrate, cells_, common.seed, progress_bar(common, "light"));
    if (!proof) return tl::unexpected(proof.error());
    return cells_.answer([&]() -> Result<Answer> {
      std::string text = to_text(light_table(*proof));
      json all = {{"light", to_json(light_table(*proof))}};
      if (!proof->calibrated.empty()) {
        text += to_text(lit_calibration_table(*proof));
        all["calibrated_in_light"] = to_json(lit_calibration_table(*proof));
      }
      text.pop_back();
      return Answer{.json = json{{"seed", common.seed}, {"scanner", all}}.dump(2), .text = text};
    });
  }

  enum class Use : std::uint8_t { walls, upright, across };

  /// Made when they are first asked for: a shard may need none, and a merge needs none.
  Result<std::span<const BuiltScanner>> built(const CommonOptions& common, Use use) {
    const bool upright = use == Use::upright;
    auto& scanners = upright ? upright_ : across_;
#ifdef TUINA_CALIBRATION
    if (calibration_ == "rehearsed") {
      if (scanners.empty()) {
        const char* bar = upright ? "calibrate" : "calibrate, across";
        auto made = rehearsed_scanners(scanners_, common.seed, upright, progress_bar(common, bar));
        if (!made) return tl::unexpected(made.error());
        scanners = std::move(*made);
      }
      return scanners;
    }
#endif
    if (use != Use::walls) return std::span<const BuiltScanner>();
    if (scanners.empty()) scanners = drawn_scanners(scanners_, common.seed);
    return scanners;
  }

#ifdef TUINA_CALIBRATION
  static inline const std::vector<std::string> kinds = {"rehearsed", "drawn"};
#else
  static inline const std::vector<std::string> kinds = {"drawn"};
#endif
  Cells cells_;
  std::vector<BuiltScanner> upright_, across_;
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
