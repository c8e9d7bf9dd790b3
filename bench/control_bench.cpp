// SPDX-License-Identifier: Apache-2.0
// What one millisecond costs: both arms in contact, from readings through the control law and the
// guard to torques. The limit is 10 us in the median, a hundredth of the tick; 40 us for 99.9 % of
// a million.
#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <vector>

#include "tuina/control/arm_controller.hpp"
#include "tuina/core/random.hpp"
#include "tuina/safety/robot_guard.hpp"
#include "tuina/session/controlled_arm.hpp"

using namespace tuina;

namespace {

constexpr double limit_us = 10.0, tail_limit_us = 40.0, axis_limit_us = 5.0;
constexpr double guard_limit_us = 5.0, guard_tail_limit_us = 30.0;
constexpr double dt_s = control_period_s;

/// Both arms in contact, their controllers, and the guard of the robot.
struct Pressing {
  PerArm<robot::ArmModel> models =
      robot::both_models(robot::thesis_arm(), robot::mount_for(BodyPosture::sitting));
  PerArm<session::ControlledArm> arms = {
      .of = {session::ControlledArm(models[Arm::left], {.learn_s = 0.0}),
             session::ControlledArm(models[Arm::right], {.learn_s = 0.0})}};
  safety::RobotGuard guard{models, {}};
  robot::RobotReading reading;
  PerArm<control::ContactTarget> targets;

  Pressing() {
    for (const Arm arm : both_arms) {
      const double side = arm == Arm::left ? 1.0 : -1.0;
      robot::ArmReading& sensed = reading.arms[arm];
      sensed.q_rad = sensed.dq_rad_per_s = JointVector::Zero(6);
      sensed.q_rad << -0.3 * side, -0.2, 0.1, 0.4, 0.1, -0.2;
      arms[arm].sense(reading, arm);
      const Transform tool = models[arm].base_from_tool(sensed.q_rad, 0.0);
      const Vector3 normal = control::tool_normal(tool);
      targets[arm] = {.at_in_base = tool.translation() - 0.016 * normal,
                      .normal_in_base = normal,
                      .force_n = 20.0};
      arms[arm].controller.approach({targets[arm].at_in_base, normal});
      sensed.wrench_in_tool.force_n = Vector3(-20.0, 0.0, 0.0);
    }
  }

