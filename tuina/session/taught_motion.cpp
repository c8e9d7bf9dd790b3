// SPDX-License-Identifier: Apache-2.0
#include "tuina/session/taught_motion.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <optional>

#include "tuina/core/io/csv.hpp"
#include "tuina/core/io/file.hpp"
#include "tuina/core/io/text_lines.hpp"
#include "tuina/core/io/toml_reader.hpp"
#include "tuina/core/units.hpp"
#include "tuina/massage/programme.hpp"
#include "tuina/massage/technique/contact_path.hpp"
#include "tuina/robot/robot_model.hpp"

namespace tuina::session {
namespace {

namespace fs = std::filesystem;

constexpr double max_speed_rad_per_s = 1.5;
constexpr double max_noise_n = 1.0;  // about zero, of what is felt away from the skin
constexpr std::array taught_zones = {safety::Zone::muscle, safety::Zone::kidney,
                                     safety::Zone::bony};

std::vector<std::string> columns_of(int joints) {
  std::vector<std::string> columns = {"time_s"};
  for (int j = 1; j <= joints; ++j) columns.push_back(fmt::format("q{}_deg", j));
  columns.emplace_back("force_n");
  return columns;
}

std::string list_of(const std::vector<massage::RelativePlace>& line) {
  std::vector<std::string> places;
  places.reserve(line.size());
  for (const auto& place : line) {
    places.push_back(fmt::format("[{:.3f}, {:.4f}]", place.aside_cun, place.up_share));
  }
  return fmt::format("[{}]", fmt::join(places, ", "));
}

std::string line_toml(const TaughtMotion& motion) {
  if (motion.line.empty()) return {};
  return fmt::format(
      "line = {}  # cun beside the spine, share of the way from GV4 to C7\n"
      "force_n = {:.2f}  # along that line\nspeed_mm_per_s = {:.1f}\n",
      list_of(motion.line), motion.force_n, to_mm(motion.speed_m_per_s));
}

std::vector<massage::RelativePlace> line_of(const TomlTable& taught) {
  std::vector<massage::RelativePlace> line;
  const auto list = taught.list("line");
  if (!list && taught.has("line")) {
    taught.reject("line", "line is not a list of places, [[cun, share], ...]");
  }
  for (const TomlValue& entry : list.value_or(std::vector<TomlValue>{})) {
    const auto pair = entry.numbers(2);
    if (pair) {
      line.push_back({(*pair)[0], (*pair)[1]});
    } else {
      taught.reject(entry, "a place of line is not two numbers, [cun, share]");
    }
  }
  return line;
}

Result<std::vector<TaughtSample>> read_samples(const fs::path& file, const robot::ArmTable& table,
                                               safety::Zone zone) {
  const auto csv = read_csv(file, columns_of(table.joints));
  if (!csv) return tl::unexpected(csv.error());
  constexpr std::size_t min_rows = 50;
  const std::size_t rows = csv->rows();
  const auto at = [&](std::size_t column, std::size_t row) { return csv->columns[column][row]; };
  const auto refuse = [&](std::size_t row, const std::string& why) {
    return fail(Fault::bad_input, "{}:{}: {}", file.string(), row + 2, why);
  };
  if (rows < min_rows) {
    return fail(Fault::bad_input, "{}: {} samples are no motion; at least {} are needed",
                file.string(), rows, min_rows);
  }
  const double step_s = at(0, 1) - at(0, 0);
  if (at(0, 0) != 0.0) return refuse(0, fmt::format("time_s begins at {}; it must be 0", at(0, 0)));
  if (!(step_s > 0.0) || step_s > 0.05) {
    return refuse(1, fmt::format("{} s from sample to sample; up to 0.05 are usable", step_s));
  }
  const auto joints = static_cast<std::size_t>(table.joints);
  const double max_n = safety::ceiling_of(zone).trip_n;
  std::vector<TaughtSample> samples(rows);
  for (std::size_t row = 0; row < rows; ++row) {
    const double time_s = static_cast<double>(row) * step_s;
    if (std::abs(at(0, row) - time_s) > 0.1 * step_s) {
      return refuse(row,
                    fmt::format("time_s is {} where {:.4f} would be even", at(0, row), time_s));
    }
    TaughtSample& sample = samples[row];
    sample.time_s = time_s;
    sample.q_rad.resize(table.joints);
    for (std::size_t j = 0; j < joints; ++j) {
      const double q_rad = from_deg(at(1 + j, row));
      const robot::Link& link = table.links[j];
      if (q_rad < link.min_rad || q_rad > link.max_rad) {
        return refuse(row,
                      fmt::format("q{}_deg is {:.1f}; this joint goes from {:.0f} to {:.0f}", j + 1,
                                  at(1 + j, row), to_deg(link.min_rad), to_deg(link.max_rad)));
      }
      const auto k = static_cast<Eigen::Index>(j);
      sample.q_rad(k) = q_rad;
      const double speed = row > 0 ? std::abs(q_rad - samples[row - 1].q_rad(k)) / step_s : 0.0;
      if (speed > max_speed_rad_per_s) {
        return refuse(row, fmt::format("joint {} moves at {:.1f} rad/s; at most {} are played",
                                       j + 1, speed, max_speed_rad_per_s));
      }
    }
    sample.force_n = at(1 + joints, row);
    if (sample.force_n < -max_noise_n) {
      return refuse(row,
                    fmt::format("force_n is {}; a tool only presses, from 0 N on", sample.force_n));
    }
    sample.force_n = std::max(sample.force_n, 0.0);
    if (sample.force_n > max_n) {
      return refuse(row, fmt::format("{:.1f} N; the zone `{}` bears {:.0f}", sample.force_n,
                                     safety::name_of(zone), max_n));
    }
  }
  return samples;
}

}  // namespace

TaughtMotion::Moment TaughtMotion::at(double time_s) const noexcept {
  assert(samples.size() >= 2);
  const double step_s = samples[1].time_s - samples[0].time_s;
  const double place = std::clamp(time_s / step_s, 0.0, static_cast<double>(samples.size() - 1));
  const std::size_t k = std::min(static_cast<std::size_t>(place), samples.size() - 2);
  const double u = place - static_cast<double>(k);
  const TaughtSample &a = samples[k], &b = samples[k + 1];
  const auto slope = [&](std::size_t i) -> JointVector {  // per step
    if (i == 0 || i + 1 == samples.size()) return JointVector::Zero(a.q_rad.size());
    return 0.5 * (samples[i + 1].q_rad - samples[i - 1].q_rad);
  };
  const JointVector from = slope(k), to = slope(k + 1);
  Moment moment;
  moment.q_rad = (1.0 + 2.0 * u) * (1.0 - u) * (1.0 - u) * a.q_rad +
                 u * (1.0 - u) * (1.0 - u) * from + u * u * (3.0 - 2.0 * u) * b.q_rad +
                 u * u * (u - 1.0) * to;
  const bool moves = time_s > 0.0 && time_s < samples.back().time_s;
  moment.dq_rad_per_s = (moves ? 1.0 / step_s : 0.0) *
                        (6.0 * u * (u - 1.0) * (a.q_rad - b.q_rad) +
                         (3.0 * u - 1.0) * (u - 1.0) * from + u * (3.0 * u - 2.0) * to);
  moment.force_n = (1.0 - u) * a.force_n + u * b.force_n;
  return moment;
}

TaughtMotion smoothed(const TaughtMotion& motion, double sd_s, double step_s) {
  TaughtMotion smooth = motion;
  smooth.samples.clear();
  const auto& raw = motion.samples;
  if (raw.size() < 2) return motion;
  const double raw_step_s = raw[1].time_s - raw[0].time_s;
  const auto reach = static_cast<std::ptrdiff_t>(std::ceil(4.0 * sd_s / raw_step_s));
  const auto last = static_cast<std::ptrdiff_t>(raw.size()) - 1;
  const auto count = static_cast<std::size_t>(motion.duration_s() / step_s + 1e-9) + 1;
  for (std::size_t i = 0; i < count; ++i) {
    const double time_s = static_cast<double>(i) * step_s;
    const auto middle = static_cast<std::ptrdiff_t>(std::lround(time_s / raw_step_s));
    TaughtSample sample{.time_s = time_s, .q_rad = JointVector::Zero(raw[0].q_rad.size())};
    double sum = 0.0;
    for (std::ptrdiff_t k = middle - reach; k <= middle + reach; ++k) {
      // Beyond its ends the arm rested.
      const TaughtSample& near =
          raw[static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(k, 0, last))];
      const double off_s = static_cast<double>(k) * raw_step_s - time_s;
      const double weight = std::exp(-0.5 * off_s * off_s / (sd_s * sd_s));
      sum += weight;
      sample.q_rad += weight * near.q_rad;
      sample.force_n += weight * near.force_n;
    }
    sample.q_rad /= sum;
    sample.force_n /= sum;
    smooth.samples.push_back(std::move(sample));
  }
  return smooth;
}

