// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>

#include "apps/cli/press_file.hpp"
#include "apps/tuina/press_plot.hpp"
#include "apps/tuina/verbs.hpp"
#include "tuina/baselines/thesis_estimator.hpp"
#include "tuina/core/io/file.hpp"
#include "tuina/core/units.hpp"
#include "tuina/record/shared_fields.hpp"
#include "tuina/tissue/classification.hpp"
#include "tuina/tissue/press_forecast.hpp"
#include "tuina/tissue/press_segments.hpp"
#include "tuina/tissue/record_estimate.hpp"

namespace tuina::app {
namespace {

constexpr const char* trace_header =
    "time_s,alpha_n,beta_per_mm,alpha_ci_n,beta_ci_per_mm,converged\n";

void append_row(std::string& trace, double time_s, const TissueEstimate& e, bool with_interval) {
  if (with_interval) {
    fmt::format_to(std::back_inserter(trace), "{},{:.6g},{:.6g},{:.6g},{:.6g},{}\n", time_s,
                   e.tissue.alpha_n, from_mm(e.tissue.beta_per_m), e.alpha_ci95_n,
                   from_mm(e.beta_ci95_per_m), e.converged ? 1 : 0);
  } else {
    fmt::format_to(std::back_inserter(trace), "{},{:.6g},{:.6g},nan,nan,{}\n", time_s,
                   e.tissue.alpha_n, from_mm(e.tissue.beta_per_m), e.converged ? 1 : 0);
  }
}

/// What is kept of a record of which millions of rows may come.
struct Wanted {
  bool trace = false, history = false;
};

/// What an estimator made of a record.
struct Estimated {
  TissueEstimate last;
  double nis = 1.0;
  bool too_slow = false, zero_known = true, skin_as_told = true;
  tissue::SensorNoise noise = {};
  std::string trace = trace_header;
  std::vector<TimedEstimate> history = {};