  [[nodiscard]] safety::RobotProposal propose(std::uint64_t number, double noise) {
    reading.tick = number;
    reading.time_s = static_cast<double>(number) * dt_s;
    safety::RobotProposal proposal;
    for (const Arm arm : both_arms) {
      robot::ArmReading& sensed = reading.arms[arm];
      sensed.dq_rad_per_s.setConstant(1e-3 * noise);
      sensed.wrench_in_tool.force_n.y() = noise;
      sensed.wrench_time_s = reading.time_s;
      arms[arm].sense(reading, arm);
      arms[arm].controller.track(targets[arm]);
      proposal.arms[arm] = arms[arm].propose(reading, safety::Zone::muscle);
    }
    return proposal;
  }
};

double median_us = 0.0, tail_us = 0.0, guard_median_us = 0.0, guard_tail_us = 0.0;

void dual_arm_tick(benchmark::State& state) {
  Random random = make_random(1, "bench noise");
  std::vector<double> noise(1024);
  for (double& value : noise) value = gaussian(random, 0.05);
  constexpr std::size_t ticks = 1'000'000;
  std::vector<float> took_us(ticks), guard_us(ticks);
  for (auto _ : state) {
    Pressing robot;
    for (std::size_t n = 0; n < ticks; ++n) {
      const auto start = std::chrono::steady_clock::now();
      const safety::RobotProposal proposal = robot.propose(n + 1, noise[n % noise.size()]);
      const auto proposed = std::chrono::steady_clock::now();
      benchmark::DoNotOptimize(robot.guard.check(robot.reading, proposal));
      const auto end = std::chrono::steady_clock::now();
      took_us[n] = std::chrono::duration<float, std::micro>(end - start).count();
      guard_us[n] = std::chrono::duration<float, std::micro>(end - proposed).count();
    }
  }
  std::sort(took_us.begin(), took_us.end());
  std::sort(guard_us.begin(), guard_us.end());
  median_us = took_us[ticks / 2];
  tail_us = took_us[ticks - ticks / 1000];
  guard_median_us = guard_us[ticks / 2];
  guard_tail_us = guard_us[ticks - ticks / 1000];
  state.counters["guard_median_us"] = guard_median_us;
  state.counters["guard_p99.9_us"] = guard_tail_us;
  state.counters["median_us"] = median_us;
  state.counters["p99.9_us"] = tail_us;
  state.SetItemsProcessed(static_cast<std::int64_t>(state.iterations() * ticks));
}
BENCHMARK(dual_arm_tick)->Iterations(1)->Unit(benchmark::kMillisecond);

// Planned anew in every tick and then asked where the joint is: the most a joint can cost.
double axis_median_us = 0.0, axis_tail_us = 0.0;

void replan_one_axis_each_tick(benchmark::State& state) {
  constexpr std::size_t ticks = 200'000;
  std::vector<float> took_us(ticks);
  for (auto _ : state) {
    Random random = make_random(2, "bench motion");
    const control::MotionLimits limits = {0.25, 1.0, 10.0};
    control::MotionProfile motion;
    control::MotionState at;
    for (std::size_t n = 0; n < ticks; ++n) {
      const double goal = uniform(random, -1.0, 1.0);
      const auto start = std::chrono::steady_clock::now();
      benchmark::DoNotOptimize(motion.plan(at, goal, limits));
      at = motion.at(dt_s);
      const auto end = std::chrono::steady_clock::now();
      took_us[n] = std::chrono::duration<float, std::micro>(end - start).count();
    }
  }
  std::sort(took_us.begin(), took_us.end());
  axis_median_us = took_us[ticks / 2];
  axis_tail_us = took_us[ticks - ticks / 1000];
  state.counters["median_us"] = axis_median_us;
  state.counters["p99.9_us"] = axis_tail_us;
}
BENCHMARK(replan_one_axis_each_tick)->Iterations(1)->Unit(benchmark::kMillisecond);

void plan_one_axis(benchmark::State& state) {
  Random random = make_random(1, "bench motion");
  const control::MotionLimits limits = {0.25, 1.0, 10.0};
  std::vector<control::MotionState> starts(256);
  for (auto& start : starts)
    start = {uniform(random, -1, 1), uniform(random, -0.2, 0.2), uniform(random, -0.5, 0.5)};
  control::MotionProfile motion;
  std::size_t n = 0;
  for (auto _ : state) {
    n = (n + 1) % starts.size();
    benchmark::DoNotOptimize(motion.plan(starts[n], 0.3, limits));
  }
}
BENCHMARK(plan_one_axis);

void plan_tool_motion(benchmark::State& state) {
  control::ToolMotion motion;
  motion.start({});
  for (auto _ : state) {
    control::ToolMotion next = motion;
    benchmark::DoNotOptimize(next.plan(0.0, {Vector3(0.1, 0.2, 0.1), Vector3(0.3, 0.0, 1.0)}, {}));
  }
}
BENCHMARK(plan_tool_motion);

}  // namespace

int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  benchmark::RunSpecifiedBenchmarks();
  fmt::print("dual-arm tick: median {:.2f} us, limit {:.0f}, ratio {:.2f}\n", median_us, limit_us,
             median_us / limit_us);
  fmt::print("dual-arm tick: 99.9 % below {:.2f} us, limit {:.0f}, ratio {:.2f}\n", tail_us,
             tail_limit_us, tail_us / tail_limit_us);
  fmt::print(
      "of that the guard: median {:.2f} us, limit {:.0f}; 99.9 % below {:.2f} us, limit {:.0f}\n",
      guard_median_us, guard_limit_us, guard_tail_us, guard_tail_limit_us);
  fmt::print(
      "motion of a joint, planned anew: median {:.2f} us, 99.9 % below {:.2f} us, limit {:.0f}\n",
      axis_median_us, axis_tail_us, axis_limit_us);
  return 0;
}
