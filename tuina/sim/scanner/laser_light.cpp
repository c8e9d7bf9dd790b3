// SPDX-License-Identifier: Apache-2.0
#include "tuina/sim/scanner/laser_light.hpp"

#include <cmath>

namespace tuina::sim {
namespace {

constexpr double red_nm = 635.0, infrared_nm = 808.0;
constexpr double sensor_share = 0.5;  // assumed
constexpr double led_share = 0.01;    // assumed
constexpr double black_dn = 10.0;     // of the sensor, in any light

/// Photons of a black body at 808 nm against those at 635 nm, in equal bands.
double black_body_share(double kelvin) {
  constexpr double c2_nm_kelvin = 1.438777e7;  // h c / k
  const auto photons = [&](double nm) {
    return std::pow(nm, -4.0) / std::expm1(c2_nm_kelvin / (nm * kelvin));
  };
  return photons(infrared_nm) / photons(red_nm);
}

}  // namespace

double wavelength_nm(LaserLight light) noexcept {
  return light == LaserLight::red ? red_nm : infrared_nm;
}

double max_power_w(LaserLight light) noexcept {
  constexpr double class_1_w = 0.39e-3, class_2_w = 1e-3;
  if (light == LaserLight::red) return class_2_w;
  return class_1_w * std::pow(10.0, 0.002 * (infrared_nm - 700.0));
}

double line_share(LaserLight light) noexcept {
  if (light == LaserLight::red) return 1.0;
  return sensor_share * max_power_w(light) / max_power_w(LaserLight::red);
}

double room_share(LaserLight light, Lamp lamp) noexcept {
  constexpr double sun_kelvin = 5772.0, filament_kelvin = 2856.0;
  if (light == LaserLight::red) return 1.0;
  if (lamp == Lamp::led) return sensor_share * led_share;
  return sensor_share * black_body_share(lamp == Lamp::daylight ? sun_kelvin : filament_kelvin);
}

LaserScannerOptions lit_by(LaserLight light, Lamp lamp, LaserScannerOptions red) {
  // mu_s' falls from 32 to 21 per cm from 400 to 800 nm.
  const double scatter_power = std::log(32.0 / 21.0) / std::log(800.0 / 400.0);
  constexpr double melanin_power = -3.48;
  const double longer = wavelength_nm(light) / red_nm;
  LaserScannerOptions lit = std::move(red);
  lit.amplitude_dn *= line_share(light);
  lit.room_light_dn = black_dn + room_share(light, lamp) * (lit.room_light_dn - black_dn);
  lit.flaws.scatter_m *= std::pow(longer, scatter_power);
  lit.flaws.dark_share =
      1.0 - std::pow(1.0 - lit.flaws.dark_share, std::pow(longer, melanin_power));
  return lit;
}

}  // namespace tuina::sim
