// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "tuina/telemetry/picture/scan_mesh.hpp"
#include "tuina/telemetry/report/report_data.hpp"

/// The beginning of every picture of a back.
namespace tuina::telemetry::figures {

/// Out of the back and towards the head, from the points if there are any and else from the
/// position.
struct BackPose {
  Vector3 out;
  Vector3 up;
};
/// The pose of the back in a report's scan.
[[nodiscard]] BackPose pose_of(const ReportData& data);

/// The part of the scan that shows the person; the couch would only draw the eye away. No triangles
/// if there is no scan.
[[nodiscard]] PictureMesh person_of(const ReportData& data, const BackPose& pose,
                                    double cell_m = 0.003);

/// The places of a path lifted onto the skin, without those that no eye could tell apart.
[[nodiscard]] std::vector<Vector3> lifted(const ContactPath& path, double by_m);

}  // namespace tuina::telemetry::figures
