// SPDX-License-Identifier: Apache-2.0
#include "tuina/record/session_file.hpp"

#include <cmath>

#include "tuina/core/io/text_lines.hpp"
#include "tuina/record/shared_fields.hpp"
#include "tuina/session/consent.hpp"

namespace tuina::record {
namespace {

constexpr Unit ms{1e3, 1e-3, 0.01};

constexpr auto found_fields = [](auto& visit, auto& found) {
  visit("name", found.acupoint.name);
  acupoint_fields(visit, found.acupoint);
  visit("error_mm", found.error_m, mm);
};

constexpr auto surroundings_fields = [](auto& visit, auto& clear) {
  visit.maybe("min_couch_distance_mm", clear[robot::Surrounding::couch], mm);
  visit.maybe("min_body_distance_mm", clear[robot::Surrounding::body], mm);
};

constexpr auto scan_fields = [](auto& visit, auto& scan) {
  visit("profiles", scan.profiles);
  visit("points", scan.points);
  visit("sweep_s", scan.sweep_s);
  visit.maybe("rms_error_mm", scan.rms_error_m, mm);
  visit("compute_ms", scan.compute_ms);
};

constexpr auto acupoints_fields = [](auto& visit, auto& acupoints) {
  visit("method", acupoints.method);
  visit("compute_ms", acupoints.compute_ms);
  visit.maybe("mean_error_mm", acupoints.mean_error_m, mm);
  visit.maybe("max_error_mm", acupoints.max_error_m, mm);
  visit.list("points", acupoints.points, found_fields);
};

constexpr auto planned_fields = [](auto& visit, auto& plan) {
  visit("compute_ms", plan.compute_ms);
  visit("paths", plan.paths);
  visit("duration_s", plan.duration_s);
  visit("reachable", plan.reachable);
  visit("min_arm_distance_mm", plan.min_arm_distance_m, mm);
  surroundings_fields(visit, plan.clear);
  visit("zones_touched", plan.zones_touched);
  english_fields(visit, "notes", plan.notes);
  // Versions that spoke English alone wrote none.
  if (visit.has("notes_said")) visit.list("notes_said", plan.notes, spoken_fields);
};

constexpr auto performed_fields = [](auto& visit, auto& done) {
  visit("name", done.name);
  visit("path", done.path);
  visit("arm", done.arm);
  visit("begin_s", done.begin_s);
  visit("end_s", done.end_s);
  visit("trouble", done.contact_fault);
  visit.maybe("programme_n", done.programme_n);
  visit.maybe("lowered_by", done.lowered_by.words);
  key_fields(visit, "lowered_by_said", done.lowered_by);
  visit.maybe("ordered_n", done.ordered_n);
  visit.maybe("given_n", done.given_n);
  visit.maybe("mean_n", done.mean_n);  // versions without it wrote that mean as given
  auto why = done.why.empty() ? std::nullopt : std::optional(done.why.words);
  visit.maybe("why", why);
  if constexpr (requires { done.why.words = *why; }) done.why.words = why.value_or("");
  key_fields(visit, "why_said", done.why);
  visit.maybe("true_peak_n", done.true_peak_n);
  visit.maybe("true_over_trip_n", done.true_over_trip_n);
  visit.if_known("tool_to_acupoint_mm", done.tool_to_acupoint_m,
                 [](auto& of_press, auto& off_m) { of_press("tool_to_acupoint_mm", off_m, mm); });
};

/// Every technique has its key; one that the programme does not use has no errors.
constexpr auto techniques_fields = [](auto& visit, auto& used) {
  for (const Technique technique : all_techniques) {
    constexpr double none = std::numeric_limits<double>::quiet_NaN();
    telemetry::TechniqueForce force{.technique = technique, .rmse_n = none, .peak_n = none};
    for (const telemetry::TechniqueForce& one : used)
      if (one.technique == technique) force = one;
    // A version that knew fewer techniques may have written the session.
    if (!visit.has(name_of(technique))) continue;
    visit.object(name_of(technique), [&](auto& inside) {
      inside.maybe("rmse_n", force.rmse_n);
      inside.maybe("peak_n", force.peak_n);
    });
    if constexpr (requires { used.push_back(force); })
      if (!std::isnan(force.rmse_n)) used.push_back(force);
  }
};

constexpr auto late_fields = [](auto& visit, auto& late) {
  visit("median", late.median_s, ms);
  visit("p999", late.p999_s, ms);
  visit("max", late.max_s, ms);
};

constexpr auto massage_fields = [](auto& visit, auto& massage) {
  visit("duration_s", massage.duration_s);
  visit("real_time_factor", massage.real_time_factor);
  visit.if_known("late_ms", massage.late, [](auto& of_massage, auto& late) {
    of_massage.object("late_ms", [&](auto& inside) { late_fields(inside, late); });
  });
  visit("min_arm_distance_mm", massage.min_arm_distance_m, mm);
  surroundings_fields(visit, massage.clear);
  visit.maybe("min_distance_to_person_mm", massage.min_distance_to_person_m, mm);
  visit.maybe("intensity", massage.intensity);
  visit.object("force", [&](auto& inside) { force_fields(inside, massage.force); });
  visit.object("techniques", [&](auto& inside) { techniques_fields(inside, massage.techniques); });
  visit.list("performed", massage.performed, performed_fields);
};

constexpr auto command_fields = [](auto& visit, auto& given) {
  visit("time_s", given.first);
  visit("command", given.second);
};

constexpr auto felt_fields = [](auto& visit, auto& felt) {
  auto& estimate = felt.estimate;
  visit("name", felt.name);
  tangent_fields(visit, estimate.tissue);
  visit.object("ci95", [&](auto& inside) {
    inside("alpha_n", estimate.alpha_ci95_n);
    inside("beta_per_mm", estimate.beta_ci95_per_m, per_mm);
  });
  visit.if_known("true_alpha_n", felt.truth, [](auto& of_truth, auto& truth) {
    of_truth("true_alpha_n", truth.alpha_n);
    of_truth("true_beta_per_mm", truth.beta_per_m, per_mm);
  });
  visit("presses", estimate.presses);
  visit("converged", estimate.converged);
  visit.maybe("converged_after_s", estimate.converged_after_s);
  visit("class", felt.tissue_class);
  visit("class_probability", felt.class_probability);
};

/// The same places again, for the map of their stiffness.
constexpr auto place_fields = [](auto& visit, auto& felt) {
  visit("name", felt.name);
  visit("position_m", felt.at_in_couch);
  visit("stiffness_n_per_mm", felt.stiffness_n_per_mm);
  visit("ci95_n_per_mm", felt.stiffness_ci95_n_per_mm);
  visit("mapped", felt.mapped);
};

constexpr auto change_fields = [](auto& visit, auto& change) {
  visit("name", change.name);
  visit("before_n_per_mm", change.before_n_per_mm);
  visit("after_n_per_mm", change.after_n_per_mm);
  visit("change_percent", change.change, percent);
  visit("detectable_percent", change.detectable, percent);
  visit("detected", change.detected);
};

constexpr auto visit_fields = [](auto& visit, auto& label) {
  visit("who", label.who);
  visit("session_id", label.id);
  visit("began", label.began);
};

constexpr auto traffic_fields = [](auto& visit, auto& traffic) {
  visit("cycles", traffic.cycles);
  visit("lost", traffic.lost);
  visit("late", traffic.late);
  visit("unheard", traffic.unheard);
  visit("rejected", traffic.rejected);
  visit.maybe("wrist", traffic.wrist);
};

constexpr auto device_fields = [](auto& visit, auto& devices) {
  visit("arms", devices.arms);
  visit("pace", devices.pace);
  visit("scanner", devices.scanner);
  visit("truth_missed_ms", devices.truth_missed);
  for (const Arm arm : both_arms)
    visit.object(name_of(arm), [&](auto& inside) { traffic_fields(inside, devices.traffic[arm]); });
};

constexpr auto point_fields = [](auto& visit, auto& point) {
  visit("name", point.name);
  visit("position_m", point.at_in_couch);
};

constexpr auto known_fields = [](auto& visit, auto& known) {
  visit("position", known.position);
  visit.list("lay", known.lay, point_fields);
  visit.list("places", known.places, [](auto& inside, auto& place) {
    inside("name", place.name);
    tangent_fields(inside, place.tissue);
    inside("log_sd", place.log_sd);
  });
};

constexpr auto said_fields = [](auto& visit, auto& said) {
  visit.list("no_go", said.by_hand.no_go, [](auto& inside, auto& area) {
    inside("name", area.name);
    inside("corners_m", area.corners_in_couch);
  });
  visit.list("fixed", said.by_hand.fixed, [](auto& inside, auto& point) {
    point_fields(inside, point);
    inside("error_mm", point.error_m, mm);
  });
  visit.list("lay", said.lay, point_fields);
};

constexpr auto session_fields = [](auto& visit, auto& file) {
  visit("seed", file.seed);
  visit("version", file.version);
  visit.if_known("who", file.visit, visit_fields);
  visit("person", file.person);
  visit.maybe("realism", file.realism);  // versions that knew one world have not written it
  visit("position", file.position);
  visit.object("order", [&](auto& inside) { order_fields(inside, file.order); });
  visit("base_from_couch", file.base_from_couch);
  visit.object("scan", [&](auto& inside) { scan_fields(inside, file.scan); });
  visit.object("acupoints", [&](auto& inside) { acupoints_fields(inside, file.acupoints); });
  visit.object("plan", [&](auto& inside) { planned_fields(inside, file.plan); });
  visit.object("massage", [&](auto& inside) { massage_fields(inside, file.massage); });
  visit.object("consent", [&](auto& inside) {
    inside("answered_by", file.answered_by);
    inside.told("questions", session::health_questions.size());
    inside.told("reasons_against", 0);  // otherwise nobody would have been touched
  });
  visit("rescans_s", file.rescans_s);
  visit.list("commands", file.order.commands, command_fields);
  visit.if_known("said", file.order.said, [](auto& of_file, auto& said) {
    of_file.object("said", [&](auto& inside) { said_fields(inside, said); });
  });
  visit.if_known("known", file.order.known, [](auto& of_file, auto& known) {
    of_file.object("known", [&](auto& inside) { known_fields(inside, known); });
  });
  visit.list("decisions", file.decisions, decision_fields);
  visit.list("tissue", file.tissue, felt_fields);
  visit.object("stiffness", [&](auto& inside) {
    inside("force_n", file.stiffness_force_n);
    inside.list("places", file.tissue, place_fields);
    inside.list("changes", file.changes, change_fields);
  });
  visit.object("body_condition", [&](auto& inside) {
    inside("slim", file.condition.slim);
    inside("medium", file.condition.medium);
    inside("hefty", file.condition.hefty);
    inside("female", file.condition.female);
    inside("presses", file.condition_presses);
    inside.told("caution", "by the seven people of the thesis' Table 6-2, one of them a woman");
  });
  visit.list("stops", file.stops, [](auto& inside, auto& stop) {
    stop_fields(inside, stop);
    key_fields(inside, "cause_said", stop.cause);
  });
  visit.if_known("devices", file.devices, [](auto& of_file, auto& devices) {
    of_file.object("devices", [&](auto& inside) { device_fields(inside, devices); });
  });
};

/// An area of fewer corners would rule out nothing, and nobody would notice.
Result<void> check_areas(const session::Said& said, std::string_view file) {
  constexpr std::size_t min_corners = 3;
  for (const massage::NoGo& area : said.by_hand.no_go) {
    if (area.corners_in_couch.size() < min_corners)
      return fail(Fault::bad_input, "{}: no_go {} has {} corners; at least {} are needed", file,
                  in_quotes(area.name), area.corners_in_couch.size(), min_corners);
  }
  return {};
}

}  // namespace

std::string to_json(const SessionFile& file) {
  return to_json(file, session_fields).dump(2);
}

std::string to_json(const session::Said& said) {
  return to_json(said, said_fields).dump();
}

Result<session::Said> parse_said(std::string_view text, std::string_view name) {
  auto said = parse_json<session::Said>(text, name, "list of what was said by hand", said_fields);
  if (!said) return said;
  if (auto good = check_areas(*said, name); !good) return tl::unexpected(good.error());
  return said;
}

Result<SessionFile> parse_session(std::string_view text, std::string_view name) {
  auto file = parse_json<SessionFile>(text, name, "record of a session", session_fields);
  if (!file || !file->order.said) return file;
  if (auto good = check_areas(*file->order.said, name); !good) return tl::unexpected(good.error());
  return file;
}

}  // namespace tuina::record
