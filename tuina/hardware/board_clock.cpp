// SPDX-License-Identifier: Apache-2.0
#include "tuina/hardware/board_clock.hpp"

#include <algorithm>
#include <cmath>

namespace tuina::hardware {
namespace {

constexpr double anchor_every_s = 0.25;
constexpr std::size_t max_anchors = 120;
constexpr double max_drift = 0.01;     // a ceramic resonator is good to 0.5 %
constexpr double usual_drift = 0.003;  // standard deviation, of what is expected before it is seen
constexpr double max_jump_s = 0.02;    // beside what the round trip leaves open
constexpr double drift_known_s = 2.0;  // before that a slow exchange may still look like drift

}  // namespace

Result<double> BoardClock::add(const Exchange& exchange) {
  const double round_trip_s = exchange.received_s - exchange.sent_s;
  const double middle_s = 0.5 * (exchange.received_s + exchange.sent_s);
  // As a signed difference, so that a step back is seen as one.
  const auto step_us = static_cast<std::int32_t>(exchange.board_us - last_us_);
  if (begun_ && step_us < 0) {
    return fail(Fault::device,
                "its clock went back by {:.3f} s: it has started anew; is its supply too weak?",
                -1e-6 * step_us);
  }
  if (begun_) board_s_ += 1e-6 * step_us;
  last_us_ = exchange.board_us;
  if (begun_) {
    const double off_s = std::abs(host_s(board_s_) - middle_s);
    const double unknown_s = anchors_.back().board_s - anchors_.front().board_s < drift_known_s
                                 ? max_drift * (board_s_ - anchors_.front().board_s)
                                 : 0.0;
    if (off_s > max_jump_s + 0.5 * round_trip_s + unknown_s) {
      return fail(Fault::device, "its clock jumped by {:.3f} s against this machine's", off_s);
    }
  }
  begun_ = true;
  min_round_trip_s_ = std::min(min_round_trip_s_, round_trip_s);
  const Anchor anchor{board_s_, middle_s, round_trip_s};
  if (anchors_.empty() || std::floor(board_s_ / anchor_every_s) >
                              std::floor(anchors_.back().board_s / anchor_every_s)) {
    anchors_.push_back(anchor);
    if (anchors_.size() > max_anchors) anchors_.pop_front();
  } else if (round_trip_s < anchors_.back().round_trip_s) {
    anchors_.back() = anchor;
  }
  fit();
  return board_s_;
}

void BoardClock::fit() {
  // An exchange is wrong by up to half of its round trip, so it counts by the square of that.
  double w = 0.0, b = 0.0, h = 0.0;
  const auto weight = [&](const Anchor& anchor) {
    const double loose_s = anchor.round_trip_s - min_round_trip_s_ + 1e-4;
    return 1.0 / (loose_s * loose_s);
  };
  for (const Anchor& anchor : anchors_) {
    w += weight(anchor);
    b += weight(anchor) * anchor.board_s;
    h += weight(anchor) * (anchor.host_s - anchor.board_s);
  }
  at_board_s_ = b / w;
  const double ahead_s = h / w;
  double bb = 0.0, bh = 0.0;
  for (const Anchor& anchor : anchors_) {
    const double from_s = anchor.board_s - at_board_s_;
    bb += weight(anchor) * from_s * from_s;
    bh += weight(anchor) * from_s * (anchor.host_s - anchor.board_s - ahead_s);
  }
  // Least squares with what is expected: while few exchanges, or slow ones, tell of the drift, it
  // is taken as small.
  const double drift =
      std::clamp(bh / (bb + 1.0 / (usual_drift * usual_drift)), -max_drift, max_drift);
  at_host_s_ = at_board_s_ + ahead_s;
  host_per_board_ = 1.0 + drift;
}

double BoardClock::host_s(double board_s) const {
  return at_host_s_ + host_per_board_ * (board_s - at_board_s_);
}

}  // namespace tuina::hardware
