// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "tuina/core/result.hpp"

namespace tuina::session {

/// Everything that a file or `--set` may change, one struct per TOML section. The numbers are in
/// the units that the key in the file carries, as written there; defaults live here and nowhere
/// else.
struct Config {
  /// The keys of [scan].
  struct Scan {
    double sweep_s = 6.0;               ///< time of one sweep
    double sweep_deg = 36.0;            ///< angle of one sweep, symmetric about straight ahead
    std::string method = "likelihood";  ///< laser line: centroid or likelihood
  } scan;
  /// The keys of [massage].
  struct Massage {
    double standoff_mm = 40.0;  ///< above the skin, where an approach starts and a retract ends
    double force_scale = 1.0;   ///< on every force of the programme
    bool steer = true;          ///< the tissue estimate feeds the virtual target
    bool cautious = true;       ///< no jump to a force that the felt tissue does not foretell
  } massage;
  /// The keys of [safety].
  struct Safety {
    double force_ceiling_n = 45.0;  ///< on the set force; zones may ask for less
  } safety;
  /// The keys of [simulation].
  struct Simulation {
    std::string realism = "usual";  ///< sets all effects; those named after it differ from it
    /// What the arms of `tuina massage` take: torques, or places in cycles of 500 or 125 Hz.
    std::string arms = "torque";
    double breathing_mm = 3.0;
    double breathing_hz = 0.25;
    double friction = 1.0;             ///< scale on the joint friction of the plant
    double room_light_dn = 10.0;       ///< brightness of the room without the laser
    double shift_mm = 0.0;             ///< the person moves once, so far towards the arms
    double shift_at_s = 30.0;          ///< into the massage
    double tissue_change_share = 0.0;  ///< alpha of all tissue against what the person has usually
    // Effects; session/realism has their numbers and where those are from.
    double torso_n_per_mm = 0.0;
    double torso_mass_kg = 0.0;
    double fat_share = 0.0;
    double relaxing_share = 0.0;
    double tissue_damping_s_per_m = 0.0;
    double first_press_stiffer_share = 0.0;
    double tensing_share = 0.0;
    double tensing_probability = 0.0;
    double tissue_grain_share = 0.0;
    double tissue_place_share = 0.0;
    double skin_friction = 0.0;
    double skin_shear_n_per_mm = 0.0;
    double breath_variation = 0.0;
    double sigh_share = 0.0;
    double speaking_share = 0.0;
    double coughs_per_h = 0.0;
    double gear_softness = 0.0;
    double backlash_arcmin = 0.0;
    double torque_ripple_share = 0.0;
    double friction_drift_share = 0.0;
    double wrist_drift_n_per_min = 0.0;
    double wrist_hysteresis_share = 0.0;
    double wrist_crosstalk_share = 0.0;
    double tool_weight_error_share = 0.0;
    double scatter_mm = 0.0;
    double skin_dark_share = 0.0;
    double moles_per_dm2 = 0.0;
    double hair_share = 0.0;
    double sweat_share = 0.0;
    double lamp_flicker_share = 0.0;
    double rolling_shutter_ms = 0.0;

    Simulation();  ///< as usual
  } simulation;
};

/// Reads a TOML file over the defaults. All faults are in the one message, a line each, with file,
/// line, key, value and what would be right; a near miss is suggested.
[[nodiscard]] Result<Config> load_config(const std::filesystem::path& file);
/// Reads a configuration from text; `name` stands in the message of a refusal.
[[nodiscard]] Result<Config> parse_config(std::string_view text, std::string_view name);

/// `section.key=value` over a config, as --set gives it; a fault is wrong use.
[[nodiscard]] Result<void> apply_setting(Config& config, std::string_view setting);

/// The whole config as TOML, with the limits as comments; parse_config reads it back.
[[nodiscard]] std::string to_toml(const Config& config);

}  // namespace tuina::session
