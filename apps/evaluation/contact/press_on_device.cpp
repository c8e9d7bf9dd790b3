// SPDX-License-Identifier: Apache-2.0
#include "apps/evaluation/contact/press_on_device.hpp"

#include <fmt/ranges.h>

#include <algorithm>

#include "apps/simulated/session_order.hpp"
#include "apps/simulated/simulated_session.hpp"
#include "apps/simulated/watched_session.hpp"
#include "tuina/core/io/file.hpp"
#include "tuina/core/io/scratch_folder.hpp"
#include "tuina/massage/technique/contact_path.hpp"
#include "tuina/massage/zones.hpp"

namespace tuina::app {
namespace {

std::string programme_of(const DevicePress& wanted) {
  return fmt::format(
      "name = \"press\"\n[[part]]\ntechnique = \"{}\"\npoints = [\"{}\"]\nforce_n = {}\n"
      "time_s = {}\n",
      name_of(wanted.technique), wanted.at, wanted.force_n, wanted.duration_s);
}

/// What a programme may ask for, by the names of the options here.
Result<void> check_order(const DevicePress& wanted, std::uint64_t seed) {
  const double max_n = massage::rule_of(massage::Zone::muscle).cap_n;
  constexpr double max_duration_s = 60.0;
  if (wanted.force_n < massage::kept_force_n || wanted.force_n > max_n)
    return fail(Fault::usage, "--force-n {}: a person is pressed with {} to {} N", wanted.force_n,
                massage::kept_force_n, max_n);
  if (wanted.duration_s > max_duration_s)
    return fail(Fault::usage, "--duration-s {}: a point of a person is pressed for {} s at most",
                wanted.duration_s, max_duration_s);
  if (wanted.technique == Technique::stroke)
    return fail(Fault::usage,
                "--technique stroke: goes from one point to another; --device has "
                "one");
  const auto person = sim::parse_person(wanted.order.person, wanted.order.position, seed);
  if (!person) return tl::unexpected(person.error());
  std::vector<std::string> names;
  names.reserve(person->acupoints.size());
  for (const Acupoint& point : person->acupoints) names.push_back(point.name);
  if (std::find(names.begin(), names.end(), wanted.at) == names.end())
    return fail(Fault::usage, "--at {}: is none of {}", wanted.at, fmt::join(names, ", "));
  const auto read = massage::parse_programme(programme_of(wanted), "press");
  if (!read)
    return fail(Fault::usage, "--technique {} --force-n {}: {}", name_of(wanted.technique),
                wanted.force_n, read.error().message);
  return {};
}

/// The result of a session as that of one contact: errors, highest true force, tissue and trace.
DevicePressed pressed_of(const SessionResult& result, Technique technique) {
  const session::Session& session = result.session;
  DevicePressed pressed{.devices = *result.devices};
  ContactOutcome& outcome = pressed.outcome;
  if (const auto found = result.truth.techniques.find(technique);
      found != result.truth.techniques.end())
    outcome.force = found->second;
  std::optional<Arm> arm;
  for (std::size_t i = 0; i < session.performed.size(); ++i) {
    const session::Performed& done = session.performed[i];
    const Touched& touched = result.truth.touched[i];
    arm = done.arm;
    if (done.felt) outcome.estimate = *done.felt;
    if (touched.peak_n > outcome.highest_n) pressed.tissue = touched.tissue;
    outcome.highest_n = std::max(outcome.highest_n, touched.peak_n);
  }
  for (const telemetry::TraceRow& row : result.truth.trace) {
    if (row.arm != arm) continue;
    outcome.trace.push_back({.time_s = row.time_s,
                             .target_n = row.target_n,
                             .true_force_n = row.true_force_n,
                             .measured_force_n = row.measured_force_n,
                             .depth_m = row.depth_m});
  }
  for (const session::Stop& stop : session.stops)
    outcome.stops.push_back({stop.time_s, explain(stop).words});
  outcome.stopped = !outcome.stops.empty();
  if (session.ready.plan.paths.empty()) return pressed;
  const massage::PlannedPath& planned = session.ready.plan.paths.front();
  pressed.ordered_n = planned.ordered_n();
  pressed.lowered_by = planned.lowered_by.words;
  return pressed;
}

}  // namespace

void DeviceOptions::describe(Options& options, const std::vector<Option>& of_the_bench) {
  auto device =
      options.add("--device", order_.device,
                  "a TOML file that names the arms (docs/armlink.md): the back of who is before "
                  "them is scanned, and --at pressed by the guarded arm that serves it");
  options.add("--person", order_.person, "who is before these arms, which --seed must fit, too")
      .show_default()
      .needs(device);
  position_.describe(options, "of that person").needs(device);
  options.add("--at", at_, "an acupoint of that person").show_default().needs(device);
  for (const Option& one : of_the_bench) device.excludes(one);
}

Result<DevicePressed> DeviceOptions::press(const ContactExperiment& wanted,
                                           const session::Config& config,
                                           const CommonOptions& common) {
  order_.position = position_.position();
  order_.robot = wanted.robot;
  return press_on_device({.order = order_,
                          .at = at_,
                          .force_n = wanted.force_n,
                          .technique = wanted.technique,
                          .duration_s = wanted.duration_s},
                         config, common);
}

Result<DevicePressed> press_on_device(const DevicePress& wanted, const session::Config& config,
                                      const CommonOptions& common) {
  if (const auto good = check_order(wanted, common.seed); !good)
    return tl::unexpected(good.error());
  auto scratch = ScratchFolder::make();
  if (!scratch) return tl::unexpected(scratch.error());
  record::SessionOrder order = wanted.order;
  order.programme = (scratch->path() / "press.toml").string();
  if (auto written = write_file(order.programme, programme_of(wanted)); !written)
    return tl::unexpected(written.error());
  const auto result = run_simulated_session(order, config, common, {}, until_asked_to_end({}));
  if (!result) return tl::unexpected(result.error());
  if (result->session.performed.empty() && result->session.stops.empty()) {
    std::string why;
    for (const Sentence& note : result->session.ready.plan.notes) why += "; " + note.words;
    return fail(Fault::not_found, "nothing was pressed{}", why);
  }
  return pressed_of(*result, wanted.technique);
}

}  // namespace tuina::app
