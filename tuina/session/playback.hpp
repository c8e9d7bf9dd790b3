// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace tuina::session {

/// A value that goes to where it is sent within half a second, without a jump of itself or of its
/// speed: a critically damped second order. After 100 ms it has gone a fifth of the way.
class Eased {
 public:
  /// At rest at the value.
  explicit Eased(double value) noexcept : value_(value), goal_(value) {}
  /// Sets the value it goes to.
  void send_to(double goal) noexcept { goal_ = goal; }
  /// One tick nearer to the goal.
  void step(double dt_s) noexcept {
    constexpr double rate_per_s = 8.0;
    speed_ += dt_s * (rate_per_s * rate_per_s * (goal_ - value_) - 2.0 * rate_per_s * speed_);
    value_ += dt_s * speed_;
  }
  [[nodiscard]] double value() const noexcept { return value_; }  ///< where it is
  [[nodiscard]] double goal() const noexcept { return goal_; }    ///< where it goes

 private:
  double value_, goal_, speed_ = 0.0;
};

/// How one arm goes through a path while people interfere: the time along it, and what becomes of
/// the force that was planned. Real-time.
class Playback {
 public:
  /// A path begins, at a time along it. The intensity and a pause last from path to path.
  void begin(double path_s) noexcept;
  /// Stands still on the path, or goes on.
  void pause(bool paused) noexcept;
  /// On every force from now on, 1 leaves it as planned.
  void scale(double intensity) noexcept { intensity_.send_to(intensity); }
  /// The force goes away; `faded` when it has.
  void fade() noexcept { fading_.send_to(0.0); }
  /// One tick along the path.
  void step(double dt_s) noexcept;

  [[nodiscard]] double path_s() const noexcept { return path_s_; }
  /// Seconds of the path per second.
  [[nodiscard]] double rate() const noexcept { return rate_.value(); }
  /// What becomes of a planned force.
  [[nodiscard]] double force_n(double planned_n) const noexcept;
  /// Whether `fade` was called in this path.
  [[nodiscard]] bool fading() const noexcept { return fading_.goal() == 0.0; }
  /// Whether hardly any force is left of it.
  [[nodiscard]] bool faded() const noexcept { return fading() && fading_.value() < 0.1; }
  /// Whether it stands still, or is about to.
  [[nodiscard]] bool paused() const noexcept { return rate_.goal() == 0.0; }
  /// Factor on every force, as last set.
  [[nodiscard]] double intensity() const noexcept { return intensity_.goal(); }

 private:
  double path_s_ = 0.0;
  Eased rate_{1.0}, intensity_{1.0}, fading_{1.0};
};

}  // namespace tuina::session
