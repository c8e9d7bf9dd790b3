// SPDX-License-Identifier: Apache-2.0
#include "apps/evaluation/contact/contact_files.hpp"

#include <fmt/format.h>

#include "tuina/core/units.hpp"
#include "tuina/telemetry/plot/svg_plot.hpp"

namespace tuina::app {

std::string to_csv(const std::vector<ContactSample>& trace) {
  std::string text = "time_s,target_n,true_force_n,measured_force_n,depth_mm\n";
  for (const ContactSample& sample : trace) {
    // Six digits, so that whoever adds the errors up from here finds what the answer says.
    text += fmt::format("{:.3f},{:.6g},{:.6g},{:.6g},{:.6g}\n", sample.time_s, sample.target_n,
                        sample.true_force_n, sample.measured_force_n, to_mm(sample.depth_m));
  }
  return text;
}

std::string to_csv(const std::vector<tissue::TimedPress>& felt) {
  std::string text = "time_s,position_mm,force_n\n";
  for (const auto& [time_s, press] : felt)
    text += fmt::format("{:.3f},{:.7g},{:.6g}\n", time_s, to_mm(press.depth_m), press.force_n);
  return text;
}

std::string draw(const std::vector<ContactSample>& trace, const std::string& title) {
  telemetry::Series target{.name = "target", .colour = telemetry::palette::press, .dashed = true};
  telemetry::Series measured{
      .name = "measured", .colour = telemetry::palette::grey, .width_px = 1.0};
  telemetry::Series truth{.name = "true", .colour = telemetry::palette::ink};
  bool touched = false;
  for (const ContactSample& sample : trace) {
    touched = touched || sample.true_force_n > 0.0;
    if (!touched) continue;
    for (auto* series : {&target, &measured, &truth}) series->x.push_back(sample.time_s);
    target.y.push_back(sample.target_n);
    measured.y.push_back(sample.measured_force_n);
    truth.y.push_back(sample.true_force_n);
  }
  telemetry::Plot plot{.title = title, .x_label = "time, s", .y_label = "force, N"};
  plot.series = {measured, target, truth};
  plot.y_low = 0.0;
  return telemetry::to_svg(plot);
}

}  // namespace tuina::app
