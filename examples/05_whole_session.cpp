// SPDX-License-Identifier: Apache-2.0
// The whole of tuina on one screen: a session with a person, a scanner and a robot of which it
// knows the interfaces only. Here they are simulated; 07 and 08 bring their own. `.value()` ends
// the program where the world says no; a real one asks first.
#include <fmt/core.h>

#include "simulated_order.hpp"
#include "tuina/session.hpp"

using namespace tuina;

namespace {

/// The force that was asked for against the true one, which only the simulation knows.
class ForceWatch final : public session::Observer {
 public:
  explicit ForceWatch(const sim::World& world) : world_(world) { sum_.begin(); }
  void on_tick(const session::Tick& tick) noexcept override {
    for (const Arm arm : both_arms) {
      const double target_n = tick.view[arm].target_n, time_s = tick.reading.time_s;
      if (target_n > 0.0) sum_.add(time_s, target_n, world_.truth().arms[arm].contact.force_n);
    }
  }
  [[nodiscard]] session::ForceErrors errors() const { return sum_.errors(); }

 private:
  const sim::World& world_;
  session::ForceErrorSum sum_;
};

}  // namespace

int main() {
  constexpr std::uint64_t seed = 1;
  const auto person = sim::parse_person("phantom:medium", BodyPosture::prone, seed).value();
  const auto stand = robot::place_robot(robot::load_robot("thesis").value(), person.position);
  const auto world = sim::World::make(person, stand, {}, seed).value();

  ForceWatch watch(*world);
  const session::Session session =
      session::run({world->camera(), world->turntable(), world->robot()}, simulated_order(*world),
                   {}, watch)
          .value();

  fmt::print("scan: {} points in {:.1f} s\n", session.scan.cloud_in_couch.size(),
             session.scan.sweep_s);
  fmt::print("map: {} acupoints, the first within {:.1f} mm (95 of 100)\n",
             session.located.acupoints.size(),
             to_mm(session.located.acupoints.front().uncertainty_m));
  fmt::print("plan: {} paths of two arms\n", session.ready.plan.paths.size());
  const session::ForceErrors force = watch.errors();
  fmt::print("massage: {:.0f} s, force {:.2f} N RMS off, {:.1f} N at most, {} stops\n",
             session.massage_s, force.rmse_n, force.peak_n, session.stops.size());
  return session.stops.empty() && !session.performed.empty() ? 0 : 1;
}
