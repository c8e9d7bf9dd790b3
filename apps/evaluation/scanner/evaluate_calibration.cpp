// SPDX-License-Identifier: Apache-2.0
#include <unistd.h>

#include <array>
#include <cmath>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <span>

#include "apps/cli/table.hpp"
#include "apps/evaluation/cells.hpp"
#include "apps/evaluation/verbs.hpp"
#include "tuina/calibration/calibrate.hpp"
#include "tuina/core/random.hpp"
#include "tuina/core/units.hpp"
#include "tuina/sim/scanner/laser_scanner.hpp"
#include "tuina/sim/scanner/synthetic_shots.hpp"

namespace tuina::app {
namespace {

namespace fs = std::filesystem;
using namespace calibration;

constexpr double added_px = 0.1;
// Most of an error of range is that of the focal length alone, so one set says little of how large
// it is usually. Pictures are dear, noise is not.
constexpr int draws_of_noise = 3;

/// A true error and what was stated of it, over many sets and draws of noise.
struct CalibrationErrors {
  double sum = 0.0;
  double true2 = 0.0;
  double stated2 = 0.0;
  int sets = 0;
  void add(double error, double stated) {
    sum += error;
    true2 += error * error;
    stated2 += stated * stated;
    ++sets;
  }
};

/// What one set says: of each table and quantity an error and what was stated of it, again and
/// again.
struct SetErrors {
  std::map<std::string, std::map<std::string, std::vector<double>>> values;

  void add(const std::string& table, const std::string& quantity, double error, double stated) {
    auto& of = values[table][quantity];
    of.insert(of.end(), {error, stated});
  }
};

template <typename Outcome, typename Visit>
requires std::is_same_v<std::remove_const_t<Outcome>, SetErrors>
void visit_fields(Outcome& set, const Visit& visit) {
  visit("values", set.values);
}

telemetry::Table error_table(const std::string& name,
                             const std::map<std::string, CalibrationErrors>& quantities) {
  telemetry::Table table{.title = name,
                         .columns = {{.head = "error"},
                                     {.head = "mean", .key = "mean", .digits = 3},
                                     {.head = "rms", .key = "rms", .digits = 3},
                                     {.head = "stated", .key = "stated", .digits = 3},
                                     {.head = "ratio", .key = "rms_over_stated", .digits = 2}}};
  for (const auto& [quantity, e] : quantities) {
    table.add({quantity, e.sum / e.sets, std::sqrt(e.true2 / e.sets), std::sqrt(e.stated2 / e.sets),
               e.stated2 > 0.0 ? std::sqrt(e.true2 / e.stated2) : 0.0});
  }
  return table;
}

struct Case {
  int poses;
  bool noise;
  [[nodiscard]] std::string name() const {
    return fmt::format("{} poses, {}", poses, noise ? "0.1 px of noise added" : "clean");
  }
};

// As many of the held poses as the case wants, spread over the range, and every standing board.
Views some_of(const Views& all, const Case& wanted, int held, std::uint64_t seed, int draw) {
  Views views = all;
  std::erase_if(views.views, [&](const View& view) {
    const bool chosen = view.pose * wanted.poses / held != (view.pose - 1) * wanted.poses / held;
    return view.pose > 0 && view.pose < held && !chosen;
  });
  if (!wanted.noise) return views;
  Random random = make_random(seed, fmt::format("noise of corners and line {}", draw));
  for (View& view : views.views) {
    for (Vector2& corner : view.corners_px) {
      corner += Vector2(gaussian(random, added_px), gaussian(random, added_px));
    }
    for (auto& point : view.line) point.column_px += static_cast<float>(gaussian(random, added_px));
  }
  return views;
}

/// How far rehearsed calibrations are from the truth, and from what they say of themselves.
class EvaluateCalibration final : public Verb {
 public:
  [[nodiscard]] const char* name() const override { return "evaluate calibration"; }
  [[nodiscard]] const char* summary() const override {
    return "rehearsed calibrations against the truth: 20 and 40 poses, clean and with noise";
  }
  [[nodiscard]] const char* example() const override {
    return "tuina evaluate calibration --sets 10";
  }
  void describe(Options& options) override {
    options.add("--sets", sets_, "rehearsed sets, each with a scanner of its own")
        .between(1, 1000)
        .show_default();
    cells_.describe(options);
  }

