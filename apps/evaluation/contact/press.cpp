// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>

#include "apps/cli/asked_to_end.hpp"
#include "apps/evaluation/contact/contact_experiment.hpp"
#include "apps/evaluation/contact/contact_files.hpp"
#include "apps/evaluation/contact/press_on_device.hpp"
#include "apps/evaluation/verbs.hpp"
#include "tuina/core/io/file.hpp"
#include "tuina/core/units.hpp"
#include "tuina/massage/technique/tap.hpp"
#include "tuina/record/shared_fields.hpp"
#include "tuina/session/config.hpp"

namespace tuina::app {
namespace {

// [thesis] chapter 6: what a robot of seven joints pressed at 20 mm/s.
const std::map<std::string, TangentTissue> thesis_tissues = {
    {"bone", {4.559, 263.2}}, {"hard", {9.786, 185.4}}, {"soft", {4.275, 143.6}}};
const std::map<std::string, control::ControlLaw> laws = {{"tuina", control::ControlLaw::tuina},
                                                         {"thesis", control::ControlLaw::thesis},
                                                         {"joint", control::ControlLaw::joint}};
const std::map<std::string, RubShape> rub_shapes = {
    {"circle", RubShape::circle}, {"ellipse", RubShape::ellipse}, {"spiral", RubShape::spiral}};

template <typename Value>
std::vector<std::string> names(const std::map<std::string, Value>& map) {
  std::vector<std::string> keys;
  keys.reserve(map.size());
  for (const auto& [key, value] : map) keys.push_back(key);
  return keys;
}

/// A tap may not change its force too fast.
Result<void> check_force(const ContactExperiment& experiment) {
  const double strongest_n = massage::strongest_tap_n(experiment.tap_hz);
  if (experiment.technique != Technique::tap || experiment.force_n <= strongest_n) return {};
  return fail(Fault::usage, "--force-n {}: {:.1f} N are allowed at {} taps a second",
              experiment.force_n, strongest_n, experiment.tap_hz);
}

/// One arm on a patch of skin whose truth is hidden from it: how well it holds a force there.
class Press final : public Verb {
 public:
  [[nodiscard]] const char* name() const override { return "press"; }
  [[nodiscard]] const char* summary() const override {
    return "one contact experiment: one arm, one technique, a patch of tissue";
  }
  [[nodiscard]] const char* example() const override {
    return "tuina press --tissue hard --force-n 30 --surface-error-mm 3 --out trace.csv";
  }

  void describe(Options& options) override {
    auto tissue = options.add("--tissue", tissue_, "bone, hard or soft muscle of the thesis")
                      .one_of(names(thesis_tissues))
                      .show_default();
    auto alpha = options.add("--alpha-n", alpha_n_, "hardness of the tissue")
                     .between(0.5, 50.0)
                     .excludes(tissue);
    auto beta = options.add("--beta-per-mm", beta_per_mm_, "grows as the tissue gets thinner")
                    .between(0.02, 1.0)
                    .excludes(tissue);
    alpha.needs(beta);
    beta.needs(alpha);
    options.add("--force-n", force_n_, "to be held")
        .required()
        .between(1.0, safety::ceiling_of(safety::Zone::bench).set_n);
    options.add("--technique", technique_, "what the arm does there")
        .one_of(technique_names())
        .show_default();
    add_robot_option(options, robot_);
    auto cycle = options
                     .add("--cycle-hz", cycle_hz_,
                          "the arm takes places and no torques, so often: 125 or 500")
                     .one_of({"125", "500"});
    options.add("--bandwidth-hz", bandwidth_hz_, "of such an arm")
        .between(1.0, 100.0)
        .show_default()
        .needs(cycle);
    options.add("--rub-shape", rub_shape_, "way of a rub").one_of(names(rub_shapes)).show_default();
    options
        .add("--controller", controller_,
             "tuina; the Cartesian law of the thesis (3.5); its joint law (3.9)")
        .one_of(names(laws))
        .show_default();
    options
        .add("--surface-error-mm", surface_error_mm_, "the skin is this much deeper than believed")
        .between(-10.0, 10.0)
        .show_default();
    options.add("--surface-tilt-deg", surface_tilt_deg_, "the skin leans this much unknown")
        .between(-10.0, 10.0)
        .show_default();
    options.add("--torso-n-per-mm", torso_, "gives way beneath the tissue: a number or `rigid`")
        .check(
            [](const std::string& text) {
              return text == "rigid" ? std::string() : number_between(1.0, 1e4)(text);
            },
            "number or rigid");
    options.add("--friction", friction_, "scale on the joint friction").between(0.0, 3.0);
    options
        .add("--breathing-mm", breathing_mm_,
             "motion of the skin; else 0 in an ideal world, that of the config in others")
        .between(0.0, 15.0);
    options.add("--breathing-hz", breathing_hz_).between(0.05, 1.0).show_default();
    options.add("--duration-s", duration_s_, "of the technique").between(3.0, 300.0).show_default();
    options
        .add("--model-error", model_error_,
             "scale on what the controller believes wrongly: masses 10 %, friction 20 %, "
             "alpha and beta 30 %")
        .between(0.0, 1.5)
        .show_default();
    options
        .add("--rise-mm", rise_mm_,
             "the person comes so far towards the tool; negative: goes away from it")
        .between(-100.0, 100.0);
    options.add("--slide-mm", slide_mm_, "the person slides so far sideways")
        .between(-100.0, 100.0);
    options.add("--shift-mm-per-s", shift_mm_per_s_, "speed of rise and slide")
        .between(1.0, 2000.0)
        .show_default();
    options
        .add("--shift-m-per-s2", shift_m_per_s2_,
             "acceleration up to that speed; 0: it jumps, which no body can do")
        .between(0.0, 100.0)
        .show_default();
    options.add("--shift-at-s", shift_at_s_, "after the start of the technique")
        .between(0.0, 300.0)
        .show_default();
    options.add("--plot", plot_, "force over time, SVG");
    options.add("--out", out_, "trace of every millisecond, with --device of every fifth, CSV");
    options.add("--felt", felt_, "what the arm felt, CSV as `tuina tissue` reads it");
    std::vector<Option> of_the_bench;
    for (const char* name :
         {"--tissue", "--alpha-n", "--cycle-hz", "--rub-shape", "--controller", "--model-error",
          "--surface-error-mm", "--surface-tilt-deg", "--torso-n-per-mm", "--friction",
          "--breathing-mm", "--breathing-hz", "--rise-mm", "--slide-mm", "--shift-mm-per-s",
          "--shift-m-per-s2", "--shift-at-s", "--felt"})
      of_the_bench.push_back(options.named(name));
    device_.describe(options, of_the_bench);
  }

