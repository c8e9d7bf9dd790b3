// SPDX-License-Identifier: Apache-2.0
#include "tuina/record/why_not_as_ordered.hpp"

#include <algorithm>
#include <cmath>

namespace tuina::record {
namespace {

/// What the person asked for last before the path was done, where it changes a path's force.
const session::LiveCommand* asked_by_person(const session::Session& session,
                                            const session::Performed& done) {
  const session::LiveCommand* last = nullptr;
  for (const auto& [time_s, command] : session.commands) {
    const bool changes = command == session::LiveCommand::softer ||
                         command == session::LiveCommand::firmer ||
                         (command == session::LiveCommand::skip && done.skipped);
    if (changes && time_s <= done.end_s) last = &command;
  }
  return last;
}

/// The session was stopped before the path was done.
const session::Stop* stopped_by(const session::Session& session, const session::Performed& done) {
  if (done.whole || session.stops.empty()) return nullptr;
  const session::Stop& first = session.stops.front();
  return done.end_s > first.time_s - 0.5 * control_period_s ? &first : nullptr;
}

/// Cut short before the person was scanned again, and then begun once more.
bool begun_again(const session::Session& session, const session::Performed& done) {
  if (done.whole || done.skipped) return false;
  const auto name_of_path = [&](const session::Performed& one) -> const std::string& {
    return session.ready.plan.paths[static_cast<std::size_t>(one.path)].path.name;
  };
  return std::ranges::any_of(session.rescans_s, [&](double time_s) {
    return time_s > done.end_s &&
           std::ranges::any_of(session.performed, [&](const session::Performed& later) {
             return later.begin_s >= time_s && name_of_path(later) == name_of_path(done);
           });
  });
}

}  // namespace

Sentence why_not_as_ordered(const session::Session& session, const session::Performed& done,
                            const PerformedEntry& told, double begun_intensity) {
  constexpr double max_off_share = PerformedEntry::max_off_share;
  if (std::abs(told.given_n - told.ordered_n) <= max_off_share * told.ordered_n) return {};
  if (begun_again(session, done)) {
    return done.contact_fault == control::ContactFault::none
               ? sentence("why_person_moved", "the person moved; begun again after another scan")
               : sentence("why_begun_again", "cut short: {}; begun again after another scan",
                          control::name_of(done.contact_fault));
  }
  if (done.contact_fault != control::ContactFault::none)
    return sentence("why_cut_short", "cut short: {}", control::name_of(done.contact_fault));
  if (const session::Stop* stop = stopped_by(session, done))
    return sentence("why_stopped", "the session was stopped: {}", safety::name_of(stop->cause));
  if (told.as_ordered())
    return sentence("why_slides", "it slides: its mean was {:.1f} N", told.mean_n);
  const session::Decision* last = nullptr;
  for (const session::Decision& decision : session.decisions) {
    const bool during = decision.path == done.path && decision.time_s <= done.end_s;
    if (during && decision.to_n != decision.from_n && decision.from_n > 0.0) last = &decision;
  }
  if (last != nullptr) {
    Sentence why = sentence("why_decided", "{} ({}: {:.1f} N to {:.1f} N)", last->reason,
                            last->rule, last->from_n, last->to_n);
    why.values.front() = last->key;
    return why;
  }
  if (const auto* command = asked_by_person(session, done))
    return sentence("why_asked", "the person asked for it: {}", session::name_of(*command));
  if (begun_intensity != 1.0)
    return sentence("why_wished", "begun at {:.0f} % of the plan, as wished in an earlier session",
                    100.0 * begun_intensity);
  if (!done.whole) return sentence("why_not_whole", "cut short before its strongest place");
  return told.compared_n() < told.ordered_n
             ? sentence("why_too_short",
                        "the tool did not reach it in the time that the technique gives")
             : sentence("why_swung", "the force swung beyond it");
}

}  // namespace tuina::record
