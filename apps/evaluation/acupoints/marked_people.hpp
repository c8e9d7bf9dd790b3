// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "tuina/body/atlas.hpp"
#include "tuina/core/progress.hpp"
#include "tuina/core/surface.hpp"

namespace tuina::app {

/// Scan of a person who sits or stands, in the couch frame of one who sits, with the line along the
/// spinous processes and the height of GV4 as somebody has felt or X-rayed them.
struct MarkedPerson {
  std::string id;
  std::string group;  ///< the name up to its first `_`, and whether the person is bent sideways
  PointCloud scan_in_couch;
  std::vector<Vector3> spinous_line_in_couch;
  double gv4_z_m = 0.0;
  bool gv4_z_known = true;  ///< false where the picture with the height did not fit the scan
};

/// All `NAME.ply` of a folder with `NAME.json` beside them, sorted by name. Keys, in metres:
/// `spinous_line`, points; `L2L3_disc_z`, else `GV4_z_expected`, the height of GV4. Where there
/// are: `registration_spread_mm` (heights above 15 are not judged), `bend_deg` (bent: more than
/// 10).
[[nodiscard]] Result<std::vector<MarkedPerson>> read_marked_people(
    const std::filesystem::path& folder);

/// What `surface` answers on them, by group: how many are answered; GV4 along the spine (the
/// height, towards the head) and across it (distance from the line), in millimetres; the share of
/// GV4 within its radius; points of the midline farther from the line than their radius and than 15
/// mm; the refused, with the cause.
[[nodiscard]] nlohmann::json judge_marked_people(const std::vector<MarkedPerson>& people,
                                                 const body::Atlas& atlas,
                                                 const Progress& progress);

/// The table that people read of it.
[[nodiscard]] std::string marked_people_text(const nlohmann::json& judged);

}  // namespace tuina::app
