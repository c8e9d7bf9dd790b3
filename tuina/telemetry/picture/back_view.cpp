// SPDX-License-Identifier: Apache-2.0
#include "tuina/telemetry/picture/back_view.hpp"

#include "tuina/core/units.hpp"

namespace tuina::telemetry::figures {
namespace {

constexpr double couch_m = 20_mm;  // below this a point is the couch's, not the person's

}  // namespace

BackPose pose_of(const ReportData& data) {
  const bool sitting = data.position == BodyPosture::sitting;
  BackPose pose{.out = sitting ? Vector3(0, 1, 0) : Vector3(0, 0, 1),
                .up = sitting ? Vector3(0, 0, 1) : Vector3(0, -1, 0)};
  Vector3 out = Vector3::Zero();
  Vector3 upper = Vector3::Zero();
  Vector3 lower = Vector3::Zero();
  int upper_count = 0;
  int lower_count = 0;
  for (const FoundAcupoint& found : data.acupoints) {
    out += found.acupoint.normal_in_couch;
    if (found.acupoint.name.starts_with("SI11")) {
      upper += found.acupoint.at_in_couch;
      ++upper_count;
    } else if (found.acupoint.name == "GV4") {
      lower += found.acupoint.at_in_couch;
      ++lower_count;
    }
  }
  if (out.norm() > 1e-6) pose.out = out.normalized();
  if (upper_count > 0 && lower_count > 0) {
    const Vector3 up = upper / upper_count - lower / lower_count;
    if (up.cross(pose.out).norm() > 1e-3) pose.up = up.normalized();
  }
  return pose;
}

PictureMesh person_of(const ReportData& data, const BackPose& pose, double cell_m) {
  PointCloud person;
  for (const Vector3& point : data.scan_in_couch.points) {
    if (point.z() > couch_m) person.points.push_back(point);
  }
  return mesh_scan(person, pose.out, cell_m);
}

std::vector<Vector3> lifted(const ContactPath& path, double by_m) {
  std::vector<Vector3> places;
  for (const ContactPoint& point : path.points) {
    const Vector3 place = point.at_in_couch + by_m * point.normal_in_couch;
    if (!places.empty() && (place - places.back()).norm() < 1_mm) continue;
    places.push_back(place);
  }
  return places;
}

}  // namespace tuina::telemetry::figures
