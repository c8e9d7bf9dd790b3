// SPDX-License-Identifier: Apache-2.0
#include "apps/evaluation/scanner/proof.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

#include "apps/evaluation/scanner/outcome_fields.hpp"
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

Result<std::vector<WallTrial>> walls_cell(Cells& cells, const std::string& name,
                                          const ProofOptions& options,
                                          const sim::LaserScannerOptions& scanner,
                                          std::uint64_t seed) {
  const auto cell = cells.at<WallNumbers>(name, [&]() -> Result<WallNumbers> {
    const auto scanners = options.of_walls();
    if (!scanners) return tl::unexpected(scanners.error());
    return numbers_of(wall_trials(depths_m, scanner, *scanners, seed));
  });
  if (!cell) return tl::unexpected(cell.error());
  return walls_of(*cell);
}

Result<BackTrial> back_cell(Cells& cells, const std::string& name, const ProofOptions& options,
                            const ScanConditions& condition, std::uint64_t seed) {
  return cells.at<BackTrial>(name, [&]() -> Result<BackTrial> {
    const auto scanners = options.of_backs(condition.upright);
    if (!scanners) return tl::unexpected(scanners.error());
    return back_trial(condition, options.people, seed, *scanners);
  });
}

Result<LatencyTrial> latency_cell(Cells& cells, const ProofOptions& options) {
  return cells.at<LatencyTrial>("latency", [&]() -> Result<LatencyTrial> {
    const auto scanners = options.of_backs(true);
    if (!scanners) return tl::unexpected(scanners.error());
    LatencyTrial trial;
    if (!scanners->empty()) trial.worst_s = 0.0;
    for (const BuiltScanner& built : *scanners) {
      const double error_s = std::abs(built.believed.latency_s - built.truth.latency_s);
      trial.worst_s = std::max(trial.worst_s, error_s);
    }
    return trial;
  });
}

/// A box, a ball, and a person to be looked at.
Result<void> scan_bodies(std::uint64_t seed, ScannerProof& proof) {
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
  return {};
}

}  // namespace

Result<ScannerProof> prove_scanner(const ProofOptions& options, Cells& cells, std::uint64_t seed,
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
    for (const auto& [name, walls, scanner] :
         {std::tuple("walls", &proof.walls, sim::LaserScannerOptions{}),
          std::tuple("walls with speckle", &proof.speckled_walls,
                     sim::LaserScannerOptions{.speckle_px = speckle_px})}) {
      auto found = walls_cell(cells, name, options, scanner, seed);
      if (!found) return tl::unexpected(found.error());
      *walls = std::move(*found);
      step(4.0);
    }
  }
  if (options.bodies && !cells.sharded()) {
    if (auto scanned = scan_bodies(seed, proof); !scanned) return tl::unexpected(scanned.error());
    step(1.0);
  }
  if (options.backs) {
    for (auto& [name, condition] : conditions) {
      condition.upright = name != "landscape_mount";
      const auto back = back_cell(cells, "back " + name, options, condition, seed);
      if (!back) return tl::unexpected(back.error());
      proof.backs[name] = *back;
      step(1.0);
    }
  }
  if (options.curves) {
    for (auto& plan : plans) {
      for (const double x : plan.curve.x) {
        ScanConditions condition;
        plan.set(condition, x);
        const auto back =
            back_cell(cells, fmt::format("{} {}", plan.curve.name, x), options, condition, seed);
        if (!back) return tl::unexpected(back.error());
        plan.curve.y.push_back(*back);
        step(1.0);
      }
      proof.curves.push_back(std::move(plan.curve));
    }
  }
  if (options.backs || options.curves) {
    const auto latency = latency_cell(cells, options);
    if (!latency) return tl::unexpected(latency.error());
    if (std::isfinite(latency->worst_s)) proof.worst_latency_s = latency->worst_s;
  }
  proof.targets = targets_of(proof);
  return proof;
}

}  // namespace tuina::app
