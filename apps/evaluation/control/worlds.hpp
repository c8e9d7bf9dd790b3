// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <functional>

#include "apps/evaluation/control/trials.hpp"
#include "tuina/core/units.hpp"

namespace tuina::app {

struct NamedTissue {
  const char* name;
  TangentTissue tissue;
};
inline constexpr std::array<NamedTissue, 3> tissues = {
    {{"bone", bone}, {"hard", hard_muscle}, {"soft", soft_muscle}}};

/// One way in which an experiment may be, and its name in the table.
struct Choice {
  std::string name;
  std::function<void(ContactExperiment&)> set;
};

/// A choice for each number, named by the number.
[[nodiscard]] std::vector<Choice> numbers(
    const std::vector<double>& values, const std::function<void(ContactExperiment&, double)>& set);
[[nodiscard]] std::vector<Choice> forces(const std::vector<double>& forces_n);
[[nodiscard]] std::vector<Choice> all_tissues();
/// A torso that gives way by a millimetre for 35 N, and one that does not.
[[nodiscard]] const std::vector<Choice>& torsos();

/// Every row with every choice, choices of one row side by side. A row that has the label already
/// has it renamed, others get it behind those they have.
[[nodiscard]] std::vector<ControlRow> varied(const std::vector<ControlRow>& rows,
                                             const std::string& label,
                                             const std::vector<Choice>& choices);

/// One experiment with everything wrong that a session has wrong: masses and so gravity by 10 %,
/// all links in the same direction, friction by 20 %, alpha and beta by 30 %, the skin by 3 mm.
[[nodiscard]] ContactExperiment wrong_world(double force_n, std::uint64_t seed);

/// A person who begins to move after two seconds.
[[nodiscard]] sim::Shift person_moves(double outward_mm, double m_per_s, double m_per_s2 = 0.0);

/// A row labelled `what` of one experiment on every tissue with several seeds.
[[nodiscard]] ControlRow on_all_tissues(double force_n, int seeds, std::uint64_t first_seed);

/// Tables about the spring along the normal; sensors and drives; damping and delay.
[[nodiscard]] ControlTable stiffness_table(bool full, std::uint64_t seed);
[[nodiscard]] ControlTable devices_table(std::uint64_t seed);
[[nodiscard]] ControlTable stability_table(bool full, std::uint64_t seed);
/// A table about what rules A5 and A6 of the tissue would do to the force.
[[nodiscard]] ControlTable rules_table(std::uint64_t seed);
/// Tables about arms that take places and no torques: the contact tasks, the targets of all arms,
/// the force they hold, and wrist sensors that fail.
[[nodiscard]] ControlTable position_table(int seeds, std::uint64_t first_seed);
[[nodiscard]] ControlTable position_targets_table(ControlTable targets);
[[nodiscard]] ControlTable position_hold_table(std::uint64_t seed);
[[nodiscard]] ControlTable position_faults_table(std::uint64_t seed);

}  // namespace tuina::app