  [[nodiscard]] Result<Answer> run(const CommonOptions& common) override {
    const auto config = effective_config(common);
    if (!config) return tl::unexpected(config.error());
    for (const std::string& written : {out_, felt_, plot_}) {
      if (const auto good = check_folder_of(written); !good) return tl::unexpected(good.error());
    }
    end_when_asked();
    ContactExperiment experiment{.robot = robot_};
    experiment.tissue =
        alpha_n_ > 0.0 ? TangentTissue{alpha_n_, 1e3 * beta_per_mm_} : thesis_tissues.at(tissue_);
    experiment.force_n = force_n_;
    experiment.technique = *parse_technique(technique_);  // checked by the option
    if (const auto good = check_force(experiment); !good) return tl::unexpected(good.error());
    experiment.rub_shape = rub_shapes.at(rub_shape_);
    experiment.controller.law = laws.at(controller_);
    experiment.surface_error_m = from_mm(surface_error_mm_);
    experiment.surface_tilt_rad = from_deg(surface_tilt_deg_);
    experiment.torso_n_per_m = 1e3 * config->simulation.torso_n_per_mm;
    experiment.breathing = {from_mm(breathing_mm_.value_or(0.0)), breathing_hz_};
    live_in(*config, experiment);
    if (!torso_.empty())
      experiment.torso_n_per_m = torso_ == "rigid" ? sim::rigid : 1e3 * std::stod(torso_);
    torso_n_per_m_ = experiment.torso_n_per_m;
    if (breathing_mm_) experiment.breathing.amplitude_m = from_mm(*breathing_mm_);
    experiment.friction_scale = friction_ < 0.0 ? config->simulation.friction : friction_;
    realism_ = config->simulation.realism;
    experiment.duration_s = duration_s_;
    experiment.mass_error *= model_error_;
    experiment.friction_error *= model_error_;
    experiment.tissue_error *= model_error_;
    experiment.seed = common.seed;
    experiment.position = loop();
    for (const Vector3& by_mm : {Vector3(0.0, rise_mm_, 0.0), Vector3(slide_mm_, 0.0, 0.0)}) {
      if (by_mm.isZero()) continue;
      sim::Shift shift{.start_s = shift_at_s_,
                       .by_in_couch = 1e-3 * by_mm,
                       .speed_m_per_s = from_mm(shift_mm_per_s_)};
      if (shift_m_per_s2_ > 0.0) shift.acceleration_m_per_s2 = shift_m_per_s2_;
      experiment.shifts.push_back(shift);
    }

    if (device_.asked()) return on_device(experiment, *config, common);
    const auto outcome = run_contact(experiment, progress_bar(common, "press"));
    if (!outcome) return tl::unexpected(outcome.error());
    if (auto written = write_files(*outcome); !written) return tl::unexpected(written.error());
    return answer_of(outcome->tissue, *outcome);
  }