  void keep(double time_s, const TissueEstimate& estimate, Wanted wanted, bool with_interval) {
    if (wanted.trace) append_row(trace, time_s, estimate, with_interval);
    if (wanted.history) history.push_back({time_s, estimate});
  }
};

/// What keeps a record from converging however long it is, each in a line of its own.
std::string why_never_converged(const Estimated& result) {
  std::string text;
  if (result.too_slow)
    text +=
        "\nMost rows lie more than 0.05 s apart, too far to tell how the tissue relaxes: such a "
        "record never converges; `tuina tissue fit` takes it.";
  if (!result.zero_known)
    text +=
        "\nThe record shows no free air before its first contact, so the zero of the force is not "
        "known, and it never converges. If the sensor was tared, say how well: --force-zero-sd-n "
        "0.1.";
  if (!result.skin_as_told)
    text +=
        "\nThe first contact is far from position 0, where the skin was told to be, so the record "
        "never converges. Say how far off the skin may be: --contact-sd-mm 50.";
  return text;
}

/// CSV of the forces that a later press is going to meet.
Result<std::string> predicted_csv(const tissue::RecordEstimate& made,
                                  std::span<const tissue::TimedPress> record,
                                  const std::string& next_file) {
  const auto rows = read_presses(next_file, true);
  if (!rows) return tl::unexpected(rows.error());
  if (const std::string fault = tissue::fault_of_next(record, *rows); !fault.empty())
    return fail(Fault::bad_input, "{}: {}", next_file, fault);
  const auto foretold =
      tissue::foretell_press(made.estimator, record.front().time_s, record.back().time_s, *rows);
  if (!foretold) return fail(foretold.error().fault, "{}: {}", next_file, foretold.error().message);
  std::string csv = "time_s,force_n,force_low_n,force_high_n\n";
  for (const auto& [time_s, band] : *foretold) {
    fmt::format_to(std::back_inserter(csv), "{},{:.6g},{:.6g},{:.6g}\n", time_s, band.force_n,
                   band.low_n, band.high_n);
  }
  return csv;
}

/// The thesis prints neither intervals nor a rule for convergence; here it has converged once
/// neither parameter has left a band of 1 % for ten seconds.
Estimated by_thesis(std::span<const tissue::TimedPress> record, const tissue::SensorNoise& noise,
                    Wanted wanted) {
  constexpr double band = 0.01, settled_s = 10.0;
  Estimated result{.last = {}, .noise = noise};
  baselines::ThesisEstimator estimator({.period_s = 0.0});
  tissue::PressSegments presses({.force_noise_n = noise.force_n});
  TangentTissue centre;
  double since_s = record.front().time_s;
  for (const tissue::TimedPress& sample : record) {
    estimator.update(sample.time_s, sample.press);
    presses.add(sample.time_s, sample.press);
    TissueEstimate& e = result.last;
    e.tissue = estimator.estimate().tissue;
    e.presses = presses.presses();
    if (!estimator.valid() || std::abs(e.tissue.alpha_n - centre.alpha_n) > band * centre.alpha_n ||
        std::abs(e.tissue.beta_per_m - centre.beta_per_m) > band * centre.beta_per_m) {
      centre = e.tissue;
      since_s = sample.time_s;
    }
    const bool was = e.converged;
    e.converged =
        estimator.valid() && presses.ever_touched() && sample.time_s - since_s >= settled_s;
    if (e.converged && !was) e.converged_after_s = sample.time_s - presses.first_contact_s();
    result.keep(sample.time_s, e, wanted, false);
  }
  return result;
}

/// The estimate of a record as it grows, sample by sample, as a robot would make it.
class TissueEstimateVerb final : public Verb {
 public:
  [[nodiscard]] const char* name() const override { return "tissue estimate"; }
  [[nodiscard]] const char* summary() const override {
    return "estimate alpha and beta from a record, sample by sample";
  }
  [[nodiscard]] const char* example() const override {
    return "tuina tissue estimate press.csv --out trace.csv --json";
  }
  void describe(Options& options) override {
    file_.describe(options);
    options.add("--plot", plot_, "draw the estimates over time as SVG");
    auto alpha = options
                     .add("--true-alpha-n", true_alpha_n_,
                          "of a simulated record: drawn beside the estimate, no more")
                     .between(0.01, 1e3);
    auto beta = options.add("--true-beta-per-mm", true_beta_per_mm_, "likewise")
                    .between(1e-3, 10.0)
                    .needs(alpha);
    alpha.needs(beta);
    auto predict = options.add(
        "--predict", predict_,
        "a later press as CSV like the record, force_n empty where it is to be predicted");
    auto predict_out = options
                           .add("--predict-out", predict_out_,
                                "write the predicted forces with their 95 % band to this CSV file")
                           .needs(predict);
    predict.needs(predict_out);
    options.add("--out", out_, "write the estimate after every sample to this CSV file");
    options.add("--method", method_, "tuina, or thesis: least squares with forgetting as printed")
        .one_of({"tuina", "thesis"})
        .show_default();
    options
        .add("--torso-n-per-mm", torso_n_per_mm_,
             "stiffness under the tissue that the position holds too")
        .between(0.1, 1e6);
    options
        .add("--breathing-mm", breathing_mm_,
             "how far the skin may move with the breath, peak to peak")
        .between(0.0, 50.0)
        .show_default();
    options.add("--contact-sd-mm", contact_sd_mm_, "how well the skin is known to be at position 0")
        .between(0.01, 50.0)
        .show_default();
    options
        .add(
            "--force-zero-sd-n", force_zero_sd_n_,
            "how well the zero of the force is known where no free air before the contact shows it")
        .between(0.001, 100.0)
        .show_default();
    options.add("--force-delay-ms", force_delay_ms_, "of the force against the position")
        .between(0.0, 50.0)
        .show_default();
  }

  [[nodiscard]] Result<Answer> run(const CommonOptions&) override {
    const bool ours = method_ == "tuina";
    if (!ours && !predict_.empty())
      return fail(Fault::usage, "--method thesis has no prediction; leave --predict away");
    const auto record = read_presses(file_.path);
    if (!record) return tl::unexpected(record.error());
    const Wanted wanted{.trace = !out_.empty(), .history = !plot_.empty()};
    std::optional<tissue::RecordEstimate> made;
    Estimated result;
    if (ours) {
      made = tissue::estimate_record(*record,
                                     {.contact_sd_m = from_mm(contact_sd_mm_),
                                      .untared_sd_n = force_zero_sd_n_,
                                      .force_delay_s = force_delay_ms_ * 1e-3,
                                      .torso_n_per_m = torso_n_per_mm_.value_or(0.0) * 1e3,
                                      .breathing_m = from_mm(breathing_mm_)},
                                     file_.known_noise(),
                                     [&](double time_s, const TissueEstimate& estimate) {
                                       result.keep(time_s, estimate, wanted, true);
                                     });
      result.last = made->estimator.estimate();
      result.nis = made->estimator.nis();
      result.too_slow = made->estimator.too_slow();
      result.zero_known = made->estimator.zero_known();
      result.skin_as_told = made->estimator.skin_as_told();
      result.noise = made->noise;
    } else {
      result =
          by_thesis(*record, file_.known_noise().over(tissue::estimate_noise(*record)), wanted);
    }
    if (!predict_.empty()) {
      const auto predicted = predicted_csv(*made, *record, predict_);
      if (!predicted) return tl::unexpected(predicted.error());
      if (const auto written = write_file(predict_out_, *predicted); !written)
        return tl::unexpected(written.error());
    }
    // The drawing first: if it cannot be written, no trace is left that looks like a success.
    if (!plot_.empty()) {
      if (const auto drawn = write_file(plot_, plot_estimates(result.history, truth())); !drawn)
        return tl::unexpected(drawn.error());
    }
    if (!out_.empty()) {
      if (const auto written = write_file(out_, result.trace); !written)
        return tl::unexpected(written.error());
    }
    return answer(result, ours);
  }

