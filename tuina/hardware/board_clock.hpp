// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <deque>

#include "tuina/core/result.hpp"

namespace tuina::hardware {

/// The clock of a board, microseconds in 32 bits, on the clock of the host. The true moment of a
/// stamp lies between question and answer, so the quickest exchanges tell most; a line through the
/// quickest of each quarter of a second follows a resonator that is wrong by up to 1 %.
class BoardClock {
 public:
  /// One question to the board and its answer.
  struct Exchange {
    double sent_s = 0.0;      ///< on the host's clock
    double received_s = 0.0;  ///< likewise
    std::uint32_t board_us = 0;
  };
  /// Seconds of the board since its first stamp, which count on where its 32 bits wrap around.
  /// Fault::device when it went back, jumped, or is too fast or slow.
  [[nodiscard]] Result<double> add(const Exchange& exchange);
  /// `board_s` of `add` on the host's clock.
  [[nodiscard]] double host_s(double board_s) const;
  [[nodiscard]] double min_round_trip_s() const { return min_round_trip_s_; }

 private:
  struct Anchor {
    double board_s = 0.0;
    double host_s = 0.0;
    double round_trip_s = 0.0;
  };
  void fit();

  std::deque<Anchor> anchors_;  ///< the quickest exchange of each quarter of a second
  std::uint32_t last_us_ = 0;
  double board_s_ = 0.0;
  bool begun_ = false;
  double min_round_trip_s_ = 1e9;
  double at_board_s_ = 0.0, at_host_s_ = 0.0, host_per_board_ = 1.0;
};

}  // namespace tuina::hardware