Result<void> write_taught(const TaughtMotion& motion, const fs::path& file) {
  fs::path samples = file;
  samples.replace_extension(".csv");
  const int joints = motion.samples.empty() ? 0 : static_cast<int>(motion.samples[0].q_rad.size());
  std::string csv = fmt::format("{}\n", fmt::join(columns_of(joints), ","));
  for (const TaughtSample& sample : motion.samples) {
    csv += fmt::format("{:.4f}", sample.time_s);
    for (const double q : sample.q_rad) csv += fmt::format(",{:.5f}", to_deg(q));
    // What is felt away from the skin is noise about zero.
    csv += fmt::format(",{:.3f}\n", std::max(sample.force_n, 0.0));
  }
  if (auto written = write_file(samples, csv); !written) return written;
  return write_file(
      file, fmt::format("name = {}\nposition = \"{}\"\narm = \"{}\"\n"
                        "rail_mm = {}\nzone = \"{}\"  # the most delicate it touches\n"
                        "samples = {}\nrobot = {}\n",
                        toml_string(motion.name), name_of(motion.position), name_of(motion.arm),
                        to_mm(motion.rail_m), safety::name_of(motion.zone),
                        toml_string(samples.filename().string()), toml_string(motion.robot)) +
                line_toml(motion));
}

