// SPDX-License-Identifier: Apache-2.0
#include "tuina/body/learn/example.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <optional>
#include <set>

#include "tuina/core/io/text_lines.hpp"
#include "tuina/core/parallel.hpp"
#include "tuina/core/units.hpp"

namespace tuina::body {
namespace {

std::string other_side(const std::string& name) {
  if (name.ends_with("_L")) return name.substr(0, name.size() - 1) + "R";
  if (name.ends_with("_R")) return name.substr(0, name.size() - 1) + "L";
  return name;
}

const Vector3 flip(-1.0, 1.0, 1.0);

std::optional<std::size_t> index_of(const std::vector<std::string>& names,
                                    const std::string& name) {
  const auto found = std::find(names.begin(), names.end(), name);
  if (found == names.end()) return {};
  return static_cast<std::size_t>(found - names.begin());
}

/// Bodies of one position are learned from together, so each label is on all of them.
Result<void> check_same_labels(const Examples& examples, const std::string& first,
                               const LabelledBody& body) {
  std::set<std::string> wanted(examples.acupoints.begin(), examples.acupoints.end());
  wanted.insert(examples.landmarks.begin(), examples.landmarks.end());
  std::set<std::string> names;
  for (const Acupoint& point : body.acupoints) names.insert(point.name);
  for (const Landmark& landmark : body.landmarks) names.insert(landmark.name);
  std::vector<std::string> missing;
  std::vector<std::string> more;
  std::set_difference(wanted.begin(), wanted.end(), names.begin(), names.end(),
                      std::back_inserter(missing));
  std::set_difference(names.begin(), names.end(), wanted.begin(), wanted.end(),
                      std::back_inserter(more));
  if (missing.empty() && more.empty()) return {};
  const bool lacks = !missing.empty();
  return fail(Fault::bad_input,
              "{} lacks {}, which {} has; bodies that are learned from together need the same "
              "labels",
              lacks ? body.id : first, listed(lacks ? missing : more), lacks ? first : body.id);
}

/// The labels of a body in the order of the examples.
Places labels_like(const Examples& examples, const LabelledBody& body) {
  std::map<std::string, Vector3> labels;
  for (const auto& landmark : body.landmarks) labels[landmark.name] = landmark.at_in_couch;
  for (const auto& acupoint : body.acupoints) labels[acupoint.name] = acupoint.at_in_couch;
  Places places(3,
                static_cast<Eigen::Index>(examples.acupoints.size() + examples.landmarks.size()));
  Eigen::Index k = 0;
  for (const auto* names : {&examples.acupoints, &examples.landmarks})
    for (const std::string& name : *names) places.col(k++) = labels.at(name);
  return places;
}

BackSurface mirrored(const BackSurface& back) {
  PointCloud cloud = back.points();
  for (Vector3& p : cloud.points) p = p.cwiseProduct(flip);
  for (Vector3& n : cloud.normals) n = n.cwiseProduct(flip);
  return {std::move(cloud), back.position(), back.spacing_m()};
}

/// Who has the same labels already, as the same person under another name has, also where the copy
/// was moved.
std::optional<std::size_t> find_twin(const Examples& examples, const Places& labels) {
  constexpr double same_m = 0.1_mm;
  const auto span_m = [](const Places& of) { return (of.rightCols<1>() - of.col(0)).norm(); };
  const auto same = std::ranges::find_if(examples.labels_in_couch, [&](const Places& others) {
    // Whom one distance tells apart is not aligned: thousands of people are compared in pairs.
    if (std::abs(span_m(others) - span_m(labels)) > 4.0 * same_m) return false;
    return (align(others, labels) * others - labels).cwiseAbs().maxCoeff() < same_m;
  });
  if (same == examples.labels_in_couch.end()) return std::nullopt;
  return static_cast<std::size_t>(same - examples.labels_in_couch.begin());
}

}  // namespace

Result<Example> make_example(const LabelledBody& body, BodySource::Needs needs) {
  const bool scanned = needs == BodySource::Needs::scan && body.scan_in_couch.size() > 0;
  auto back = scanned ? fit_back(body.scan_in_couch, {.position = body.position})
                      : fit_back(sample(body.skin_in_couch, 4_mm), {.position = body.position});
  if (!back) return fail(back.error().fault, "{}: {}", body.id, back.error().message);
  return Example{std::move(*back), body.acupoints, body.landmarks};
}

Example mirrored(const Example& example) {
  Example twin{mirrored(example.back), example.acupoints, example.landmarks};
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

BodySource source_of(const std::vector<LabelledBody>& bodies) {
  return {.count = bodies.size(), .read = [&bodies](std::size_t number, BodySource::Needs) {
            return Result<LabelledBody>(bodies[number]);
          }};
}

bool Examples::have(const std::string& name) const {
  return index_of(acupoints, name) || index_of(landmarks, name);
}

Result<Example> Examples::make(std::size_t i, BodySource::Needs needs) const {
  const auto body = source->read(numbers[i], needs);
  if (!body) return tl::unexpected(body.error());
  return make_example(*body, needs);
}

void Examples::leave_out(std::size_t i) {
  numbers.erase(numbers.begin() + static_cast<std::ptrdiff_t>(i));
  labels_in_couch.erase(labels_in_couch.begin() + static_cast<std::ptrdiff_t>(i));
}

Places labels_in_couch(const Examples& examples, std::size_t i,
                       const std::vector<std::string>& names) {
  Places places(3, static_cast<Eigen::Index>(names.size()));
  for (std::size_t k = 0; k < names.size(); ++k) {
    const auto acupoint = index_of(examples.acupoints, names[k]);
    const auto at =
        acupoint ? *acupoint
                 : examples.acupoints.size() + index_of(examples.landmarks, names[k]).value();
    places.col(static_cast<Eigen::Index>(k)) =
        examples.labels_in_couch[i].col(static_cast<Eigen::Index>(at));
  }
  return places;
}

Result<std::array<Examples, 2>> read_examples(const BodySource& source, const Progress& progress) {
  std::array<Examples, 2> both;
  both[1].position = BodyPosture::prone;
  std::array<std::vector<std::string>, 2> ids;
  const auto read = [&](std::size_t number) {
    return source.read(number, BodySource::Needs::skin);
  };
  const auto take = [&](std::size_t number, const Result<LabelledBody>& body) -> Result<void> {
    if (!body) return tl::unexpected(body.error());
    const std::size_t k = body->position == BodyPosture::sitting ? 0 : 1;
    Examples& examples = both[k];
    examples.source = &source;
    if (examples.size() == 0) {
      for (const Acupoint& point : body->acupoints) examples.acupoints.push_back(point.name);
      for (const Landmark& mark : body->landmarks) examples.landmarks.push_back(mark.name);
    }
    ids[k].push_back(body->id);
    if (auto same = check_same_labels(examples, ids[k].front(), *body); !same) return same;
    Places labels = labels_like(examples, *body);
    if (const auto twin = find_twin(examples, labels))
      return fail(
          Fault::bad_input,
          "{}: its labels are those of {}; whoever is learned from twice is never left out, "
          "and the atlas would look surer than it is",
          body->id, ids[k][*twin]);
    examples.numbers.push_back(number);
    examples.labels_in_couch.push_back(std::move(labels));
    if (progress) progress(static_cast<double>(number + 1) / static_cast<double>(source.count));
    return {};
  };
  if (const auto all = for_each_in_order(source.count, read, take); !all)
    return tl::unexpected(all.error());
  return both;
}

std::size_t medium_of(const Examples& examples, const std::vector<std::string>& names) {
  Places mean = labels_in_couch(examples, 0, names);
  for (int round = 0; round < 3; ++round) {
    Places sum = Places::Zero(3, mean.cols());
    for (std::size_t i = 0; i < examples.size(); ++i) {
      const Places labels = labels_in_couch(examples, i, names);
      sum += align(labels, mean) * labels / static_cast<double>(examples.size());
    }
    mean = sum;
  }
  std::size_t medium = 0;
  double nearest = std::numeric_limits<double>::max();
  for (std::size_t i = 0; i < examples.size(); ++i) {
    const Places labels = labels_in_couch(examples, i, names);
    const double far = (align(labels, mean) * labels - mean).squaredNorm();
    if (far < nearest) {
      nearest = far;
      medium = i;
    }
  }
  return medium;
}

}  // namespace tuina::body
