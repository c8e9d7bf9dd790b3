// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

#include "tuina/core/random.hpp"
#include "tuina/core/units.hpp"
#include "tuina/telemetry/report/report_data.hpp"

namespace tuina::tests {

/// A session that never was: a barrel of a back, sitting, with the seven points pressed, two of
/// them rubbed and each side stroked. Everything in it is made up, so that the page can be tested
/// without the rest of tuina.
inline telemetry::ReportData sample_report() {
  telemetry::ReportData data{
      .person = "sample", .programme = "seven points", .seed = 3, .version = "test"};
  Random random = make_random(3, "sample report");
  const auto on_back = [](double x, double z) { return Vector3(x, 0.10 * std::cos(5.0 * x), z); };
  const auto normal = [](double x) {
    return Vector3(0.5 * std::sin(5.0 * x), 1.0, 0.0).normalized();
  };
  for (double x = -0.2; x < 0.2; x += 0.003) {
    for (double z = 0.05; z < 0.6; z += 0.003)
      data.scan_in_couch.points.push_back(on_back(x, z) + Vector3(0, gaussian(random, 0.0004), 0));
  }
  const std::array<double, 7> across = {0.09, -0.09, 0.08, -0.08, 0.08, -0.08, 0.0};
  const std::array<double, 7> height = {0.45, 0.45, 0.33, 0.33, 0.26, 0.26, 0.18};
  const auto perform = [&](Arm arm, double begin_s, ContactPath path) {
    for (const ContactPoint& point : path.points) {
      const double felt = point.force_n * (1.0 - std::exp(-point.time_s / 0.1));
      data.trace.push_back({.time_s = begin_s + point.time_s,
                            .arm = arm,
                            .technique = path.technique,
                            .target_n = point.force_n,
                            .true_force_n = felt,
                            .measured_force_n = felt + gaussian(random, 0.4),
                            .depth_m = felt / 4000.0,
                            .tool_in_couch = point.at_in_couch});
    }
    data.duration_s = std::max(data.duration_s, begin_s + path.duration_s());
    data.paths.push_back({arm, begin_s, std::move(path)});
  };
  for (std::size_t k = 0; k < 7; ++k) {
    const std::string name = seven_acupoints[k];
    const Arm arm = name.ends_with("_R") ? Arm::right : Arm::left;
    const Vector3 at = on_back(across[k], height[k]);
    data.acupoints.push_back(
        {{name, at, normal(across[k]), 0.008 + 0.001 * static_cast<double>(k)}, 0.004});
    ContactPath press{
        .name = "press " + name, .technique = Technique::press, .acupoints = {name}, .points = {}};
    ContactPath rub{
        .name = "rub " + name, .technique = Technique::rub, .acupoints = {name}, .points = {}};
    for (double t = 0.0; t <= 4.0; t += 0.01) {
      press.points.push_back({t, at, normal(across[k]), 25.0 * std::min({1.0, t, 4.0 - t})});
      const Vector3 round =
          on_back(across[k] + 0.03 * std::cos(4.0 * t), height[k] + 0.03 * std::sin(4.0 * t));
      rub.points.push_back({t, round, normal(across[k]), 15.0});
    }
    const double begin_s = 1.0 + 10.0 * static_cast<double>(k / 2);
    perform(arm, begin_s, press);
    if (k < 2) perform(arm, begin_s + 5.0, rub);
    const TangentTissue tissue{12.0 + 3.0 * static_cast<double>(k),
                               90.0 + 10.0 * static_cast<double>(k)};
    data.tissue.push_back({.name = name,
                           .at_in_couch = at,
                           .estimate = {.tissue = tissue,
                                        .alpha_ci95_n = 1.0,
                                        .beta_ci95_per_m = 5.0,
                                        .presses = 3,
                                        .converged = k != 4,
                                        .converged_after_s = 2.0},
                           .truth = TangentTissue{tissue.alpha_n * 1.02, tissue.beta_per_m * 0.98},
                           .tissue_class = "hard muscle",
                           .class_probability = 0.9,
                           .stiffness_n_per_mm = 2.0 + 0.5 * static_cast<double>(k),
                           .stiffness_ci95_n_per_mm = 0.1});
  }
  // Stiffer to one side, and blank low down on the back.
  data.stiffness_at = [](const Vector3& at) {
    return at.z() < 0.1 ? std::nullopt
                        : std::optional(telemetry::MappedStiffness{3.0 + 5.0 * at.x(), 0.05});
  };
  data.changes = {{"SI11_L", 3.0, 2.7, 0.04, true}, {"SI11_R", 3.0, 2.95, 0.04, false}};
  data.condition = {{.slim = 0.07, .medium = 0.62, .hefty = 0.31, .female = 0.44}};
  data.forces = {{Technique::press, 1.21, 27.4}, {Technique::rub, 0.83, 16.2}};
  data.numbers = {{"scan error", "0.42", "mm", "root mean square to the true surface"}};
  data.config_toml = "[press]\nforce_n = 25.0\n";
  return data;
}

}  // namespace tuina::tests
