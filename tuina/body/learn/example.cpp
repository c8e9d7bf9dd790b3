// SPDX-License-Identifier: Apache-2.0
#include "tuina/body/learn/example.hpp"

#include <limits>

#include "tuina/core/units.hpp"

namespace tuina::body {
namespace {

std::string other_side(const std::string& name) {
  if (name.ends_with("_L")) return name.substr(0, name.size() - 1) + "R";
  if (name.ends_with("_R")) return name.substr(0, name.size() - 1) + "L";
  return name;
}

const Vector3 flip(-1.0, 1.0, 1.0);

BackSurface mirrored(const BackSurface& back) {
  PointCloud cloud = back.points();
  for (Vector3& p : cloud.points) p = p.cwiseProduct(flip);
  for (Vector3& n : cloud.normals) n = n.cwiseProduct(flip);
  return {std::move(cloud), back.position(), back.spacing_m()};
}

}  // namespace

Result<Example> make_example(const LabelledBody& body) {
  auto back = fit_back(sample(body.skin_in_couch, 4_mm), {.position = body.position});
  if (!back) return fail(back.error().fault, "{}: {}", body.id, back.error().message);
  Example example{std::move(*back), body.acupoints, body.landmarks, {}};
  if (body.scan_in_couch.size() > 0) {
    auto scanned = fit_back(body.scan_in_couch, {.position = body.position});
    if (!scanned) return fail(scanned.error().fault, "{}: {}", body.id, scanned.error().message);
    example.scanned = std::move(*scanned);
  }
  return example;
}

Example mirrored(const Example& example) {
  Example twin{mirrored(example.back), example.acupoints, example.landmarks, {}};
  if (example.scanned) twin.scanned = mirrored(*example.scanned);
  for (auto& point : twin.acupoints) {
    point.name = other_side(point.name);
    point.at_in_couch = point.at_in_couch.cwiseProduct(flip);
    point.normal_in_couch = point.normal_in_couch.cwiseProduct(flip);
  }
  for (auto& landmark : twin.landmarks) {
    landmark.name = other_side(landmark.name);
    landmark.at_in_couch = landmark.at_in_couch.cwiseProduct(flip);
  }
  return twin;
}

std::map<std::string, Vector3> labels_of(const Example& example) {
  std::map<std::string, Vector3> labels;
  for (const auto& landmark : example.landmarks) labels[landmark.name] = landmark.at_in_couch;
  for (const auto& acupoint : example.acupoints) labels[acupoint.name] = acupoint.at_in_couch;
  return labels;
}

Places labels_in_couch(const Example& example, const std::vector<std::string>& names) {
  const auto labels = labels_of(example);
  Places places(3, static_cast<Eigen::Index>(names.size()));
  for (std::size_t i = 0; i < names.size(); ++i)
    places.col(static_cast<Eigen::Index>(i)) = labels.at(names[i]);
  return places;
}

std::size_t medium_of(const std::vector<Example>& examples, const std::vector<std::string>& names) {
  Places mean = labels_in_couch(examples.front(), names);
  for (int round = 0; round < 3; ++round) {
    Places sum = Places::Zero(3, mean.cols());
    for (const Example& e : examples) {
      const Places labels = labels_in_couch(e, names);
      sum += align(labels, mean) * labels / static_cast<double>(examples.size());
    }
    mean = sum;
  }
  std::size_t medium = 0;
  double nearest = std::numeric_limits<double>::max();
  for (std::size_t i = 0; i < examples.size(); ++i) {
    const Places labels = labels_in_couch(examples[i], names);
    const double far = (align(labels, mean) * labels - mean).squaredNorm();
    if (far < nearest) {
      nearest = far;
      medium = i;
    }
  }
  return medium;
}

}  // namespace tuina::body