 private:
  [[nodiscard]] Result<void> write_files(const ContactOutcome& outcome) const {
    if (!out_.empty()) {
      if (auto written = write_file(out_, to_csv(outcome.trace)); !written) return written;
    }
    if (!felt_.empty()) {
      if (auto written = write_file(felt_, to_csv(outcome.felt)); !written) return written;
    }
    if (plot_.empty()) return {};
    const auto title =
        fmt::format("{} with {:.0f} N, controller {}", technique_, force_n_, controller_);
    return write_file(plot_, draw(outcome.trace, title));
  }
  [[nodiscard]] Result<Answer> on_device(const ContactExperiment& experiment,
                                         const session::Config& config,
                                         const CommonOptions& common) {
    const auto pressed = device_.press(experiment, config, common);
    if (!pressed) return tl::unexpected(pressed.error());
    if (auto written = write_files(pressed->outcome); !written)
      return tl::unexpected(written.error());
    return answer_of(pressed->tissue, pressed->outcome, &*pressed);
  }
  [[nodiscard]] std::optional<sim::PositionLoop> loop() const {
    if (cycle_hz_.empty()) return std::nullopt;
    return sim::PositionLoop{.cycle_hz = std::stod(cycle_hz_), .bandwidth_hz = bandwidth_hz_};
  }
  [[nodiscard]] Answer answer_of(const TangentTissue& tissue, const ContactOutcome& outcome,
                                 const DevicePressed* on_device = nullptr) const {
    const session::ForceErrors& force = outcome.force;
    const TissueEstimate& estimate = outcome.estimate;
    nlohmann::json stops = nlohmann::json::array();
    std::string stopped;
    for (const ContactStop& stop : outcome.stops) {
      stops.push_back({{"time_s", stop.time_s}, {"cause", stop.cause}});
      stopped += fmt::format("\nstopped at {:.3f} s: {}", stop.time_s, stop.cause);
    }
    nlohmann::json json = {{"technique", technique_},
                           {"realism", realism_},
                           {"controller", controller_},
                           {"target_n", force_n_},
                           {"force", record::to_json(force, record::force_fields)},
                           {"estimate", record::to_json(estimate.tissue, record::tangent_fields)},
                           {"true", record::to_json(tissue, record::tangent_fields)},
                           {"highest_force_n", outcome.highest_n},
                           {"stops", stops}};
    if (on_device != nullptr) {
      json["ordered_n"] = on_device->ordered_n;
      json["lowered_by"] = on_device->lowered_by;
      json["devices"] = {{"arms", on_device->devices.arms}, {"pace", on_device->devices.pace}};
      if (!on_device->lowered_by.empty())
        stopped += fmt::format("\n{:.1f} N ordered, lowered by {}", on_device->ordered_n,
                               on_device->lowered_by);
    } else {
      json["torso_n_per_mm"] = std::isfinite(torso_n_per_m_) ? nlohmann::json(1e-3 * torso_n_per_m_)
                                                             : nlohmann::json("rigid");
      json["second_impact_n"] = outcome.second_impact_n;
      json["fastest_tool_mm_per_s"] = to_mm(outcome.max_speed_m_per_s);
    }
    json["force"]["settled_rmse_n"] =
        force.settled_rmse_n ? nlohmann::json(*force.settled_rmse_n) : nlohmann::json();
    json["estimate"]["converged"] = estimate.converged;
    json["estimate"]["converged_after_s"] =
        estimate.converged ? nlohmann::json(estimate.converged_after_s) : nlohmann::json();
    const std::string held =
        std::isnan(force.rmse_n)
            ? "nothing was touched"
            : fmt::format("force error {:.2f} N rms, peak {:.1f} N", force.rmse_n, force.peak_n);
    return {.json = json.dump(2),
            .text = fmt::format("{} with {:.0f} N, controller {}: {}, tissue alpha "
                                "{:.2f} N beta {:.4f} /mm (true {:.2f}, {:.4f}){}{}",
                                technique_, force_n_, controller_, held, estimate.tissue.alpha_n,
                                1e-3 * estimate.tissue.beta_per_m, tissue.alpha_n,
                                1e-3 * tissue.beta_per_m,
                                estimate.converged ? "" : ", not converged", stopped),
            .exit_code = outcome.stopped ? 4 : 0};
  }

  DeviceOptions device_;
  std::string robot_ = "thesis", tissue_ = "hard", technique_ = "press", rub_shape_ = "circle";
  std::string controller_ = "tuina", cycle_hz_, torso_, out_, felt_, plot_;
  double alpha_n_ = 0.0, beta_per_mm_ = 0.0, force_n_ = 0.0;
  double surface_error_mm_ = 0.0, surface_tilt_deg_ = 0.0, friction_ = -1.0;
  double bandwidth_hz_ = sim::PositionLoop{}.bandwidth_hz;
  double rise_mm_ = 0.0, slide_mm_ = 0.0, shift_mm_per_s_ = 100.0;
  double shift_m_per_s2_ = 0.0, shift_at_s_ = 2.0;
  std::string realism_;
  double torso_n_per_m_ = 0.0;
  std::optional<double> breathing_mm_;
  double breathing_hz_ = 0.25, duration_s_ = 10.0, model_error_ = 1.0;
};

}  // namespace

std::unique_ptr<Verb> make_press() {
  return std::make_unique<Press>();
}

}  // namespace tuina::app
