// SPDX-License-Identifier: Apache-2.0
#include "apps/evaluation/scanner/proof.hpp"

#include <functional>
#include <utility>

#include "apps/simulated/session_order.hpp"
#include "tuina/core/units.hpp"
#include "tuina/session/realism.hpp"
#include "tuina/sim/person/phantom.hpp"

namespace tuina::app {
namespace {

constexpr double speckle_px = 0.1;
const std::vector<double> depths_m = {0.35, 0.5, 0.65, 0.8, 0.9, 1.0, 1.1, 1.25, 1.4, 1.6, 1.75};

/// What the scanner meets in a world of this realism.
sim::ScanFlaws flaws_of(const char* realism) {
  session::Config config;
  config.simulation.realism = realism;
  session::set_realism(config.simulation);
  return scan_flaws(config);
}

/// The usual skin, of another tone; camera and lamps without flaws.
sim::ScanFlaws skin_of_tone(double dark_share) {
  sim::ScanFlaws flaws = flaws_of("usual");
  flaws.dark_share = dark_share;
  flaws.flicker_share = flaws.readout_s = 0.0;
  return flaws;
}

std::vector<std::pair<std::string, ScanConditions>> named_conditions() {
  const auto with = [](auto change) {
    ScanConditions conditions;
    change(conditions.options);
    return conditions;
  };
  return {{"noise_only", {}},
          {"speckle", with([](auto& o) { o.speckle_px = speckle_px; })},
          {"room_light_60", with([](auto& o) { o.room_light_dn = 60.0; })},
          {"room_light_60_dark_frames", with([](auto& o) {
             o.room_light_dn = 60.0;
             o.dark_frames = true;
           })},
          {"saturated", with([](auto& o) { o.amplitude_dn = 600.0; })},
          {"skin_light", with([](auto& o) { o.flaws = skin_of_tone(0.1); })},
          {"skin_medium", with([](auto& o) { o.flaws = skin_of_tone(0.4); })},
          {"skin_dark", with([](auto& o) { o.flaws = skin_of_tone(0.7); })},
          {"usual", with([](auto& o) { o.flaws = flaws_of("usual"); })},
          {"hard", with([](auto& o) { o.flaws = flaws_of("hard"); })},
          {"landscape_mount", {}}};
}

struct CurvePlan {
  Curve curve;
  std::function<void(ScanConditions&, double)> set;
};

std::vector<CurvePlan> curve_plans() {
  return {
      {{"room_light", "room light, DN", {0, 20, 40, 60, 90, 120}},
       [](ScanConditions& c, double x) { c.options.room_light_dn = x; }},
      {{"amplitude",
        "amplitude of the line at 1.1 m, DN (clipped from 245)",
        {30, 60, 120, 200, 400, 800, 1200}},
       [](ScanConditions& c, double x) { c.options.amplitude_dn = x; }},
      {{"speckle", "speckle, px", {0, 0.05, 0.1, 0.15, 0.2}},
       [](ScanConditions& c, double x) { c.options.speckle_px = x; }},
      {{"dropped_frames", "frames dropped, %", {0, 1, 5, 10, 20, 30}},
       [](ScanConditions& c, double x) {
         c.options.dropped_share = 0.01 * x;
         c.sweep.max_lost_share = 1.0;  // else refused from 5 %
       }},
      {{"yaw_jitter", "jitter of the motor's clock, ms", {0, 1, 3, 6, 10}},
       [](ScanConditions& c, double x) { c.options.yaw_jitter_s = 1e-3 * x; }},
      {{"latency_error", "latency wrong by, ms", {0, 20, 40, 80, 120}},
       [](ScanConditions& c, double x) { c.latency_error_s = 1e-3 * x; }},
      {{"breathing", "breathing at 0.25 Hz, mm", {0, 3, 6, 12}},
       [](ScanConditions& c, double x) {
         c.breathing = {.amplitude_m = from_mm(x), .frequency_hz = 0.25};
       }},
      {{"breathing_both_ways", "breathing at 0.25 Hz, scanned both ways, mm", {0, 3, 6, 12}},
       [](ScanConditions& c, double x) {
         c.breathing = {.amplitude_m = from_mm(x), .frequency_hz = 0.25};
         c.sweep.both_ways = true;
       }},
      {{"latency_error_both_ways", "latency wrong by, scanned both ways, ms", {0, 20, 40, 80, 120}},
       [](ScanConditions& c, double x) {
         c.latency_error_s = 1e-3 * x;
         c.sweep.both_ways = true;
       }},
  };
}

}  // namespace

Result<ScannerProof> prove_scanner(const ProofOptions& options, std::uint64_t seed,
                                   const Progress& progress) {
  ScannerProof proof{.people = options.people};
  auto conditions = named_conditions();
  auto plans = curve_plans();
  double all = 0.0, done = 0.0;
  if (options.walls) all += 8.0;
  if (options.bodies) all += 1.0;
  if (options.backs) all += static_cast<double>(conditions.size());
  for (const auto& plan : plans) {
    if (options.curves) all += static_cast<double>(plan.curve.x.size());
  }
  const auto step = [&](double by) {
    done += by;
    if (progress) progress(done / all);
  };

  if (options.walls) {
    proof.walls = wall_trials(depths_m, {}, options.across, seed);
    step(4.0);
    proof.speckled_walls = wall_trials(depths_m, {.speckle_px = speckle_px}, options.across, seed);
    step(4.0);
  }
  if (options.bodies) {
    auto box = box_trial({}, seed);
    if (!box) return tl::unexpected(box.error());
    auto sphere = sphere_trial({}, seed);
    if (!sphere) return tl::unexpected(sphere.error());
    proof.box = std::move(*box);
    proof.sphere = std::move(*sphere);
    const auto person =
        sim::make_phantom(sim::draw_phantom(sim::BodyType::medium, seed), BodyPosture::sitting);
    sim::LaserScanner scanner(person.skin_in_couch, person.position, {}, seed);
    auto scan = scanner::scan_sweep(scanner, scanner,
                                    sim::believed_calibration(scanner.true_calibration(), seed));
    if (!scan) return tl::unexpected(scan.error());
    proof.back_in_couch = std::move(scan->cloud_in_couch);
    step(1.0);
  }
  if (options.backs) {
    for (auto& [name, condition] : conditions) {
      condition.upright = name != "landscape_mount";
      std::span<const BuiltScanner> scanners = options.upright;
      if (!condition.upright && !scanners.empty()) scanners = options.across;
      proof.backs[name] = back_trial(condition, options.people, seed, scanners);
      step(1.0);
    }
  }
  if (options.curves) {
    for (auto& plan : plans) {
      for (const double x : plan.curve.x) {
        ScanConditions condition;
        plan.set(condition, x);
        plan.curve.y.push_back(back_trial(condition, options.people, seed, options.upright));
        step(1.0);
      }
      proof.curves.push_back(std::move(plan.curve));
    }
  }
  proof.targets = targets_of(proof, options.upright);
  return proof;
}

}  // namespace tuina::app
