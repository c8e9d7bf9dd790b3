// SPDX-License-Identifier: Apache-2.0
#include "apps/simulated/session_files.hpp"

#include <cmath>

#include "apps/simulated/felt_back.hpp"
#include "tuina/core/io/file.hpp"
#include "tuina/core/io/surface_file.hpp"
#include "tuina/core/units.hpp"
#include "tuina/record/acupoint_file.hpp"
#include "tuina/record/plan_file.hpp"
#include "tuina/record/session_report.hpp"
#include "tuina/record/why_not_as_ordered.hpp"
#include "tuina/telemetry/report/page.hpp"

namespace tuina::app {
namespace {

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

record::SessionFile::Acupoints acupoints_of(const SessionResult& result) {
  const auto [mean_error_m, max_error_m] = error_of_seven_m(result);
  record::SessionFile::Acupoints acupoints{.method = result.session.located.method,
                                           .compute_ms = result.session.locate_ms,
                                           .mean_error_m = mean_error_m,
                                           .max_error_m = max_error_m};
  for (std::size_t i = 0; i < result.session.located.acupoints.size(); ++i) {
    const double error_m = result.truth.acupoint_errors_m[i];
    acupoints.points.push_back(
        {.acupoint = result.session.located.acupoints[i],
         .error_m = std::isfinite(error_m) ? std::optional(error_m) : std::nullopt});
  }
  return acupoints;
}

record::SessionFile::Massage massage_of(const SessionResult& result, double begun_intensity) {
  const session::Session& session = result.session;
  const SessionTruth& truth = result.truth;
  record::SessionFile::Massage massage{.duration_s = session.massage_s,
                                       .real_time_factor = result.real_time_factor(),
                                       .late = result.late,
                                       .min_arm_distance_m = truth.min_arm_distance_m,
                                       .clear = truth.clear,
                                       .intensity = session.intensity,
                                       .force = truth.force};
  for (const telemetry::ArmDistance& row : truth.distances)
    massage.min_distance_to_person_m = std::min(massage.min_distance_to_person_m, row.to_person_m);
  for (const auto& [technique, errors] : truth.techniques)
    massage.techniques.push_back({technique, errors.rmse_n, errors.peak_n});
  for (std::size_t i = 0; i < session.performed.size(); ++i) {
    const session::Performed& done = session.performed[i];
    const auto path = static_cast<std::size_t>(done.path);
    const Touched& touched = truth.touched[i];
    const massage::PlannedPath& planned = session.ready.plan.paths[path];
    record::PerformedEntry told{
        .name = planned.path.name,
        .path = path,
        .arm = done.arm,
        .begin_s = done.begin_s,
        .end_s = done.end_s,
        .contact_fault = control::name_of(done.contact_fault),
        .programme_n = planned.programme_n,
        .lowered_by = planned.lowered_by,
        .ordered_n = planned.ordered_n(),
        .given_n = touched.peak_n,
        .true_peak_n = result.simulated ? touched.peak_n : telemetry::TraceRow::unknown,
        .true_over_trip_n = touched.over_trip_n,
        .tool_to_acupoint_m = tool_to_acupoint_m(result, i)};
    if (slides(planned.path.technique)) told.mean_n = touched.held.mean_n();
    told.why = record::why_not_as_ordered(session, done, told, begun_intensity);
    massage.performed.push_back(std::move(told));
  }
  return massage;
}

void add_devices(const record::DeviceRecord& devices, std::vector<SentenceLine>& lines) {
  const bool simulated = devices.scanner == record::DeviceRecord::simulated_scanner;
  lines.push_back(
      {simulated ? sentence("sum_devices",
                            "arms: {}, pace {}; camera and turntable: {}; truth of {} ms missed",
                            devices.arms, devices.pace, devices.scanner, devices.truth_missed)
                 : sentence("sum_own_devices", "arms: {}, pace {}; camera and turntable: {}",
                            devices.arms, devices.pace, devices.scanner)});
  for (const Arm arm : both_arms) {
    const auto& traffic = devices.traffic[arm];
    lines.push_back({sentence(
        "sum_traffic", "{} arm: {} states, {} lost, {} late, {} rejected; {} commands too late",
        name_of(arm), traffic.cycles, traffic.lost, traffic.late, traffic.rejected,
        traffic.unheard)});
    if (!traffic.wrist.empty()) {
      lines.push_back({sentence("sum_wrist", "{} wrist sensor: {}", name_of(arm), traffic.wrist)});
    }
  }
}

}  // namespace

record::SessionFile session_file(const SessionResult& result, const SessionOrder& order,
                                 std::uint64_t seed) {
  const session::Session& session = result.session;
  const motion::ReadyPlan& ready = session.ready;
  record::SessionFile file{.seed = seed,
                           .version = TUINA_VERSION,
                           .person = result.person.name,
                           .realism = result.realism,
                           .position = session.located.position,
                           .order = order,
                           .base_from_couch = session.base_from_couch,
                           .scan = {.profiles = session.scan.profiles,
                                    .points = session.scan.cloud_in_couch.size(),
                                    .sweep_s = session.scan.sweep_s,
                                    .rms_error_m = result.truth.scan_error_m,
                                    .compute_ms = session.scan.compute_ms},
                           .acupoints = acupoints_of(result),
                           .plan = {.compute_ms = session.plan_ms,
                                    .paths = ready.plan.paths.size(),
                                    .duration_s = ready.plan.duration_s,
                                    .reachable = ready.reachable,
                                    .min_arm_distance_m = ready.min_arm_distance_m,
                                    .clear = ready.clear,
                                    .zones_touched = ready.plan.zones_touched,
                                    .notes = ready.plan.notes},
                           .massage = massage_of(result, order.intensity),
                           .answered_by = result.consent.answered_by,
                           .rescans_s = session.rescans_s,
                           .devices = result.devices};
  if (!result.simulated) file.order.person.clear();
  file.order.commands = session.commands;
  if (!session.said.empty()) file.order.said = session.said;
  for (const session::Decision& made : session.decisions) {
    file.decisions.push_back(
        {.time_s = made.time_s,
         .arm = made.arm,
         .path = ready.plan.paths[static_cast<std::size_t>(made.path)].path.name,
         .rule = made.rule,
         .reason = made.reason,
         .key = made.key,
         .from_n = made.from_n,
         .to_n = made.to_n});
  }
  add_felt_back(result, file);
  for (const session::Stop& stop : session.stops)
    file.stops.push_back({stop.time_s, session::explain(stop)});
  return file;
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
      {"plan.json",
       record::to_json(record::plan_file_of(result.session.ready, result.session.plan_ms)) + "\n"},
      {"trace.csv", record::csv_of(result.truth.trace)},
      {"joints.csv", record::csv_of(result.joints)},
      {"distances.csv", record::csv_of(result.truth.distances)}};
  for (const auto& [name, content] : files) {
    if (auto written = write_file(folder / name, content); !written) return written;
  }
  // The page is made of the record, as `tuina report` makes it again.
  const auto report = record::read_record(folder);
  if (!report) return tl::unexpected(report.error());
  std::string back_svg;
  const std::string page = telemetry::report_page(*report, &back_svg);
  if (auto written = write_file(folder / "back.svg", back_svg); !written) return written;
  return write_file(folder / "report.html", page);
}

