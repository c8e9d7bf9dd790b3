// SPDX-License-Identifier: Apache-2.0
#include "apps/tuina/history/visit_option.hpp"

#include "apps/tuina/history/open.hpp"
#include "tuina/history/person_history.hpp"

namespace tuina::app {

Option VisitOption::describe(Options& options) {
  auto who = options.add("--who", who_,
                         "a pseudonym: the session joins the history of this person, `tuina "
                         "history show`");
  add_history_option(options, address_).needs(who);
  auto anew = options.flag("--anew", anew_,
                           "use nothing of this person's earlier sessions: neither what was said "
                           "by hand, nor wishes, nor tissue");
  anew.needs(who);
  options
      .flag("--as-firm", taken_over_.as_firm,
            "begin as firm as wished in the last session, also where that is firmer than planned")
      .needs(who)
      .excludes(anew);
  options
      .flag("--known-tissue", taken_over_.tissue,
            "probe places by what the last session has felt: one press where it comes as known")
      .needs(who)
      .excludes(anew);
  return who;
}

Result<void> VisitOption::begin(record::SessionOrder& order, const std::filesystem::path& folder) {
  if (who_.empty()) return {};
  if (auto right = history::check_name(who_); !right) return right;
  auto history = KeptHistory::open(address_);
  if (!history) return tl::unexpected(history.error());
  if (!anew_) {
    const auto whole = history->whole();
    if (!whole) {
      // What was ruled out by hand must not be forgotten because a cable is loose.
      return fail(
          whole.error().fault,
          "{}; --anew begins with nothing of earlier sessions, and this one is entered once "
          "the server answers",
          whole.error().message);
    }
    // Sessions of this robot that wait may be this person's.
    if (const auto caught_up = history->catch_up(); !caught_up)
      return tl::unexpected(caught_up.error());
    auto remembered = remember(**whole, who_, taken_over_, order);
    if (!remembered) return tl::unexpected(remembered.error());
    remembered_ = std::move(*remembered);
  }
  folder_ = std::filesystem::absolute(folder).lexically_normal();
  label_ = new_visit(who_);
  if (auto noted = history->own().begin(*label_, folder_); !noted) return noted;
  static_cast<void>(history->catch_up());  // where it does not go, the end of the session says so
  history_ = std::move(*history);
  return {};
}

Error VisitOption::with_remembered(Error error) const {
  if (!remembered_.by_hand.empty()) {
    error.message +=
        fmt::format("; of {}: {}; --anew begins without it", who_, remembered_.by_hand);
  }
  return error;
}

void VisitOption::take_back() {
  if (history_ && label_) history_->take_back(*label_);
}

Result<std::string> VisitOption::end(const record::SessionFile& file) {
  const auto visit = history::visit_of(file, folder_);
  if (const auto added = history_->own().add(visit); !added)
    return fail(added.error().fault,
                "{}; the session is whole in {}, and `tuina history rebuild {}` enters it",
                added.error().message, folder_.string(), folder_.string());
  const auto delivered = history_->catch_up();
  if (!delivered || !delivered->refused.empty()) {
    return fmt::format("{}: the session waits in {}: {}", who_, history_->outbox(),
                       delivered ? delivered->refused.front() : delivered.error().message);
  }
  const auto whole = history_->whole();
  if (!whole) return tl::unexpected(whole.error());
  const auto visits = (*whole)->visits_of(who_);
  if (!visits) return tl::unexpected(visits.error());
  std::string text = fmt::format("{}: session {}", who_, visits->size());
  if (!remembered_.lines.empty()) text += "\n" + remembered_.lines;
  if (!taken_over_.as_firm && file.massage.intensity > 1.0)
    text += "\nfirmer was wished: the next session begins so with --as-firm only";
  if (const auto last = history::last_change(*visits)) text += "\n" + history::sentence_of(*last);
  return text;
}

}  // namespace tuina::app