Result<std::string> programme_of(const TaughtMotion& motion) {
  if (motion.line.size() < 2) {
    return fail(Fault::bad_input, "`{}` has no line over the back; only a taught stroke has one",
                motion.name);
  }
  constexpr double min_speed_mm_per_s = 10.0;
  std::string programme = fmt::format(
      "name = {}\ndescription = \"\"\"\nStrokes along a line that a hand has shown, on both "
      "sides.\"\"\"\n\n[[part]]\ntechnique = \"stroke\"\nplaces = {}  # cun beside the spine, "
      "share "
      "of the way from GV4 to C7\nforce_n = {:.1f}\nspeed_mm_per_s = {:.1f}\nrepeats = 2\n",
      toml_string(motion.name), list_of(motion.line),
      std::max(massage::kept_force_n, motion.force_n),
      std::clamp(to_mm(motion.speed_m_per_s), min_speed_mm_per_s,
                 to_mm(massage::max_slide_m_per_s)));
  if (const auto read = massage::parse_programme(programme, "its programme"); !read) {
    const std::string& why = read.error().message;
    return fail(Fault::bad_input, "cannot be carried: {}", why.substr(0, why.find('\n')));
  }
  return programme;
}

Result<TaughtMotion> read_taught(const fs::path& file) {
  constexpr std::size_t max_bytes = 1 << 20;
  const auto text = read_file(file, max_bytes);
  if (!text) return tl::unexpected(text.error());
  TaughtMotion motion;
  std::string samples_name;
  const auto read = read_toml(*text, file.string(), Fault::bad_input, [&](const TomlTable& taught) {
    taught.only({"robot", "line", "force_n", "speed_mm_per_s"},
                {"name", "position", "arm", "rail_mm", "zone", "samples"});
    motion.name = taught.text("name").value_or("");
    motion.robot = taught.text("robot").value_or(motion.robot);
    const auto position =
        taught.word("position", {name_of(BodyPosture::sitting), name_of(BodyPosture::prone)});
    motion.position = position == 1U ? BodyPosture::prone : BodyPosture::sitting;
    const auto arm = taught.word("arm", {name_of(Arm::left), name_of(Arm::right)});
    motion.arm = arm == 1U ? Arm::right : Arm::left;
    motion.rail_m = from_mm(taught.number("rail_mm", -2000.0, 2000.0).value_or(0.0));
    TomlTable::Words zones;
    for (const safety::Zone zone : taught_zones) zones.emplace_back(safety::name_of(zone));
    motion.zone = taught_zones[taught.word("zone", zones).value_or(0)];
    samples_name = taught.text("samples").value_or("");
    for (const char* key : {"name", "samples"}) {
      if (taught.text(key) == "") taught.reject(key, fmt::format("{} is empty", key));
    }
    motion.line = line_of(taught);
    motion.force_n = taught.number("force_n", 0.0, 1000.0).value_or(0.0);
    motion.speed_m_per_s = from_mm(taught.number("speed_mm_per_s", 0.0, 1e4).value_or(0.0));
  });
  if (!read) return tl::unexpected(read.error());
  const auto robot = robot::load_robot(motion.robot);
  if (!robot) return fail(Fault::bad_input, "{}: robot: {}", file.string(), robot.error().message);
  auto samples = read_samples(file.parent_path() / samples_name, robot->arm, motion.zone);
  if (!samples) return tl::unexpected(samples.error());
  motion.samples = std::move(*samples);
  return motion;
}

}  // namespace tuina::session
