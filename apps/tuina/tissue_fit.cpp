// SPDX-License-Identifier: Apache-2.0
#include <nlohmann/json.hpp>

#include "apps/cli/press_file.hpp"
#include "apps/tuina/press_plot.hpp"
#include "apps/tuina/verbs.hpp"
#include "tuina/core/io/file.hpp"
#include "tuina/core/units.hpp"
#include "tuina/record/shared_fields.hpp"
#include "tuina/tissue/curve_fit.hpp"

namespace tuina::app {
namespace {

/// The tangent law through a whole record of presses at once.
class TissueFit final : public Verb {
 public:
  [[nodiscard]] const char* name() const override { return "tissue fit"; }
  [[nodiscard]] const char* summary() const override {
    return "fit F = alpha tan(beta x) to a record of presses";
  }
  [[nodiscard]] const char* example() const override { return "tuina tissue fit press.csv --json"; }
  void describe(Options& options) override {
    file_.describe(options);
    options.add("--plot", plot_, "draw force over depth with the fit and its band as SVG");
  }

  [[nodiscard]] Result<Answer> run(const CommonOptions&) override {
    const auto record = read_presses(file_.path);
    if (!record) return tl::unexpected(record.error());
    const tissue::SensorNoise noise = file_.known_noise().over(tissue::estimate_noise(*record));
    const auto fit = tissue::fit_curve(*record, noise);
    if (!fit) return fail(fit.error().fault, "{}: {}", file_.path, fit.error().message);
    if (!plot_.empty()) {
      if (const auto drawn = write_file(plot_, plot_fit(*record, *fit)); !drawn)
        return tl::unexpected(drawn.error());
    }
    // Per metre to per millimetre is the same factor as metres to millimetres, the other way round.
    const double beta_per_mm = from_mm(fit->tissue.beta_per_m),
                 beta_ci = from_mm(fit->beta_ci95_per_m);
    nlohmann::json json = record::to_json(fit->tissue, record::tangent_fields);
    json.update({{"contact_mm", to_mm(fit->contact_m)},
                 {"force_offset_n", fit->offset_n},
                 {"rmse_n", fit->rmse_n},
                 {"chi", fit->reduced_chi_square},
                 {"peak_force_n", fit->peak_force_n},
                 {"samples", fit->samples},
                 {"noise", record::to_json(noise, record::noise_fields)},
                 {"ci95",
                  {{"alpha_n", fit->alpha_ci95_n},
                   {"beta_per_mm", beta_ci},
                   {"contact_mm", to_mm(fit->contact_ci95_m)}}}});
    constexpr double nearly = 0.99;
    const bool at_limit = fit->tissue.beta_per_m < tissue::min_beta_per_m / nearly ||
                          fit->tissue.beta_per_m > nearly * tissue::max_beta_per_m;
    const bool follows_law = fit->reduced_chi_square <= tissue::max_chi_square;
    json.update({{"at_limit", at_limit}, {"settled", fit->settled}, {"follows_law", follows_law}});
    Answer answer{.json = json.dump(2)};
    answer.text = fmt::format(
        "F = {:.3f} N tan({:.4f}/mm x)\n  alpha {:.3f} +- {:.3f} N, beta {:.4f} +- {:.4f} /mm, "
        "skin at {:.2f} mm\n"
        "  force error {:.2f} N (RMS) over {} samples to {:.1f} N",
        fit->tissue.alpha_n, beta_per_mm, fit->tissue.alpha_n, fit->alpha_ci95_n, beta_per_mm,
        beta_ci, to_mm(fit->contact_m), fit->rmse_n, fit->samples, fit->peak_force_n);
    if (at_limit) {
      answer.text +=
          "\n  beta ends where the search does: no tissue is so. Is position_mm in millimetres, "
          "and larger the deeper?";
    } else if (fit->alpha_ci95_n > 0.2 * fit->tissue.alpha_n) {
      answer.text +=
          "\n  The press was too light to tell alpha from beta; press to two or three times alpha.";
    }
    if (!fit->settled) {
      answer.text +=
          "\n  The search was cut off on its way: what it found is not the best there is. A record "
          "that begins above the skin is found sooner.";
    }
    if (!follows_law) {
      answer.text += fmt::format(
          "\n  The record does not keep to this law within its noise (chi {:.1f}, up to {:.0f} is "
          "usual), so the intervals say too little: the person breathes, or the tissue relaxes. "
          "`tuina tissue estimate` reckons with both.",
          fit->reduced_chi_square, tissue::max_chi_square);
    }
    return answer;
  }

 private:
  PressFile file_;
  std::string plot_;
};

}  // namespace

std::unique_ptr<Verb> make_tissue_fit() {
  return std::make_unique<TissueFit>();
}

}  // namespace tuina::app
