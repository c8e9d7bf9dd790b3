// SPDX-License-Identifier: Apache-2.0
#include "apps/tuina/history/people_of_page.hpp"

#include "apps/tuina/history/kept_history.hpp"
#include "apps/tuina/history/open.hpp"
#include "apps/tuina/history/remember.hpp"
#include "tuina/history/person_history.hpp"

namespace tuina::app {
namespace {

/// The history with all that waited for its server.
Result<KeptHistory> open_whole(const std::string& address) {
  auto history = KeptHistory::open(address);
  if (!history) return history;
  if (const auto whole = history->whole(); !whole) return tl::unexpected(whole.error());
  if (const auto caught_up = history->catch_up(); !caught_up)
    return tl::unexpected(caught_up.error());
  return history;
}

Result<std::vector<std::string>> names_in(const std::string& address) {
  auto history = open_whole(address);
  if (!history) return tl::unexpected(history.error());
  const auto people = (*history->whole())->people();
  if (!people) return tl::unexpected(people.error());
  std::vector<std::string> names;
  for (const history::Person& one : *people) names.push_back(one.name);
  return names;
}

Result<RememberedPerson> find_in(const std::string& address, const std::string& who,
                                 std::optional<BodyPosture> position) {
  if (auto right = history::check_name(who); !right) return tl::unexpected(right.error());
  auto history = open_whole(address);
  if (!history) return tl::unexpected(history.error());
  const auto visits = (*history->whole())->visits_of(who);
  if (!visits) return tl::unexpected(visits.error());
  record::SessionOrder order{.position = position};
  auto remembered = remember(**history->whole(), who, {.as_firm = true, .tissue = true}, order);
  if (!remembered) return tl::unexpected(remembered.error());
  RememberedPerson found{.sessions = visits->size(), .items = std::move(remembered->items)};
  if (const auto last = history::last_change(*visits)) found.changes = sentences_of(*last);
  return found;
}

Result<record::VisitLabel> begin_in(const std::string& address, const std::string& who,
                                    const Confirmed& confirmed, record::SessionOrder& order,
                                    const std::filesystem::path& folder) {
  const auto found = find_in(address, who, order.position);
  if (!found) return tl::unexpected(found.error());
  for (const RememberedItem& item : found->items) {
    if (confirmed[static_cast<std::size_t>(item.kind)]) continue;
    return fail(Fault::bad_input, "remember: whether {} is to be used was not said: {}",
                name_of(item.kind), item.words.words);
  }
  const auto yes = [&](RememberedKind kind) {
    return confirmed[static_cast<std::size_t>(kind)].value_or(false);
  };
  auto history = open_whole(address);
  if (!history) return tl::unexpected(history.error());
  const bool wish = yes(RememberedKind::wish);
  const auto remembered = remember(**history->whole(), who,
                                   {.as_firm = wish,
                                    .tissue = yes(RememberedKind::tissue),
                                    .by_hand = yes(RememberedKind::by_hand),
                                    .softer = wish},
                                   order);
  if (!remembered) return tl::unexpected(remembered.error());
  record::VisitLabel label = new_visit(who);
  const auto whole_path = std::filesystem::absolute(folder).lexically_normal();
  if (auto noted = history->own().begin(label, whole_path); !noted)
    return tl::unexpected(noted.error());
  static_cast<void>(history->catch_up());  // where it does not go, it waits
  return label;
}

void take_back_in(const std::string& address, const record::VisitLabel& visit) {
  if (auto history = KeptHistory::open(address)) history->take_back(visit);
}

Result<std::vector<Sentence>> end_in(const std::string& address, const record::SessionFile& file,
                                     const std::filesystem::path& folder) {
  auto history = KeptHistory::open(address);
  if (!history) return tl::unexpected(history.error());
  const auto visit = history::visit_of(file, std::filesystem::absolute(folder).lexically_normal());
  if (auto added = history->own().add(visit); !added) return tl::unexpected(added.error());
  // Where the server is away the session waits, and what has changed is told another time.
  if (!history->catch_up()) return std::vector<Sentence>();
  const auto whole = history->whole();
  if (!whole) return std::vector<Sentence>();
  const auto visits = (*whole)->visits_of(visit.who);
  if (!visits) return tl::unexpected(visits.error());
  const auto last = history::last_change(*visits);
  return last ? sentences_of(*last) : std::vector<Sentence>();
}

}  // namespace

KnownPeople people_of_page(const std::string& address) {
  return {
      .names = [address] { return names_in(address); },
      .find = [address](const auto& who, auto position) { return find_in(address, who, position); },
      .begin = [address](
                   const auto& who, const auto& confirmed, auto& order,
                   const auto& folder) { return begin_in(address, who, confirmed, order, folder); },
      .take_back = [address](const auto& visit) { take_back_in(address, visit); },
      .end = [address](const auto& file,
                       const auto& folder) { return end_in(address, file, folder); }};
}

}  // namespace tuina::app
