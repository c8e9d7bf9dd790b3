// SPDX-License-Identifier: Apache-2.0
#include "apps/tuina/calibrate/calibrate_wrist.hpp"

#include <nlohmann/json.hpp>

#include "tuina/core/io/file.hpp"
#include "tuina/core/units.hpp"
#include "tuina/hardware/wrist_calibration.hpp"

namespace tuina::app {

Result<Answer> calibrate_wrist(const std::filesystem::path& poses,
                               const std::filesystem::path& out) {
  const auto read = hardware::read_wrist_poses(poses);
  if (!read) return tl::unexpected(read.error());
  const auto fit = hardware::fit_wrist(*read);
  if (!fit) return fail(fit.error().fault, "{}: {}", poses.string(), fit.error().message);
  if (const auto written = write_file(out, hardware::to_toml(fit->found)); !written)
    return tl::unexpected(written.error());
  const auto list = [](const Vector3& v) { return nlohmann::json{v.x(), v.y(), v.z()}; };
  const hardware::WristCalibration& found = fit->found;
  const Vector3& offset_n = found.offset_in_tool.force_n;
  const Vector3 com_mm = 1e3 * found.com_in_tool_m;
  return Answer{
      .json = nlohmann::json{{"poses", read->size()},
                             {"mass_kg", found.mass_kg},
                             {"com_mm", list(com_mm)},
                             {"offset_n", list(offset_n)},
                             {"offset_nm", list(found.offset_in_tool.torque_nm)},
                             {"condition", fit->condition},
                             {"force_rms_n", fit->force_rms_n},
                             {"max_force_n", fit->max_force_n},
                             {"torque_rms_nm", fit->torque_rms_nm},
                             {"standard_deviations",
                              {{"mass_kg", fit->mass_sd_kg},
                               {"com_mm", to_mm(fit->com_sd_m)},
                               {"offset_n", fit->offset_sd_n},
                               {"offset_nm", fit->offset_sd_nm}}}}
                  .dump(2),
      .text = fmt::format(
          "{} poses agree to {:.3f} N and {:.4f} Nm RMS, condition {:.1f}\n"
          "tool {:.3f} +- {:.3f} kg, centre ({:.1f}, {:.1f}, {:.1f}) +- {:.1f} mm, offset ({:.2f}, "
          "{:.2f}, {:.2f}) +- {:.2f} N\nnow: mass_kg = {:.3f} into [tool] of the robot's table, "
          "calibration = \"{}\" into the device file",
          read->size(), fit->force_rms_n, fit->torque_rms_nm, fit->condition, found.mass_kg,
          2.0 * fit->mass_sd_kg, com_mm.x(), com_mm.y(), com_mm.z(), 2.0 * to_mm(fit->com_sd_m),
          offset_n.x(), offset_n.y(), offset_n.z(), 2.0 * fit->offset_sd_n, found.mass_kg,
          out.filename().string())};
}

}  // namespace tuina::app
