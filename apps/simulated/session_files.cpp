// SPDX-License-Identifier: Apache-2.0
#include "apps/simulated/session_files.hpp"

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "apps/simulated/session_record.hpp"
#include "apps/simulated/session_replay.hpp"
#include "tuina/core/io/file.hpp"
#include "tuina/core/io/surface_file.hpp"
#include "tuina/core/units.hpp"
#include "tuina/record/acupoint_file.hpp"
#include "tuina/record/plan_file.hpp"
#include "tuina/telemetry/report/page.hpp"

namespace tuina::app {
namespace {

using nlohmann::ordered_json;

/// What is not finite has no number in JSON.
ordered_json number(double value) {
  return std::isfinite(value) ? ordered_json(value) : ordered_json();
}

ordered_json three(const Vector3& v) {
  return {v.x(), v.y(), v.z()};
}

/// Mean and largest error over the seven points of the thesis.
std::pair<double, double> error_of_seven_m(const SessionResult& result) {
  double sum_m = 0.0, max_m = 0.0;
  for (std::size_t i = 0; i < result.session.located.acupoints.size(); ++i) {
    for (const char* name : seven_acupoints) {
      if (result.session.located.acupoints[i].name != name) continue;
      sum_m += result.truth.acupoint_errors_m[i];
      max_m = std::max(max_m, result.truth.acupoint_errors_m[i]);
    }
  }
  return {sum_m / static_cast<double>(seven_acupoints.size()), max_m};
}

/// Stiffness as people read it, from the logarithm of N/m; half-widths of 95 % intervals.
double to_n_per_mm(double log_stiffness) {
  return 1e-3 * std::exp(log_stiffness);
}
double ci95_n_per_mm(const tissue::FeltPlace& place) {
  return 1.96 * place.sd * to_n_per_mm(place.log_stiffness);
}

ordered_json stiffness_json(const FeltBack& felt) {
  ordered_json places = ordered_json::array(), changes = ordered_json::array();
  for (const FeltPoint& point : felt.points) {
    places.push_back({{"name", point.planned->path.acupoints.front()},
                      {"position_m", three(point.place.at_in_couch)},
                      {"stiffness_n_per_mm", to_n_per_mm(point.place.log_stiffness)},
                      {"ci95_n_per_mm", ci95_n_per_mm(point.place)},
                      {"mapped", point.mapped}});
  }
  for (const tissue::ComparedVisits& place : felt.twice) {
    changes.push_back({{"name", place.name},
                       {"before_n_per_mm", to_n_per_mm(place.before.log_stiffness)},
                       {"after_n_per_mm", to_n_per_mm(place.after.log_stiffness)},
                       {"change_percent", 100.0 * std::expm1(place.change.log_change)},
                       {"detectable_percent", 100.0 * std::expm1(place.change.detectable)},
                       {"detected", place.change.told}});
  }
  return {{"force_n", session::reference_force_n}, {"places", places}, {"changes", changes}};
}

ordered_json condition_json(const FeltBack& felt) {
  return {{"slim", felt.condition.slim},
          {"medium", felt.condition.medium},
          {"hefty", felt.condition.hefty},
          {"female", felt.condition.female},
          {"presses", felt.condition_presses},
          {"caution", "by the seven people of the thesis' Table 6-2, one of them a woman"}};
}

double least_to_person_m(const SessionResult& result) {
  double min_m = std::numeric_limits<double>::infinity();
  for (const telemetry::ArmDistance& row : result.truth.distances)
    min_m = std::min(min_m, row.to_person_m);
  return min_m;
}

record::PlanFile plan_file_of(const SessionResult& result) {
  return {.plan = result.session.ready.plan,
          .reachable = result.session.ready.reachable,
          .min_arm_distance_m = result.session.ready.min_arm_distance_m,
          .clear = result.session.ready.clear,
          .rail_m = result.session.ready.rail_m,
          .compute_ms = result.session.plan_ms};
}

}  // namespace

std::string session_json(const SessionResult& result, const FeltBack& felt_back,
                         const SessionOrder& order, std::uint64_t seed) {
  const auto [mean_error_m, max_error_m] = error_of_seven_m(result);
  ordered_json points = ordered_json::array();
  for (std::size_t i = 0; i < result.session.located.acupoints.size(); ++i) {
    const Acupoint& acupoint = result.session.located.acupoints[i];
    const double error_m = result.truth.acupoint_errors_m[i];
    points.push_back({{"name", acupoint.name},
                      {"position_m", three(acupoint.at_in_couch)},
                      {"normal", three(acupoint.normal_in_couch)},
                      {"uncertainty_mm", to_mm(acupoint.uncertainty_m)},
                      {"error_mm", number(to_mm(error_m))}});
  }
  // Every technique has its key; one that the programme does not use has no errors.
  ordered_json techniques = ordered_json::object();
  for (const Technique technique : all_techniques) {
    const auto found = result.truth.techniques.find(technique);
    const bool used = found != result.truth.techniques.end();
    techniques[name_of(technique)] = {
        {"rmse_n", used ? ordered_json(found->second.rmse_n) : ordered_json()},
        {"peak_n", used ? ordered_json(found->second.peak_n) : ordered_json()}};
  }
  ordered_json tissue = ordered_json::array();
  for (const FeltPoint& felt : felt_back.points) {
    const TissueEstimate& estimate = felt.estimate;
    tissue.push_back(
        {{"name", felt.planned->path.acupoints.front()},
         {"alpha_n", estimate.tissue.alpha_n},
         {"beta_per_mm", 1e-3 * estimate.tissue.beta_per_m},
         {"ci95",
          {{"alpha_n", estimate.alpha_ci95_n}, {"beta_per_mm", 1e-3 * estimate.beta_ci95_per_m}}},
         {"true_alpha_n", felt.truth.alpha_n},
         {"true_beta_per_mm", 1e-3 * felt.truth.beta_per_m},
         {"presses", estimate.presses},
         {"converged", estimate.converged},
         {"converged_after_s",
          estimate.converged ? ordered_json(estimate.converged_after_s) : ordered_json()},
         {"class", tissue::name_of(felt.classified.label)},
         {"class_probability", felt.classified.probability}});
  }
  ordered_json commands = ordered_json::array();
  for (const auto& [time_s, command] : result.session.commands) {
    commands.push_back({{"time_s", time_s}, {"command", session::name_of(command)}});
  }
  ordered_json decisions = ordered_json::array();
  for (const session::Decision& made : result.session.decisions) {
    decisions.push_back(
        {{"time_s", made.time_s},
         {"arm", name_of(made.arm)},
         {"path", result.session.ready.plan.paths[static_cast<std::size_t>(made.path)].path.name},
         {"rule", made.rule},
         {"reason", made.reason},
         {"from_n", made.from_n},
         {"to_n", made.to_n}});
  }
  ordered_json performed = ordered_json::array();
  for (std::size_t i = 0; i < result.session.performed.size(); ++i) {
    const session::Performed& done = result.session.performed[i];
    performed.push_back(
        {{"name", result.session.ready.plan.paths[static_cast<std::size_t>(done.path)].path.name},
         {"path", done.path},
         {"arm", name_of(done.arm)},
         {"begin_s", done.begin_s},
         {"end_s", done.end_s},
         {"trouble", control::name_of(done.contact_fault)},
         {"true_peak_n", result.truth.touched[i].peak_n},
         {"true_over_trip_n", number(result.truth.touched[i].over_trip_n)}});
    if (const auto off_m = tool_to_acupoint_m(result, i))
      performed.back()["tool_to_acupoint_mm"] = to_mm(*off_m);
  }
  ordered_json stops = ordered_json::array();
  for (const session::Stop& stop : result.session.stops) {
    stops.push_back({{"time_s", stop.time_s}, {"cause", session::explain(stop)}});
  }
  const Transform& placed = result.session.base_from_couch;
  ordered_json rotation = ordered_json::array();
  for (int row = 0; row < 3; ++row) rotation.push_back(three(placed.linear().row(row)));
  constexpr auto couch = robot::Surrounding::couch, body = robot::Surrounding::body;
  const ordered_json json = {
      {"seed", seed},
      {"version", TUINA_VERSION},
      {"person", result.person.name},
      {"position", name_of(result.session.located.position)},
      {"order", order_json(order)},
      {"base_from_couch", {{"rotation", rotation}, {"translation_m", three(placed.translation())}}},
      {"scan",
       {{"profiles", result.session.scan.profiles},
        {"points", result.session.scan.cloud_in_couch.size()},
        {"sweep_s", result.session.scan.sweep_s},
        {"rms_error_mm", to_mm(result.truth.scan_error_m)},
        {"compute_ms", result.session.scan.compute_ms}}},
      {"acupoints",
       {{"method", name_of(result.session.located.method)},
        {"compute_ms", result.session.locate_ms},
        {"mean_error_mm", to_mm(mean_error_m)},
        {"max_error_mm", to_mm(max_error_m)},
        {"points", points}}},
      {"plan",
       {{"compute_ms", result.session.plan_ms},
        {"paths", result.session.ready.plan.paths.size()},
        {"duration_s", result.session.ready.plan.duration_s},
        {"reachable", result.session.ready.reachable},
        {"min_arm_distance_mm", to_mm(result.session.ready.min_arm_distance_m)},
        {"min_couch_distance_mm", number(to_mm(result.session.ready.clear[couch]))},
        {"min_body_distance_mm", number(to_mm(result.session.ready.clear[body]))},
        {"zones_touched", result.session.ready.plan.zones_touched},
        {"notes", result.session.ready.plan.notes}}},
      {"massage",
       {{"duration_s", result.session.massage_s},
        {"real_time_factor", result.real_time_factor()},
        {"min_arm_distance_mm", to_mm(result.truth.min_arm_distance_m)},
        {"min_couch_distance_mm", number(to_mm(result.truth.clear[couch]))},
        {"min_body_distance_mm", number(to_mm(result.truth.clear[body]))},
        {"min_distance_to_person_mm", number(to_mm(least_to_person_m(result)))},
        {"force",
         {{"rmse_n", result.truth.force.rmse_n},
          {"peak_n", result.truth.force.peak_n},
          {"overshoot_n", result.truth.force.overshoot_n}}},
        {"techniques", techniques},
        {"performed", performed}}},
      {"consent",
       {{"answered_by", result.consent.answered_by},
        {"questions", session::health_questions.size()},
        {"reasons_against", 0}}},
      {"rescans_s", result.session.rescans_s},
      {"commands", commands},
      {"decisions", decisions},
      {"tissue", tissue},
      {"stiffness", stiffness_json(felt_back)},
      {"body_condition", condition_json(felt_back)},
      {"stops", stops}};
  return json.dump(2);
}

Result<void> write_session(const SessionResult& result, const session::Config& config,
                           const std::string& json, const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) return fail(Fault::file, "{}: cannot be made: {}", folder.string(), error.message());
  const record::MapFile map{.mapping = result.session.located,
                            .points = result.session.scan.cloud_in_couch.size(),
                            .compute_ms = result.session.locate_ms};
  const std::pair<const char*, std::string> files[] = {
      {"session.json", json + "\n"},
      {"config.toml", session::to_toml(config)},
      {"consent.toml", result.consent_toml},
      {"scan.ply", to_ply(result.session.scan.cloud_in_couch)},
      {"acupoints.json", record::to_json(map) + "\n"},
      {"plan.json", record::to_json(plan_file_of(result)) + "\n"},
      {"trace.csv", csv_of(result.truth.trace)},
      {"joints.csv", csv_of(result.joints)},
      {"distances.csv", csv_of(result.truth.distances)}};
  for (const auto& [name, content] : files) {
    if (auto written = write_file(folder / name, content); !written) return written;
  }
  // The page is made of the record, as `tuina report` makes it again.
  const auto report = read_record(folder);
  if (!report) return tl::unexpected(report.error());
  if (auto written = write_file(folder / "back.svg", telemetry::back_picture(*report)); !written)
    return written;
  return write_file(folder / "report.html", telemetry::report_page(*report));
}

