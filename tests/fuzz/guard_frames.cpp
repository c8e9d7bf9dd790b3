// SPDX-License-Identifier: Apache-2.0
// What a guard sees and is asked for, as bytes: the arm of the guard's own tests moves on for some
// milliseconds, or one number of a millisecond becomes another, for once or for good.
#include <array>
#include <cmath>
#include <cstring>
#include <limits>

#include "tests/fuzz/parsers.hpp"
#include "tests/safety/oracle.hpp"

namespace tuina::test {
namespace {

using safety::Observation;
using safety::Proposal;

/// Bytes are taken one after the other; past the end all are zero.
struct Bytes {
  std::string_view left;
  unsigned char next() {
    if (left.empty()) return 0;
    const auto byte = static_cast<unsigned char>(left.front());
    left.remove_prefix(1);
    return byte;
  }
  /// A number that is hard to handle, one of a size that is usual, or one of any bits.
  double number(double usual) {
    constexpr double nan = std::numeric_limits<double>::quiet_NaN();
    constexpr double infinite = std::numeric_limits<double>::infinity();
    constexpr std::array hard = {nan, infinite, -infinite, 0.0, 1e308, -1e308, 1e-320, -0.0};
    const unsigned char kind = next();
    if (kind < hard.size()) return hard[kind];
    if (kind < 248) return usual * (kind - 128) / 120.0;
    std::array<unsigned char, sizeof(double)> bytes;
    for (unsigned char& byte : bytes) byte = next();
    double any;
    std::memcpy(&any, bytes.data(), sizeof any);
    return any;
  }
};

struct Frames {
  Observation seen = safety::standing_arm();
  Proposal proposal = safety::pressing(seen);
  safety::ZoneField::Cell skin = {safety::Zone::muscle, proposal.normal_in_base.cast<float>()};
  safety::Guard guard =
      safety::Guard(safety::Guard::Options{.torque_limit_nm = JointVector::Constant(6, 50.0)});
  safety::Oracle oracle;
  bool stopped = false;
  static inline long ticks = 0;  ///< of all frames

  Frames() {
    seen.skin = &skin;
    seen.force_in_base_n = 20.0 * proposal.normal_in_base;
  }

  void tick() {
    ++ticks;
    seen.tick += 1;
    seen.time_s += 1e-3;
    seen.wrench_time_s += 1e-3;
    if (seen.q_rad.size() == seen.dq_rad_per_s.size()) seen.q_rad += 1e-3 * seen.dq_rad_per_s;
    seen.force_in_base_n.z() += seen.tick % 2 == 0 ? 1e-9 : -1e-9;
    const safety::Verdict verdict = guard.check(seen, proposal);
    const char* fault = oracle.judge(seen, proposal, verdict);
    demand(fault == nullptr, fault);
    stopped = stopped || verdict.latched;
  }

  /// Changes one number of what is seen or proposed.
  void change(Bytes& bytes) {
    struct Number {
      double* value;
      double usual;
      bool by = false;  ///< it grows by that, where it does not become that
    };
    const Eigen::Index joint = bytes.next() % 6, axis = joint % 3;
    const std::array numbers = {Number{&seen.q_rad[joint], 0.01, true},
                                Number{&seen.dq_rad_per_s[joint], 4.0},
                                Number{&seen.force_in_base_n[axis], 100.0},
                                Number{&seen.time_s, 0.01, true},
                                Number{&seen.wrench_time_s, 0.01, true},
                                Number{&seen.tool_velocity_m_per_s[axis], 2.0},
                                Number{&seen.tool_in_base[axis], 0.1, true},
                                Number{&seen.torque_misfit, 2.0},
                                Number{&proposal.torque_nm[joint], 100.0},
                                Number{&proposal.normal_in_base[axis], 1.0},
                                Number{&proposal.virtual_target_in_base[axis], 0.1, true},
                                Number{&proposal.stiffness_n_per_m, 5000.0},
                                Number{&proposal.set_force_n, 60.0}};
    const std::size_t which = bytes.next() % (numbers.size() + 7);
    if (which < numbers.size()) {
      const Number& number = numbers[which];
      const double value = bytes.number(number.usual);
      *number.value = number.by ? *number.value + value : value;
      return;
    }
    const double nowhere = std::numeric_limits<double>::quiet_NaN();
    switch (which - numbers.size()) {
      case 0:
        seen.tick += bytes.next() - 128u;
        return;
      case 1:
        proposal.zone = static_cast<safety::Zone>(bytes.next());
        return;
      case 2:
        proposal.phase = static_cast<safety::Phase>(bytes.next() % 6);
        return;
      case 3:
        seen.gravity_nm[joint] = nowhere;
        return;
      case 4:
        seen.jacobian(axis, joint) = nowhere;
        return;
      case 5:
        seen.mass_kg_m2(axis, joint) = nowhere;
        return;
      default:
        guard.stop(static_cast<safety::Action>(2 + bytes.next() % 3),
                   safety::Cause::arms_too_close);
    }
  }
};

/// Whether nothing in the bytes makes the guard stop the arm.
bool passes_guard(std::string_view content) {
  Bytes bytes{content};
  Frames frames;
  while (!bytes.left.empty()) {
    const unsigned char what = bytes.next();
    if (what < 128) {
      for (int i = 0; i <= what % 32; ++i) frames.tick();
      continue;
    }
    const Observation seen = frames.seen;
    const Proposal proposal = frames.proposal;
    frames.change(bytes);
    frames.tick();
    if (what % 2 == 0) continue;
    // It was for once: all but the tick is as it was, and a millisecond later.
    const std::uint64_t tick = frames.seen.tick;
    const double time_s = seen.time_s + 1e-3, wrench_time_s = seen.wrench_time_s + 1e-3;
    frames.seen = seen;
    frames.proposal = proposal;
    frames.seen.tick = tick;
    frames.seen.time_s = time_s, frames.seen.wrench_time_s = wrench_time_s;
  }
  return !frames.stopped;
}

std::string bytes_of(std::initializer_list<int> values) {
  std::string bytes;
  for (const int value : values) bytes.push_back(static_cast<char>(value));
  return bytes;
}

}  // namespace

std::vector<Parser> guard_frames() {
  // Which joint, which number, and its value after the first byte; see `Frames::change`.
  return {{"guard",
           {bytes_of({31, 31, 31, 31}),
            bytes_of({31, 129, 0, 2, 255, 0, 0, 0, 0, 0, 64, 127, 64, 31, 31}),  // a wild sample
            bytes_of({31, 128, 1, 8, 140, 31, 128, 2, 8, 116, 31, 128, 0, 8, 128, 31}),  // torques
            bytes_of({31, 129, 0, 13, 130, 31, 31, 31, 31, 129, 0, 13, 132, 31}),  // late ticks
            bytes_of({31, 128, 3, 1, 160, 31, 128, 3, 1, 96, 31, 128, 3, 1, 128, 31}),  // a swing
            bytes_of({31, 128, 0, 15, 1, 128, 0, 14, 0, 31})},  // an approach to a muscle
           passes_guard,
           [] { return Frames::ticks; }}};
}

}  // namespace tuina::test