  [[nodiscard]] Result<Answer> run(const CommonOptions& common) override {
    const sim::SyntheticShotsOptions options;
    const Case cases[] = {{options.poses, false},
                          {options.poses, true},
                          {options.poses / 2, false},
                          {options.poses / 2, true}};
    const auto config = effective_config(common);
    if (!config) return tl::unexpected(config.error());
    if (auto opened = cells_.open(common, *config); !opened) return tl::unexpected(opened.error());
    std::map<std::string, std::map<std::string, CalibrationErrors>> table;
    const auto bar = progress_bar(common, "evaluate calibration");
    for (int set = 0; set < sets_; ++set) {
      const std::uint64_t seed = common.seed + static_cast<std::uint64_t>(set);
      const auto errors = cells_.at<SetErrors>(fmt::format("set {}", seed),
                                               [&] { return one_set(seed, options, cases); });
      if (!errors) return tl::unexpected(errors.error());
      for (const auto& [name, quantities] : errors->values) {
        for (const auto& [quantity, values] : quantities) {
          for (std::size_t i = 0; i + 1 < values.size(); i += 2)
            table[name][quantity].add(values[i], values[i + 1]);
        }
      }
      if (bar) bar((set + 1.0) / sets_);
    }
    return cells_.answer([&] { return answer(table); });
  }

 private:
  [[nodiscard]] Result<Answer> answer(
      const std::map<std::string, std::map<std::string, CalibrationErrors>>& table) const {
    nlohmann::ordered_json json;
    std::string text;
    for (const auto& [name, quantities] : table) {
      const telemetry::Table errors = error_table(name, quantities);
      json[name] = to_json_by_name(errors);
      text += (text.empty() ? "" : "\n") + to_text(errors);
    }
    text.pop_back();
    return Answer{.json = nlohmann::ordered_json{{"sets", sets_}, {"calibration", json}}.dump(2),
                  .text = text};
  }

  static Result<SetErrors> one_set(std::uint64_t seed, const sim::SyntheticShotsOptions& options,
                                   std::span<const Case> cases) {
    std::error_code error;
    const fs::path folder =
        fs::temp_directory_path(error) / fmt::format("tuina-rehearsal-{}-{}", ::getpid(), seed);
    const auto truth = sim::built_scanner(seed);
    const auto written = sim::render_calibration_shots(truth, seed, folder, options);
    if (!written) return tl::unexpected(written.error());
    auto measured = measure(truth, seed, folder, options, cases);
    fs::remove_all(folder, error);
    return measured;
  }

  static Result<SetErrors> measure(const scanner::ScannerCalibration& truth, std::uint64_t seed,
                                   const fs::path& folder,
                                   const sim::SyntheticShotsOptions& options,
                                   std::span<const Case> cases) {
    Views all;
    const auto whole = calibrate_folder(folder, all);
    if (!whole) return tl::unexpected(whole.error());
    SetErrors errors;
    errors.add("sweeps", "latency, ms",
               1e3 * std::abs(whole->calibration.latency_s - truth.latency_s),
               1e3 * whole->latency->deviation_s);
    const Transform& couch = whole->calibration.couch_from_camera;
    const Transform& true_couch = truth.couch_from_camera;
    errors.add("sweeps", "height over couch, mm",
               to_mm(std::abs(couch.translation().z() - true_couch.translation().z())),
               to_mm(whole->couch->height_deviation_m));
    const Vector3 up = couch.linear().row(2);
    const Vector3 true_up = true_couch.linear().row(2);
    errors.add("sweeps", "tilt over couch, deg", to_deg(up.cross(true_up).norm()),
               to_deg(whole->couch->tilt_deviation_rad));
    for (const Case& one : cases) {
      for (int draw = 0; draw < (one.noise ? draws_of_noise : 1); ++draw) {
        Views views = some_of(all, one, options.poses, seed, draw);
        const auto result = calibrate(views);
        if (!result) return tl::unexpected(result.error());
        add(truth, *result, one.name(), errors);
      }
    }
    return errors;
  }

  static void add(const scanner::ScannerCalibration& truth, const Calibrated& result,
                  const std::string& table, SetErrors& errors) {
    const auto& found = result.calibration;
    const Covariance& covariance = result.fit.covariance;
    const auto two = [&](int i, int k) { return std::sqrt(covariance(i, i) + covariance(k, k)); };
    for (std::size_t i = 0; i < result.expected.size(); ++i) {
      if (!result.expected[i]) continue;
      errors.add(table, fmt::format("range at {:.2f} m, mm", reported_depths_m[i]),
                 to_mm(sim::range_error_m(truth, found, reported_depths_m[i])),
                 to_mm(result.expected[i]->systematic_m));
    }
    errors.add(table, "focal length, px", std::abs(found.camera.fx_px - truth.camera.fx_px),
               std::sqrt(covariance(fx, fx)));
    const Vector3& axis = truth.axis_direction_in_camera;
    errors.add(table, "axis direction, deg",
               to_deg(found.axis_direction_in_camera.cross(axis).norm()),
               to_deg(two(axis_tilt_1, axis_tilt_2)));
    const Vector3 apart = found.axis_point_in_camera - truth.axis_point_in_camera;
    errors.add(table, "axis place, mm", to_mm(apart.cross(axis).norm()),
               to_mm(two(axis_shift_1, axis_shift_2)));
  }

  Cells cells_;
  int sets_ = 10;
};

}  // namespace

std::unique_ptr<Verb> make_evaluate_calibration() {
  return std::make_unique<EvaluateCalibration>();
}

}  // namespace tuina::app
