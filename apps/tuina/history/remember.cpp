// SPDX-License-Identifier: Apache-2.0
#include "apps/tuina/history/remember.hpp"

#include <fmt/format.h>

#include "tuina/history/remembered.hpp"

namespace tuina::app {
namespace {

std::string day_of(const history::Visit& visit) {
  return visit.began.substr(0, 10);
}

/// Takes over how firm the last session ended; a sentence where that was not as planned.
Sentence wish(const history::Visit& last, const TakenOver& wanted, record::SessionOrder& order) {
  const double percent = 100.0 * last.intensity;
  if (last.intensity > 1.0 && !wanted.as_firm) {
    return sentence("remembered_firmer",
                    "firmer was wished on {}, up to {:.0f} % of the plan; this session begins "
                    "as planned, with --as-firm it begins so",
                    day_of(last), percent);
  }
  if (last.intensity > 1.0 || wanted.softer) order.intensity = last.intensity;
  return sentence("remembered_wish", "begins at {:.0f} % of the planned forces, as wished on {}",
                  percent, day_of(last));
}

}  // namespace

Result<Remembered> remember(history::History& history, const std::string& who,
                            const TakenOver& wanted, record::SessionOrder& order) {
  const auto visits = history.visits_of(who);
  if (!visits) return tl::unexpected(visits.error());
  Remembered remembered;
  const auto say = [&](RememberedKind kind, Sentence words) {
    remembered.lines +=
        (remembered.lines.empty() ? "remembered: " : "\nremembered: ") + words.words;
    remembered.items.push_back({kind, std::move(words)});
  };
  const auto* last = wanted.by_hand ? history::last_said(*visits) : nullptr;
  if (last != nullptr) {
    auto said = record::parse_said(last->said, "session " + last->id + " of the history");
    if (!said) return tl::unexpected(said.error());
    order.said = std::move(*said);
    Sentence words =
        sentence("remembered_by_hand", "{} ruled out and {} put right by hand, as said on {}",
                 order.said->by_hand.no_go.size(), order.said->by_hand.fixed.size(), day_of(*last));
    remembered.by_hand = words.words;
    say(RememberedKind::by_hand, std::move(words));
  }
  last = history::last_wish(*visits);
  if (last != nullptr && last->intensity != 1.0)
    say(RememberedKind::wish, wish(*last, wanted, order));
  last = wanted.tissue ? history::last_felt(*visits, order.position) : nullptr;
  if (last != nullptr) {
    auto known = history::known_tissue(*last, *visits);
    if (!known.places.empty()) {
      say(RememberedKind::tissue,
          sentence("remembered_tissue", "the tissue of {} places, as felt on {}",
                   known.places.size(), day_of(*last)));
      order.known = std::move(known);
    }
  }
  if (!order.known && !order.said) order.known = history::last_lay(*visits, order.position);
  return remembered;
}

}  // namespace tuina::app
