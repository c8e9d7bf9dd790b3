// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>

#include "tuina/core/arm.hpp"

namespace tuina::hardware {

/// The card between a computer and amplifiers with an analog input, as the thesis has one: it sets
/// volts and counts encoders. Who has such a card fills in its two functions. Channels are the left
/// arm's joints from the shoulder on, then the right arm's.
///
/// The card must have a watchdog of its own: without a `write` for 20 ms it powers no amplifier,
/// and the brakes close.
class DacEncoder {
 public:
  virtual ~DacEncoder() = default;
  /// Volts at the amplifiers. An arm that is not powered has its amplifiers off and its brakes
  /// closed.
  virtual void write(std::span<const double> volts, const PerArm<bool>& powered) noexcept = 0;
  /// Encoder counts; false where the card gave none.
  [[nodiscard]] virtual bool read(std::span<std::int64_t> counts) noexcept = 0;

 protected:
  DacEncoder() = default;
  DacEncoder(const DacEncoder&) = default;
  DacEncoder& operator=(const DacEncoder&) = default;
};

}  // namespace tuina::hardware
