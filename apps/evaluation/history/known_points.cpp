// SPDX-License-Identifier: Apache-2.0
#include "apps/evaluation/history/known_points.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "apps/evaluation/acupoints/trials.hpp"
#include "apps/simulated/bad_scans.hpp"
#include "apps/simulated/scanned_people.hpp"
#include "tuina/body/palpation.hpp"
#include "tuina/core/random.hpp"
#include "tuina/core/units.hpp"
#include "tuina/session/earlier/by_hand.hpp"

namespace tuina::app {
namespace {

using body::LabelledBody;

/// Standard deviations of posture, as people differ (models/phantom.csv), and of the place.
struct PostureSpread {
  double bend_rad, turn_rad, twist_rad, aside_m;
};
constexpr PostureSpread sitting_spread{3_deg, 5.8_deg, 2.5_deg, 20_mm};
constexpr PostureSpread prone_spread{4.3_deg, 1.9_deg, 2_deg, 20_mm};

LabelledBody in_another_posture(LabelledBody person, Random& random) {
  const PostureSpread& spread =
      person.position == BodyPosture::sitting ? sitting_spread : prone_spread;
  bend(person, gaussian(random, spread.bend_rad));
  twist(person, gaussian(random, spread.twist_rad));
  const Eigen::AngleAxisd turn(gaussian(random, spread.turn_rad), Vector3::UnitZ());
  const Vector3 aside(gaussian(random, spread.aside_m), gaussian(random, spread.aside_m), 0.0);
  for (Vector3& p : person.skin_in_couch.vertices) p = turn * p + aside;
  for (Acupoint& point : person.acupoints) {
    point.at_in_couch = turn * point.at_in_couch + aside;
    point.normal_in_couch = turn * point.normal_in_couch;
  }
  for (Landmark& landmark : person.landmarks)
    landmark.at_in_couch = turn * landmark.at_in_couch + aside;
  return person;
}

struct Mapped {
  body::BackSurface back;
  body::Mapping located;
};

Result<Mapped> scan_and_map(const LabelledBody& person, const body::Atlas& atlas,
                            std::uint64_t seed) {
  auto seen = see(person, {.by = Scan::By::laser}, seed);
  if (!seen) return tl::unexpected(seen.error());
  auto back = body::fit_back(seen->cloud_in_couch, {.position = person.position});
  if (!back) return tl::unexpected(back.error());
  auto located = body::locate_acupoints(*back, atlas);
  if (!located) return tl::unexpected(located.error());
  return Mapped{std::move(*back), std::move(*located)};
}

/// Mean over the seven, and how many of them lie within their radius.
std::pair<double, int> judged(const body::Mapping& mapping, const LabelledBody& truth) {
  double error_mm = 0.0;
  int within = 0;
  for (std::size_t i = 0; i < seven_acupoints.size(); ++i) {
    const Acupoint& found = mapping.acupoints[i];
    const double off_m = (found.at_in_couch - truth.acupoints[i].at_in_couch).norm();
    error_mm += to_mm(off_m) / static_cast<double>(seven_acupoints.size());
    within += off_m <= found.uncertainty_m ? 1 : 0;
  }
  return {error_mm, within};
}

/// What a session takes over of an earlier one, or why it does not.
Result<body::Mapping> with_history(const Mapped& now, const session::Said& said) {
  const auto carried = session::carried(said, now.located.acupoints, session::max_other_misfit_m);
  if (!carried) return tl::unexpected(carried.error());
  return body::fix_points(now.located, now.back, carried->fixed);
}

}  // namespace

/// What it leaves: the acupoints by its scan, and all of them as a finger shows them. Without
/// points there was none.
struct ReturningPeople::FirstSession {
  std::string refused;
  std::vector<Acupoint> lay, shown;

  [[nodiscard]] session::Said said(const std::vector<std::string>& names) const {
    session::Said said{.by_hand = {}, .lay = lay};
    for (const Acupoint& point : shown)
      if (std::ranges::find(names, point.name) != names.end())
        said.by_hand.fixed.push_back({point.name, point.at_in_couch, from_mm(finger_error_mm)});
    return said;
  }
};

ReturningPeople::ReturningPeople(std::vector<LabelledBody> people, body::Atlas atlas,
                                 std::uint64_t seed)
    : people_(std::move(people)),
      atlas_(std::move(atlas)),
      seed_(seed),
      first_(people_.size()),
      had_first_(people_.size()) {}

ReturningPeople::ReturningPeople(ReturningPeople&&) noexcept = default;
ReturningPeople::~ReturningPeople() = default;

const ReturningPeople::FirstSession& ReturningPeople::first_session(std::size_t who) {
  std::call_once(had_first_[who], [&] {
    auto first = std::make_unique<FirstSession>();
    Random random = make_random(seed_ + who, "posture of the first session");
    const LabelledBody person = in_another_posture(people_[who], random);
    const auto mapped = scan_and_map(person, atlas_, seed_ + who);
    if (mapped) {
      first->lay = mapped->located.acupoints;
      first->shown = marked(person.acupoints, finger_error_mm * std::sqrt(2.0), seed_ + who);
    } else {
      first->refused = mapped.error().message;
    }
    first_[who] = std::move(first);
  });
  return *first_[who];
}

PointsOutcome ReturningPeople::come_back(std::size_t who) {
  PointsOutcome outcome;
  const FirstSession& own = first_session(who);
  if (!own.refused.empty()) return {.refused = "at first: " + own.refused};
  Random random = make_random(seed_ + who, "posture of the second session");
  const LabelledBody person = in_another_posture(people_[who], random);
  const auto now = scan_and_map(person, atlas_, seed_ + who + 1'000'000);
  if (!now) return {.refused = now.error().message};
  if (const auto motion = session::fit_motion(own.lay, now->located.acupoints))
    outcome.misfit_mm = to_mm(motion->misfit_m);
  const auto [stranger_mm, stranger_within] = judged(now->located, person);
  for (const auto& names : shown_sets) {
    const auto known = with_history(*now, own.said(names));
    const auto [error_mm, within] =
        known ? judged(*known, person)
              : std::pair(std::numeric_limits<double>::quiet_NaN(), stranger_within);
    outcome.error_mm.push_back(error_mm);
    outcome.within.push_back(within);
  }
  for (std::size_t other = 0; other < people_.size(); ++other) {
    if (other == who || people_[other].position != person.position) continue;
    const FirstSession& wrong = first_session(other);
    if (!wrong.refused.empty()) continue;
    ++outcome.others;
    const auto misled = with_history(*now, wrong.said(shown_sets[1]));
    if (!misled) {
      ++outcome.noticed;
      continue;
    }
    const auto [error_mm, within] = judged(*misled, person);
    outcome.harm_mm.push_back(error_mm - stranger_mm);
    outcome.beyond += std::max(0, stranger_within - within);
  }
  return outcome;
}

}  // namespace tuina::app
