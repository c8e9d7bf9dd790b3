// SPDX-License-Identifier: Apache-2.0
#include "apps/tuina/doctor/ask_wrists.hpp"

#include <chrono>
#include <cmath>
#include <vector>

#include "tuina/hardware/wrist_sensor.hpp"
#include "tuina/safety/limits.hpp"

namespace tuina::app {
namespace {

using nlohmann::ordered_json;
using namespace std::chrono_literals;

constexpr auto listened = 1500ms;
constexpr double max_drift_n_per_min = 1.0;  // what the guard's zero follows

/// What one sensor said while nothing touched it.
struct Quiet {
  Wrench mean;
  double force_rms_n = 0.0, torque_rms_nm = 0.0;  ///< noise about the mean and the drift
  double drift_n_per_min = 0.0, drift_sd_n_per_min = 0.0;
};

using Moments = Eigen::Matrix<double, 6, 1>;

Moments row_of(const Wrench& wrench) {
  Moments row;
  row << wrench.force_n, wrench.torque_nm;
  return row;
}

/// A line through all of it, by least squares.
Quiet quiet_of(const std::vector<double>& times_s, const std::vector<Wrench>& wrenches) {
  const auto count = static_cast<double>(times_s.size());
  double mean_s = 0.0;
  Moments mean = Moments::Zero();
  for (std::size_t i = 0; i < times_s.size(); ++i) {
    mean_s += times_s[i] / count;
    mean += row_of(wrenches[i]) / count;
  }
  double spread_s2 = 0.0;
  Moments slope = Moments::Zero();
  for (std::size_t i = 0; i < times_s.size(); ++i) {
    spread_s2 += (times_s[i] - mean_s) * (times_s[i] - mean_s);
    slope += (times_s[i] - mean_s) * (row_of(wrenches[i]) - mean);
  }
  slope /= spread_s2;
  double force2 = 0.0, torque2 = 0.0;
  for (std::size_t i = 0; i < times_s.size(); ++i) {
    const Moments left = row_of(wrenches[i]) - mean - (times_s[i] - mean_s) * slope;
    force2 += left.head<3>().squaredNorm();
    torque2 += left.tail<3>().squaredNorm();
  }
  const double force_rms_n = std::sqrt(force2 / count);
  return {.mean = {.force_n = mean.head<3>(), .torque_nm = mean.tail<3>()},
          .force_rms_n = force_rms_n,
          .torque_rms_nm = std::sqrt(torque2 / count),
          .drift_n_per_min = 60.0 * slope.head<3>().norm(),
          .drift_sd_n_per_min = 60.0 * force_rms_n / std::sqrt(spread_s2)};
}

ordered_json list(const Vector3& v) {
  return {v.x(), v.y(), v.z()};
}

struct FoundWrist {
  ordered_json json = ordered_json::object();
  std::string finding;
  std::string note;  ///< what it is good for only with care
  bool good = false;
};

FoundWrist ask_wrist(hardware::WristDevice device) {
  FoundWrist found;
  device.calibration.reset();
  auto sensor = hardware::WristSensor::open(device);
  if (!sensor) {
    found.finding = sensor.error().message;
    return found;
  }
  std::vector<double> times_s;
  std::vector<Wrench> wrenches;
  const auto until = std::chrono::steady_clock::now() + listened;
  const hardware::WristStream& stream = sensor->stream();
  while (std::chrono::steady_clock::now() < until && stream.fault() == nullptr) {
    sensor->wait(until);
    if (!sensor->hear()) continue;
    times_s.push_back(stream.time_s());
    wrenches.push_back(stream.in_tool());
  }
  constexpr std::size_t min_samples = 100;
  if (stream.fault() != nullptr || times_s.size() < min_samples) {
    found.finding = fmt::format("{}: the sensor {}", device.address,
                                stream.fault() != nullptr ? stream.fault() : "falls silent");
    return found;
  }
  const Quiet quiet = quiet_of(times_s, wrenches);
  const hardware::WristTraffic& traffic = stream.traffic();
  found.good = true;
  found.json = {{"rate_hz", sensor->measured_rate_hz()},
                {"lost", traffic.lost},
                {"again", traffic.again},
                {"late", traffic.late},
                {"spoilt", traffic.spoilt},
                {"longest_row", traffic.longest_row},
                {"noise_n", quiet.force_rms_n},
                {"noise_nm", quiet.torque_rms_nm},
                {"drift_n_per_min", quiet.drift_n_per_min},
                {"drift_sd_n_per_min", quiet.drift_sd_n_per_min},
                {"force_in_tool_n", list(quiet.mean.force_n)},
                {"torque_in_tool_nm", list(quiet.mean.torque_nm)}};
  found.finding = fmt::format(
      "{}: {:.0f} Hz, {} lost, status 0, noise {:.3f} N and {:.4f} Nm RMS, drift {:.1f} +- {:.1f} "
      "N/min",
      device.address, sensor->measured_rate_hz(), traffic.lost, quiet.force_rms_n,
      quiet.torque_rms_nm, quiet.drift_n_per_min, 2.0 * quiet.drift_sd_n_per_min);
  if (traffic.longest_row > safety::max_wrist_repeats)
    found.note = fmt::format(
        "; {} samples in a row were equal to the one before, and the guard takes {} for a "
        "fault: use a wider filter",
        traffic.longest_row, safety::max_wrist_repeats + 1);
  if (quiet.drift_n_per_min - 3.0 * quiet.drift_sd_n_per_min > max_drift_n_per_min)
    found.note +=
        "; the guard's zero follows 1 N/min: let the sensor warm up, with nothing touching it";
  return found;
}

}  // namespace

void ask_wrists(const hardware::DeviceFile& devices, ordered_json& all, Answer& answer) {
  for (const Arm arm : both_arms) {
    if (!devices.wrists[arm]) continue;
    FoundWrist found = ask_wrist(*devices.wrists[arm]);
    const char* begin = !found.good ? "none" : found.note.empty() ? "ok  " : "note";
    answer.text += fmt::format("{} {:<18} {}{}\n", begin, fmt::format("{} wrist", name_of(arm)),
                               found.finding, found.note);
    ordered_json json = {{"device", "wrist"},
                         {"arm", name_of(arm)},
                         {"address", devices.wrists[arm]->address},
                         {"good", found.good},
                         {"finding", found.finding + found.note}};
    json.update(found.json);
    all.push_back(std::move(json));
    if (!found.good) answer.exit_code = 3;
  }
}

}  // namespace tuina::app
