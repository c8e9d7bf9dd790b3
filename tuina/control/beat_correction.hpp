// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace tuina::control {

/// Corrects each beat of a force by the one before. Within a beat no feedback is quick enough for
/// tissue that is softer or harder than believed, but it answers the next beat as it did the last.
/// The first beat is light, and each one at most twice what the last was felt to be. Real-time.
class BeatCorrection {
 public:
  /// Bounds of the correction from beat to beat.
  struct Options {
    double kept_n = 3.0;       ///< force between two beats
    double first_n = 10.0;     ///< largest force of the first beat
    double first_share = 0.9;  ///< largest share of the wanted force for the first beat
    double aim = 0.985;        ///< share of what is wanted: the true force swings about its goal
    double share = 0.8;        ///< of the error of a beat, made up for in the next
    double max_rise = 2.0;     ///< of a beat's goal over what was felt of the beat before
    double max_gain = 2.0;     ///< of what is commanded against what is wanted
    /// Of the correction, once a beat has come to that share of what it was to be: tissue that has
    /// answered so does not give way all at once, but a person leaves the tool for a beat.
    double max_growth = 1.2, came_share = 0.8;
  };

  BeatCorrection() = default;
  /// Before the first beat.
  explicit BeatCorrection(const Options& options) noexcept : options_(options) {}

  /// Another place: beats up to `strongest_n` follow.
  void begin(double strongest_n) noexcept;
  /// What to command now for a force that is wanted; `felt_n` is measured.
  [[nodiscard]] double command_n(double wanted_n, double felt_n) noexcept;

 private:
  void learn() noexcept;

  Options options_;
  double gain_ = 1.0, last_wanted_n_ = 0.0;
  double wanted_n_ = 0.0, felt_n_ = 0.0;  // largest of this beat
  bool rose_ = false, came_ = false;
};

}  // namespace tuina::control