Result<void> finish_record(SessionResult& result, const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> files;
  for (const char* name : {"session.json", "scan.ply", "acupoints.json", "plan.json", "trace.csv",
                           "joints.csv", "distances.csv", "report.html"})
    files.push_back(folder / name);
  return result.recorder->finish(result.last_tick, files);
}

std::vector<SentenceLine> session_lines(const record::SessionFile& file) {
  const Sentence scanned =
      file.simulated()
          ? sentence("sum_scanned",
                     "{} ({}): {} points scanned, acupoints within {:.1f} mm (largest error {:.1f} "
                     "mm)",
                     file.person, name_of(file.position), file.scan.points,
                     to_mm(file.acupoints.mean_error_m), to_mm(file.acupoints.max_error_m))
          : sentence("sum_seen", "{} points scanned, {}", file.scan.points, name_of(file.position));
  const auto& massage = file.massage;
  const Sentence massaged =
      std::isnan(massage.force.rmse_n)
          ? sentence("sum_untouched", "{} paths in {:.0f} s, nothing was touched",
                     massage.performed.size(), massage.duration_s)
          : sentence("sum_massaged",
                     "{} paths in {:.0f} s, force error {:.2f} N RMS, peak {:.1f} N, {:.0f} times "
                     "real time",
                     massage.performed.size(), massage.duration_s, massage.force.rmse_n,
                     massage.force.peak_n, massage.real_time_factor);
  std::vector<SentenceLine> lines = {{scanned}, {massaged}};
  for (const record::PerformedEntry& done : massage.performed) {
    const Sentence why = done.told_why();
    if (why.empty()) {
      if (done.contact_fault != control::name_of(control::ContactFault::none))
        lines.push_back({sentence("sum_fault", "{}: {}", done.name, done.contact_fault)});
      continue;
    }
    lines.push_back({sentence("sum_given", "{}: {:.1f} N ordered, {:.1f} N given: ", done.name,
                              done.ordered_n, done.compared_n()),
                     why});
  }
  for (const Sentence& note : file.plan.notes) lines.push_back({note});
  if (file.devices) add_devices(*file.devices, lines);
  for (const telemetry::Stop& stop : file.stops)
    lines.push_back({sentence("sum_stopped", "stopped at {:.2f} s, ", stop.time_s), stop.cause});
  return lines;
}

std::string english_of(const std::vector<SentenceLine>& lines) {
  std::string text;
  for (const SentenceLine& line : lines) {
    if (!text.empty()) text += "\n";
    for (const Sentence& one : line) text += one.words;
  }
  return text;
}

std::string session_text(const record::SessionFile& file) {
  return english_of(session_lines(file));
}

}  // namespace tuina::app
