// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <numbers>

namespace tuina {

inline constexpr double pi = std::numbers::pi;
inline constexpr double gravity_m_per_s2 = 9.81;

/// Units for constants: `constexpr double rub_radius_m = 30_mm;`. Values inside tuina are SI.
inline namespace units {
/// @{
/// Metres from millimetres, and radians from degrees.
constexpr double operator""_mm(long double x) {
  return static_cast<double>(x) * 1e-3;
}
constexpr double operator""_mm(unsigned long long x) {
  return static_cast<double>(x) * 1e-3;
}
constexpr double operator""_deg(long double x) {
  return static_cast<double>(x) * pi / 180.0;
}
constexpr double operator""_deg(unsigned long long x) {
  return static_cast<double>(x) * pi / 180.0;
}
/// @}
}  // namespace units

/// Conversions for the command line, config and reports, the only places with degrees and
/// millimetres.
constexpr double to_mm(double metres) {
  return metres * 1e3;
}
/// @{
/// A number in one unit from the other; metres and radians are inside.
constexpr double from_mm(double millimetres) {
  return millimetres * 1e-3;
}
constexpr double to_deg(double radians) {
  return radians * 180.0 / pi;
}
constexpr double from_deg(double degrees) {
  return degrees * pi / 180.0;
}
/// @}

}  // namespace tuina