std::string session_text(const SessionResult& result) {
  const auto [mean_error_m, max_error_m] = error_of_seven_m(result);
  std::string text = fmt::format(
      "{} ({}): {} points scanned, acupoints within {:.1f} mm (largest error {:.1f} mm)\n"
      "{} paths in {:.0f} s, force error {:.2f} N RMS, peak {:.1f} N, {:.0f} times real time",
      result.person.name, name_of(result.session.located.position),
      result.session.scan.cloud_in_couch.size(), to_mm(mean_error_m), to_mm(max_error_m),
      result.session.performed.size(), result.session.massage_s, result.truth.force.rmse_n,
      result.truth.force.peak_n, result.real_time_factor());
  for (const session::Performed& done : result.session.performed) {
    if (done.contact_fault == control::ContactFault::none) continue;
    text += fmt::format(
        "\n{}: {}", result.session.ready.plan.paths[static_cast<std::size_t>(done.path)].path.name,
        control::name_of(done.contact_fault));
  }
  for (const std::string& note : result.session.ready.plan.notes) text += "\n" + note;
  for (const session::Stop& stop : result.session.stops) {
    text += fmt::format("\nstopped at {:.2f} s, {}", stop.time_s, session::explain(stop));
  }
  return text;
}

}  // namespace tuina::app