 private:
  [[nodiscard]] std::optional<TangentTissue> truth() const {
    if (!true_alpha_n_) return std::nullopt;
    return TangentTissue{*true_alpha_n_, 1e3 * *true_beta_per_mm_};
  }

  [[nodiscard]] Answer answer(const Estimated& result, bool ours) const {
    const TissueEstimate& e = result.last;
    const tissue::SensorNoise& noise = result.noise;
    const tissue::Classification found = tissue::classify(e, result.nis);
    const auto number = [](bool there, double value) {
      return there ? nlohmann::json(value) : nlohmann::json();
    };
    nlohmann::json json = record::to_json(e.tissue, record::tangent_fields);
    json.update({{"contact_mm", to_mm(e.contact_m)},
                 {"ci95",
                  {{"alpha_n", number(ours, e.alpha_ci95_n)},
                   {"beta_per_mm", number(ours, from_mm(e.beta_ci95_per_m))}}},
                 {"converged", e.converged},
                 {"converged_after_s", number(e.converged, e.converged_after_s)},
                 {"presses", e.presses},
                 {"torso_n_per_mm",
                  torso_n_per_mm_ ? nlohmann::json(*torso_n_per_mm_) : nlohmann::json("rigid")},
                 {"chi", number(ours, result.nis)},
                 {"class", tissue::name_of(found.label)},
                 {"class_probability", found.probability},
                 {"class_probabilities",
                  {{"bone", found.of[0]}, {"hard", found.of[1]}, {"soft", found.of[2]}}},
                 {"noise", record::to_json(noise, record::noise_fields)}});
    Answer answer{.json = json.dump(2)};
    answer.text = fmt::format(
        "{} after {} press{}: alpha {:.3f}{} N, beta {:.4f}{} /mm, {} ({:.0f} %)",
        e.converged ? "Converged" : "Not converged", e.presses, e.presses == 1 ? "" : "es",
        e.tissue.alpha_n, ours ? fmt::format(" +- {:.3f}", e.alpha_ci95_n) : "",
        from_mm(e.tissue.beta_per_m),
        ours ? fmt::format(" +- {:.4f}", from_mm(e.beta_ci95_per_m)) : "",
        tissue::name_of(found.label), 100.0 * found.probability);
    if (e.converged)
      answer.text += fmt::format(", {:.2f} s after the first contact", e.converged_after_s);
    else if (e.presses == 0)
      answer.text +=
          "; no press is in the record, so these are only assumed: is the position in mm, larger "
          "where deeper, and the force out of the skin?";
    if (e.presses > 0) answer.text += why_never_converged(result);
    // A body that gives way beneath is felt as softer tissue, and no record tells the two apart.
    if (e.presses > 0 && ours && !torso_n_per_mm_)
      answer.text +=
          "\nWhat lies beneath is taken as rigid; on a person who gives way there, say how much: "
          "--torso-n-per-mm 18 for one of whom nothing is known.";
    return answer;
  }

  PressFile file_;
  std::string out_, plot_, predict_, predict_out_;
  std::string method_ = "tuina";
  std::optional<double> torso_n_per_mm_, true_alpha_n_, true_beta_per_mm_;
  double breathing_mm_ = to_mm(tissue::record_options().breathing_m);
  double contact_sd_mm_ = to_mm(tissue::record_options().contact_sd_m);
  double force_zero_sd_n_ = tissue::record_options().untared_sd_n;
  double force_delay_ms_ = 0.0;
};

}  // namespace

std::unique_ptr<Verb> make_tissue_estimate() {
  return std::make_unique<TissueEstimateVerb>();
}

}  // namespace tuina::app
