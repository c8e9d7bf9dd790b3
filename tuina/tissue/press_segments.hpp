// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "tuina/core/contact.hpp"
#include "tuina/tissue/force_range.hpp"
#include "tuina/tissue/position_delay.hpp"

namespace tuina::tissue {

/// Times over which tissue remembers force: each decade of relaxation has one.
inline constexpr std::array<double, 3> memory_s = {0.15, 1.5, 12.0};
/// The force behind a first-order low-pass of each of these times.
using Memory = std::array<double, memory_s.size()>;

/// Mean of a stretch of contact with nearly constant force. A one-second press has about fifty, few
/// enough to refit all within a millisecond.
struct PressSegment {
  double time_s = 0.0;
  double position_m = 0.0;
  double force_n = 0.0;
  double speed_m_per_s = 0.0;  ///< tool speed, into the body
  double samples = 0.0;
  double inertia_n = 0.0;  ///< tool inertia, subtracted from the force; maximum of the stretch
  bool contact = true;     ///< false: air, or the skin only just touched
  /// Skin position that a fit found soon after a segment without contact, and its standard
  /// deviation; NaN before the first fit.
  double skin_m = std::numeric_limits<double>::quiet_NaN(), skin_sd_m = 0.0;
  Memory memory_n = {};
  int press = 0;  ///< presses before the one it belongs to
};

/// Noise of the samples, and how they are cut into segments.
struct SegmentOptions {
  double force_noise_n = 0.2;      ///< one standard deviation of one sample
  double contact_sd_m = 0.5e-3;    ///< prior standard deviation of the skin position
  double force_delay_s = 0.0;      ///< age of the force against the position beside it
  double tool_mass_kg = 0.0;       ///< mass beyond the force sensor, whose inertia it measures
  std::size_t max_segments = 128;  ///< at most `capacity`; beyond, the oldest is dropped
};

/// Compresses samples into segments: delays the position to match the force, tares the force before
/// the first contact, subtracts the tool's inertia, averages, and counts presses. Drops samples
/// that are non-finite or out of order; of saturated ones only what the tissue remembers counts. No
/// heap.
class PressSegments {
 public:
  static constexpr std::size_t capacity = 512;

  /// Without a segment.
  explicit PressSegments(const SegmentOptions& options) noexcept;

  /// Takes a sample, in the order of time.
  void add(double time_s, const Press& sample) noexcept;

  /// Takes in the samples that wait for their block and ends the newest segment.
  void close() noexcept;

  [[nodiscard]] std::size_t size() const noexcept { return size_; }  ///< segments that are kept
  /// Those of `size` that will not change any more.
  [[nodiscard]] std::size_t closed() const noexcept { return open_ ? size_ - 1 : size_; }
  /// The i-th kept segment, from the oldest.
  [[nodiscard]] const PressSegment& operator[](std::size_t i) const noexcept {
    return segments_[i];
  }
  /// Notes where the skin was in a segment, and how well that is known.
  void record_skin(std::size_t i, double skin_m, double skin_sd_m) noexcept {
    segments_[i].skin_m = skin_m;
    segments_[i].skin_sd_m = skin_sd_m;
  }
  /// Forgets so many of the oldest segments.
  void drop_oldest(std::size_t count) noexcept;

  [[nodiscard]] int presses() const noexcept { return presses_; }  ///< completed presses
  [[nodiscard]] double peak_force_n() const noexcept { return peak_ever_n_; }
  [[nodiscard]] double first_contact_s() const noexcept { return first_contact_s_; }
  /// Where that was.
  [[nodiscard]] double first_contact_m() const noexcept { return first_contact_m_; }
  /// Whether there was contact since the start.
  [[nodiscard]] bool ever_touched() const noexcept { return touched_; }
  /// Whether most samples come too late for what the tissue remembers to be known between them.
  [[nodiscard]] bool too_slow() const noexcept { return 2 * gaps_ > steps_; }
  [[nodiscard]] double now_s() const noexcept { return last_time_s_; }
  [[nodiscard]] double tare_n() const noexcept;
  [[nodiscard]] double tare_sd_n()
      const noexcept;  ///< infinite without free air before the contact
  /// Blocks of samples that became part of a segment.
  [[nodiscard]] long accepted_blocks() const noexcept { return blocks_; }
  [[nodiscard]] const Memory& memory_n() const noexcept { return memory_n_; }  ///< at `now_s`

 private:
  struct Sum {
    double time_s = 0.0, position_m = 0.0, force_n = 0.0, samples = 0.0, inertia_n = 0.0;
    Memory memory_n = {};
    bool saturated = false, after_gap = false;
  };
  using Block = Sum;  // means instead of sums

  void close_block() noexcept;
  void take_inertia_off(const Block& newest) noexcept;
  void accept(const Block& block) noexcept;
  void tare(double position_m, double force_n, double samples) noexcept;
  void follow_press(double time_s, double force_n) noexcept;
  void remember(double time_s, double force_n, bool after_gap) noexcept;
  void append(const Block& block) noexcept;
  void push_air() noexcept;
  void remember_air(const Block& block) noexcept;
  static void join(PressSegment& segment, const Block& block) noexcept;
  void push(const PressSegment& segment) noexcept;

  SegmentOptions options_;
  std::array<PressSegment, capacity> segments_{};
  std::size_t size_ = 0;
  bool open_ = false;  // the newest segment may still grow
  double opened_s_ = 0.0;
  double opened_root_ = 0.0;
  double opened_m_ = 0.0;

  std::array<PressSegment, 8> air_{};  // the last stretches before contact
  std::size_t air_size_ = 0;

  PositionDelay positions_;

  std::array<Block, 5> recent_{};  // the middle one waits until its acceleration is known
  std::size_t recent_size_ = 0;

  Sum block_;
  double block_start_s_ = 0.0;
  Sum free_air_;
  bool tare_begun_ = false, began_near_ = false;
  double last_time_s_ = 0.0;
  ForceRange range_;
  bool started_ = false, touched_ = false, gap_ = false;
  double first_contact_s_ = 0.0, first_contact_m_ = 0.0, last_accepted_s_ = 0.0;

  bool in_contact_ = false;
  enum class Phase : std::uint8_t { rest, up, down } phase_ = Phase::rest;
  double released_s_ = 0.0;
  double peak_n_ = 0.0, valley_n_ = 0.0, peak_ever_n_ = 0.0;
  int presses_ = 0;
  int press_ = 0;  // that of now: a press goes on until the skin is left or the next one rises
  long blocks_ = 0, steps_ = 0, gaps_ = 0;
  Memory memory_n_ = {};
  double remembered_s_ = -std::numeric_limits<double>::infinity();
};

}  // namespace tuina::tissue
