// SPDX-License-Identifier: Apache-2.0
#include "tuina/session/realism.hpp"

namespace tuina::session {
namespace {

using Simulation = Config::Simulation;

constexpr SimulatedEffect effects[] = {
    // The person. Each draws their own numbers within a fifth of these.
    {"simulation.torso_n_per_mm", &Simulation::torso_n_per_mm, 35, 20, 12, 5, 1000,
     "10 to 35 N/mm; chests under resuscitation 8 to 13"},
    {"simulation.torso_mass_kg", &Simulation::torso_mass_kg, 0, 6, 4, 0, 20,
     "3 to 10 kg, damping ratio 0.2 to 0.4: unverified"},
    {"simulation.fat_share", &Simulation::fat_share, 0, 0.4, 0.55, 0, 0.6,
     "[isogai2022]: fat is used up before muscle"},
    {"simulation.relaxing_share", &Simulation::relaxing_share, 0, 0.25, 0.4, 0, 0.6,
     "[zheng1999]: 3 to 28 %; [palevski2006]: more"},
    {"simulation.tissue_damping_s_per_m", &Simulation::tissue_damping_s_per_m, 0, 3, 8, 0, 20,
     "[huntcrossley1975]; sizes unverified"},
    {"simulation.first_press_stiffer_share", &Simulation::first_press_stiffer_share, 0, 0.1, 0.2, 0,
     1, "[palevski2006], milder"},
    {"simulation.tensing_share", &Simulation::tensing_share, 0, 0.3, 0.6, 0, 1,
     "guarding: 20 to 100 %, unverified"},
    {"simulation.tensing_probability", &Simulation::tensing_probability, 0, 0.1, 0.3, 0, 1,
     "in four seconds of contact; assumed"},
    {"simulation.tissue_grain_share", &Simulation::tissue_grain_share, 0, 0.07, 0.12, 0, 0.3,
     "of alpha, 0.4 of it of beta, within 2 to 6 cm; assumed"},
    {"simulation.tissue_place_share", &Simulation::tissue_place_share, 0, 0.3, 0.5, 0, 1,
     "of layers and relaxation, from place to place, within 10 to 30 cm; assumed"},
    {"simulation.skin_friction", &Simulation::skin_friction, 0.1, 0.15, 0.5, 0, 1.5,
     "[derler2012]: dry skin about 0.5; with oil assumed"},
    {"simulation.skin_shear_n_per_mm", &Simulation::skin_shear_n_per_mm, 0, 2, 1, 0, 20,
     "unverified"},
    {"simulation.breath_variation", &Simulation::breath_variation, 0, 1, 1.3, 0, 2,
     "[tobin1988]: 1"},
    {"simulation.sigh_share", &Simulation::sigh_share, 0, 0.01, 0.05, 0, 1,
     "about ten an hour, unverified"},
    {"simulation.speaking_share", &Simulation::speaking_share, 0, 0.05, 0.3, 0, 1,
     "of the breaths; assumed"},
    {"simulation.coughs_per_h", &Simulation::coughs_per_h, 0, 2, 20, 0, 600,
     "of 3 to 8 mm; assumed"},
    // The robot.
    {"simulation.gear_softness", &Simulation::gear_softness, 0, 1, 2, 0, 4,
     "1: harmonic drives of 15000 Nm/rad at a shoulder; [tuttle1992]"},
    {"simulation.backlash_arcmin", &Simulation::backlash_arcmin, 0, 0.2, 1, 0, 10,
     "harmonic drives have hardly any, lost motion up to 1; data sheets, unverified"},
    {"simulation.torque_ripple_share", &Simulation::torque_ripple_share, 0, 0.02, 0.05, 0, 0.3,
     "[tuttle1992]: twice in a turn of the motor; sizes assumed"},
    {"simulation.friction_drift_share", &Simulation::friction_drift_share, 0, 0.15, 0.3, 0, 0.8,
     "by load and temperature; sizes assumed"},
    {"simulation.wrist_drift_n_per_min", &Simulation::wrist_drift_n_per_min, 0, 0.5, 1.5, 0, 60,
     "data sheets of such sensors"},
    {"simulation.wrist_hysteresis_share", &Simulation::wrist_hysteresis_share, 0, 0.01, 0.02, 0,
     0.2, "data sheets: 0.5 to 2 %"},
    {"simulation.wrist_crosstalk_share", &Simulation::wrist_crosstalk_share, 0, 0.01, 0.03, 0, 0.2,
     "data sheets: below 2 % in good ones, 5 % in others"},
    {"simulation.tool_weight_error_share", &Simulation::tool_weight_error_share, 0, 0.05, 0.1, 0,
     0.5, "assumed"},
    // What the scanner looks at, and by what light.
    {"simulation.scatter_mm", &Simulation::scatter_mm, 0, 0.4, 0.6, 0, 3,
     "1 / mu_s' of skin: [marchesini1992]; shift by [wang1995]"},
    {"simulation.skin_dark_share", &Simulation::skin_dark_share, 0, 0.3, 0.7, 0, 0.95,
     "of red light, by tone; assumed"},
    {"simulation.moles_per_dm2", &Simulation::moles_per_dm2, 0, 1, 4, 0, 100, "assumed"},
    {"simulation.hair_share", &Simulation::hair_share, 0, 0.01, 0.1, 0, 0.5, "assumed"},
    {"simulation.sweat_share", &Simulation::sweat_share, 0, 0.01, 0.1, 0, 0.5, "assumed"},
    {"simulation.lamp_flicker_share", &Simulation::lamp_flicker_share, 0, 0.3, 0.8, 0, 1,
     "lamps on 50 Hz; depth assumed"},
    {"simulation.rolling_shutter_ms", &Simulation::rolling_shutter_ms, 0, 15, 30, 0, 33,
     "webcams read a picture in up to a frame; unverified"},
};
}  // namespace

std::span<const SimulatedEffect> simulated_effects() {
  return effects;
}

Simulation::Simulation() {
  set_realism(*this);
}

void set_realism(Simulation& simulation) {
  for (const SimulatedEffect& effect : effects) {
    simulation.*effect.value = simulation.realism == "ideal"  ? effect.ideal
                               : simulation.realism == "hard" ? effect.hard
                                                              : effect.usual;
  }
}

}  // namespace tuina::session
