// SPDX-License-Identifier: Apache-2.0
// Everything a controller asks of one arm in one evaluation - pose, Jacobian, its derivative times
// speed, mass matrix, Coriolis, gravity - by tuina, KDL and MuJoCo; the sines no implementation can
// avoid; the plant.
#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include <kdl/chaindynparam.hpp>
#include <kdl/chainfksolverpos_recursive.hpp>
#include <kdl/chainjnttojacdotsolver.hpp>
#include <kdl/chainjnttojacsolver.hpp>
#include <map>

#include "tests/robot/oracles.hpp"
#include "tuina/core/random.hpp"
#include "tuina/robot/inverse_kinematics.hpp"
#include "tuina/robot/ready_posture.hpp"
#include "tuina/sim/robot/plant.hpp"

using namespace tuina;
using namespace tuina::robot;

namespace {

const RobotMount mount = mount_for(BodyPosture::sitting);
const ArmTable table = thesis_arm();
const ArmModel left(table, mount, Arm::left);
const ArmModel right(table, mount, Arm::right);

struct States {
  std::array<JointVector, 64> q, dq;
  States() {
    Random random = make_random(1, "bench states");
    for (std::size_t n = 0; n < q.size(); ++n) {
      q[n].resize(6);
      dq[n].resize(6);
      for (int i = 0; i < 6; ++i) {
        q[n][i] = uniform(random, -pi, pi);
        dq[n][i] = uniform(random, -2.0, 2.0);
      }
    }
  }
};
const States states;

void full_evaluation_tuina(benchmark::State& state) {
  std::size_t n = 0;
  for (auto _ : state) {
    n = (n + 1) % states.q.size();
    benchmark::DoNotOptimize(left.evaluate(states.q[n], states.dq[n], 0.0));
  }
}

void full_evaluation_kdl(benchmark::State& state) {
  const KDL::Chain chain = kdl_chain(table, mount.base_from_shoulder[Arm::left]);
  KDL::ChainFkSolverPos_recursive forward(chain);
  KDL::ChainJntToJacSolver jacobian_solver(chain);
  KDL::ChainJntToJacDotSolver jacobian_dot_solver(chain);
  KDL::ChainDynParam dynamics(chain, KDL::Vector(0, 0, -gravity_m_per_s2));
  KDL::JntArray q(6), dq(6), coriolis(6), gravity(6);
  KDL::JntArrayVel both(6);
  KDL::Frame pose;
  KDL::Jacobian jacobian(6);
  KDL::Twist bias;
  KDL::JntSpaceInertiaMatrix mass(6);
  std::size_t n = 0;
  for (auto _ : state) {
    n = (n + 1) % states.q.size();
    q.data = both.q.data = states.q[n];
    dq.data = both.qdot.data = states.dq[n];
    forward.JntToCart(q, pose);
    jacobian_solver.JntToJac(q, jacobian);
    jacobian_dot_solver.JntToJacDot(both, bias);
    dynamics.JntToMass(q, mass);
    dynamics.JntToCoriolis(q, dq, coriolis);
    dynamics.JntToGravity(q, gravity);
    benchmark::DoNotOptimize(gravity.data.data());
    benchmark::ClobberMemory();
  }
}

/// MuJoCo evaluates both arms and the base at once, and Coriolis with gravity; half of its time is
/// one arm's.
void full_evaluation_of_both_arms_mujoco(benchmark::State& state) {
  const auto m = mujoco_model(to_mjcf(mount, {.of = {table, table}}, 0.001));
  const std::unique_ptr<mjData, MujocoFree> d(mj_makeData(m.get()));
  std::array<double, 13 * 13> mass{};
  std::array<std::array<double, 3 * 13>, 4> jacobians{};
  double acceleration[6];
  std::size_t n = 0;
  for (auto _ : state) {
    n = (n + 1) % states.q.size();
    std::copy_n(states.q[n].data(), 6, d->qpos + 1);
    std::copy_n(states.q[n].data(), 6, d->qpos + 7);
    std::copy_n(states.dq[n].data(), 6, d->qvel + 1);
    std::copy_n(states.dq[n].data(), 6, d->qvel + 7);
    mj_kinematics(m.get(), d.get());
    mj_comPos(m.get(), d.get());
    mj_crb(m.get(), d.get());
    mj_fullM(m.get(), mass.data(), d->qM);
    mj_comVel(m.get(), d.get());
    mj_rne(m.get(), d.get(), 0, d->qfrc_bias);
    for (const int site : {0, 1}) {
      mj_jacSite(m.get(), d.get(), jacobians[static_cast<std::size_t>(2 * site)].data(),
                 jacobians[static_cast<std::size_t>(2 * site + 1)].data(), site);
    }
    mj_rnePostConstraint(m.get(),
                         d.get());  // qacc is zero: what is left is the Jacobian's derivative
    for (const int site : {0, 1}) {
      mj_objectAcceleration(m.get(), d.get(), mjOBJ_SITE, site, acceleration, 0);
    }
    benchmark::DoNotOptimize(acceleration);
    benchmark::ClobberMemory();
  }
}

void six_sines_and_cosines(benchmark::State& state) {
  std::size_t n = 0;
  for (auto _ : state) {
    n = (n + 1) % states.q.size();
    double sum = 0.0;
    for (int i = 0; i < 6; ++i) sum += std::sin(states.q[n][i]) * std::cos(states.q[n][i]);
    benchmark::DoNotOptimize(sum);
  }
}

void posture_for_a_contact(benchmark::State& state) {
  const auto ready = ready_posture(table, mount);
  Random random = make_random(2, "bench goals");
  for (auto _ : state) {
    const ContactGoal goal{
        .at_in_base = left.shoulder_in_base(0.0) +
                      Vector3(0.45, uniform(random, -0.1, 0.1), uniform(random, -0.2, 0.1)),
        .normal_in_base = -Vector3::UnitX()};
    benchmark::DoNotOptimize(find_posture(left, 0.0, goal, ready[Arm::left]));
  }
}

/// One millisecond of both arms, the linear base and both contacts at 4 kHz, the tools on a bent
/// back.
void plant_millisecond(benchmark::State& state) {
  const auto ready = ready_posture(table, mount);
  const Vector3 tool_in_couch =
      mount.base_from_couch.inverse() * left.base_from_tool(ready[Arm::left], 0.0).translation();
  const Mesh mesh = sim::make_patch(
      {.centre_in_couch = Vector3(0.0, tool_in_couch.y() - 10_mm, tool_in_couch.z()),
       .bend_radius_m = 0.5});
  sim::BackContact person(mesh, std::vector<TangentTissue>(mesh.vertices.size(), {9.786, 185.4}));
  auto made = sim::Plant::make(mount, {.of = {table, table}}, {.q_rad = ready}, &person);
  if (!made) return state.SkipWithError(made.error().message.c_str());
  sim::Plant& plant = **made;
  for (auto _ : state) {
    const RobotReading reading = *plant.read();
    RobotCommand command;
    for (const Arm arm : both_arms) {
      const JointVector& q = reading.arms[arm].q_rad;
      command.torque_nm[arm] = 200.0 * (ready[arm] - q) - 20.0 * reading.arms[arm].dq_rad_per_s;
      command.torque_nm[arm] += (arm == Arm::left ? left : right).gravity_nm(q);
    }
    plant.apply(command);
  }
  if (plant.fault() != nullptr) state.SkipWithError(plant.fault());
}

BENCHMARK(full_evaluation_tuina);
BENCHMARK(full_evaluation_kdl);
BENCHMARK(full_evaluation_of_both_arms_mujoco);
BENCHMARK(six_sines_and_cosines);
BENCHMARK(posture_for_a_contact);
BENCHMARK(plant_millisecond);

/// Keeps the times, so that their ratios can be printed below them.
class Reporter : public benchmark::ConsoleReporter {
 public:
  void ReportRuns(const std::vector<Run>& runs) override {
    for (const Run& run : runs) cpu_ns[run.benchmark_name()] = run.GetAdjustedCPUTime();
    ConsoleReporter::ReportRuns(runs);
  }
  std::map<std::string, double> cpu_ns;
};

}  // namespace

int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
  Reporter reporter;
  benchmark::RunSpecifiedBenchmarks(&reporter);
  const auto& ns = reporter.cpu_ns;
  if (ns.size() < 6) return 0;  // a filter was given
  const double ours = ns.at("full_evaluation_tuina");
  fmt::print(
      "one arm, full evaluation: {:.0f} ns; KDL {:.1f} x, MuJoCo {:.1f} x, six sines and cosines "
      "{:.2f} x\n",
      ours, ns.at("full_evaluation_kdl") / ours,
      ns.at("full_evaluation_of_both_arms_mujoco") / 2.0 / ours,
      ns.at("six_sines_and_cosines") / ours);
  fmt::print("plant: {:.0f} x real time\n", 1e6 / ns.at("plant_millisecond"));
  return 0;
}
