// SPDX-License-Identifier: Apache-2.0
#include "apps/tuina/robot/hand_option.hpp"

#include "apps/cli/options.hpp"
#include "apps/simulated/leading_hand.hpp"

namespace tuina::app {

void HandOption::describe(Options& options) {
  auto hand = options.add("--hand", technique_,
                          "a hand leads an arm and shows it this of the programme relax, for "
                          "`tuina teach record --device`");
  hand.one_of(technique_names());
  options.add("--hand-arm", arm_, "that is led")
      .one_of({"left", "right"})
      .show_default()
      .needs(hand);
}

Result<std::function<void(sim::World& world, double time_s)>> HandOption::make(
    const SimulatedRoom& room) const {
  if (technique_.empty()) return {};
  const sim::Person& person = room.world->person();
  auto hand =
      TeachingHand::make({.position = person.position,
                          .technique = *parse_technique(technique_),  // checked by the option
                          .arm = arm_ == "left" ? Arm::left : Arm::right},
                         person,
                         robot::place_robot(room.order.robot, person.position,
                                            session::head_at_plus_y(person.acupoints)));
  if (!hand) return tl::unexpected(hand.error());
  return [hand = std::make_shared<TeachingHand>(std::move(*hand))](
             sim::World& world, double time_s) { hand->lead(world, time_s); };
}

}  // namespace tuina::app
