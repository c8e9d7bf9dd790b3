// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tuina/sim/scanner/laser_scanner.hpp"

namespace tuina::sim {

/// What the scanner's laser shines with; the camera has a bandpass filter of 30 nm for it.
enum class LaserLight : std::uint8_t { red, infrared };
[[nodiscard]] double wavelength_nm(LaserLight light) noexcept;  ///< 635 and 808

/// What lights the room.
enum class Lamp : std::uint8_t { led, daylight, incandescent };

/// Power through the pupil of an eye that a laser for people may have, in W: in red light class 2,
/// which counts on the eye's blink; in infrared the eye does not blink, and class 1 is left, 0.39
/// mW times C4 = 10^(0.002 (nm - 700)) [iec60825].
[[nodiscard]] double max_power_w(LaserLight light) noexcept;

/// The line's brightness in the picture against that of red light: by the power that is allowed,
/// and by the sensor, of which half the response at 635 nm is assumed at 808 nm.
[[nodiscard]] double line_share(LaserLight light) noexcept;

/// A lamp's light behind the filter against that of the same lamp behind a red one, sensor
/// included: daylight as a black body of 5772 K, incandescent lamps of 2856 K; of white LEDs, and
/// likewise of fluorescent tubes, 1 % is assumed.
[[nodiscard]] double room_share(LaserLight light, Lamp lamp) noexcept;

/// A scanner, its room and the skin before it, given as they are in red light, in this light. Light
/// goes farther in skin by mu_s' of [marchesini1992], and melanin swallows less, by the power -3.48
/// of the wavelength [jacques1998]. Moles and hair stay as dark as in red light.
[[nodiscard]] LaserScannerOptions lit_by(LaserLight light, Lamp lamp, LaserScannerOptions red);

}  // namespace tuina::sim
