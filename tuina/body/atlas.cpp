// SPDX-License-Identifier: Apache-2.0
#include "tuina/body/atlas.hpp"

#include <algorithm>
#include <iterator>
#include <set>

#include "tuina/body/learn/learn_shape.hpp"
#include "tuina/core/io/text_lines.hpp"

namespace tuina::body {
namespace {

/// The labels of the model that every example has.
std::vector<std::string> shared_names(const std::vector<Example>& examples,
                                      const ShapeModel& shape) {
  std::vector<std::string> names;
  for (const auto& name : shape.labels) {
    if (std::all_of(examples.begin(), examples.end(),
                    [&](const Example& e) { return labels_of(e).contains(name); })) {
      names.push_back(name);
    }
  }
  return names;
}

/// Bodies of one position are learned from together, so each label is on all of them.
Result<void> check_same_labels(const std::vector<LabelledBody>& bodies, BodyPosture position) {
  const LabelledBody* first = nullptr;
  std::set<std::string> wanted;
  for (const LabelledBody& body : bodies) {
    if (body.position != position) continue;
    std::set<std::string> names;
    for (const Acupoint& point : body.acupoints) names.insert(point.name);
    for (const Landmark& landmark : body.landmarks) names.insert(landmark.name);
    if (first == nullptr) {
      first = &body;
      wanted = names;
    }
    std::vector<std::string> missing;
    std::vector<std::string> more;
    std::set_difference(wanted.begin(), wanted.end(), names.begin(), names.end(),
                        std::back_inserter(missing));
    std::set_difference(names.begin(), names.end(), wanted.begin(), wanted.end(),
                        std::back_inserter(more));
    if (missing.empty() && more.empty()) continue;
    const bool lacks = !missing.empty();
    return fail(Fault::bad_input,
                "{} lacks {}, which {} has; bodies that are learned from together need the same "
                "labels",
                lacks ? body.id : first->id, listed(lacks ? missing : more),
                lacks ? first->id : body.id);
  }
  return {};
}

/// Pose of the model's mean on an example, from their shared labels.
Transform example_pose(const Example& example, const ShapeModel& shape) {
  const auto labels = labels_of(example);
  std::vector<Vector3> from;
  std::vector<Vector3> to;
  for (std::size_t i = 0; i < shape.labels.size(); ++i) {
    const auto own = labels.find(shape.labels[i]);
    if (own == labels.end()) continue;
    from.emplace_back(shape.mean.col(shape.skin_points() + static_cast<Eigen::Index>(i)));
    to.push_back(own->second);
  }
  const auto count = static_cast<Eigen::Index>(from.size());
  return align(Eigen::Map<const Places>(from.front().data(), 3, count),
               Eigen::Map<const Places>(to.front().data(), 3, count));
}

/// Standard model of the thesis: the medium back, or the next one with a usable outline.
Result<Standard> make_standard(std::vector<Example>& examples, const ShapeModel& shape) {
  while (!examples.empty()) {
    const auto medium =
        static_cast<std::ptrdiff_t>(medium_of(examples, shared_names(examples, shape)));
    const Example& example = examples[static_cast<std::size_t>(medium)];
    const auto outline = find_outline(example.back);
    if (!outline) {
      examples.erase(examples.begin() + medium);
      continue;
    }
    Standard standard;
    standard.lines = feature_lines(*outline);
    const Transform couch_from_model = example_pose(example, shape);
    const auto labels = labels_of(example);
    for (std::size_t i = 0; i < shape.labels.size(); ++i) {
      const auto own = labels.find(shape.labels[i]);
      const Vector3 at = own != labels.end()
                             ? own->second
                             : couch_from_model * shape.mean.col(shape.skin_points() +
                                                                 static_cast<Eigen::Index>(i));
      standard.marks.push_back(outline->plane(at));
    }
    return standard;
  }
  return fail(Fault::bad_input, "no labelled body shows the outline of a whole back");
}

}  // namespace

const PositionAtlas* Atlas::of(BodyPosture position) const {
  for (const auto& candidate : positions) {
    if (candidate.shape.position == position) return &candidate;
  }
  return nullptr;
}

std::vector<FeatureLine> feature_lines(const Outline& outline) {
  const Vector2 neck = 0.5 * (outline.neck[left] + outline.neck[right]);
  return {{outline.shoulder[right], outline.shoulder[left]},
          {neck, outline.bottom},
          {outline.neck[right], outline.neck[left]},
          {outline.shoulder[left], outline.trunk[left]},
          {outline.shoulder[right], outline.trunk[right]},
          {outline.trunk[right], outline.trunk[left]}};
}

Result<Atlas> learn_atlas(const std::vector<LabelledBody>& bodies, const Atlas* prior,
                          const Progress& progress, LearnReport* report, Reach reach) {
  Atlas atlas;
  LearnReport learned;
  double sum_mm = 0.0;
  double parts = 0.0;
  for (const BodyPosture position : {BodyPosture::sitting, BodyPosture::prone}) {
    const auto count = std::count_if(bodies.begin(), bodies.end(),
                                     [&](const LabelledBody& b) { return b.position == position; });
    if (count == 0) continue;
    if (auto same = check_same_labels(bodies, position); !same) return tl::unexpected(same.error());
    const double share = static_cast<double>(count) / static_cast<double>(bodies.size());
    const double from = position == BodyPosture::sitting ? 0.0 : 1.0 - share;
    const auto step = [&](double done) {
      if (progress) progress(from + share * done);
    };
    std::vector<Example> examples;
    for (const LabelledBody& body : bodies) {
      if (body.position != position) continue;
      auto example = make_example(body);
      if (example) {
        examples.push_back(std::move(*example));
      } else {
        learned.skipped.push_back(example.error().message);
      }
      step(0.2 * static_cast<double>(examples.size()) / static_cast<double>(count));
    }
    // More than one failed body in ten means that something is wrong with the folder.
    if (examples.empty() || 10 * learned.skipped.size() > bodies.size()) {
      return fail(Fault::bad_input,
                  "{} of {} labelled bodies cannot be learned from, the first: {}",
                  learned.skipped.size(), bodies.size(), learned.skipped.front());
    }
    LearnOptions options;
    const PositionAtlas* known = prior != nullptr ? prior->of(position) : nullptr;
    options.reach = reach;
    if (known != nullptr) options.prior = &known->shape;
    Eigen::MatrixXd left_out_mm;
    auto shape = learn_shape(
        examples, options, [&](double done) { step(0.2 + 0.8 * done); }, &left_out_mm);
    if (!shape) return tl::unexpected(shape.error());
    if (left_out_mm.rows() >= 7) {
      sum_mm += left_out_mm.topRows(7).mean() * static_cast<double>(count);
      parts += static_cast<double>(count);
    }
    learned.bodies += static_cast<int>(examples.size());
    auto standard = make_standard(examples, *shape);
    if (!standard) return tl::unexpected(standard.error());
    PositionAtlas made{std::move(*standard), std::move(*shape)};
    learned.points = std::max(learned.points, static_cast<int>(made.shape.labels.size()));
    learned.modes = std::max(learned.modes, static_cast<int>(made.shape.modes.cols()));
    atlas.positions.push_back(std::move(made));
  }
  if (atlas.positions.empty()) return fail(Fault::bad_input, "no labelled body to learn from");
  if (parts > 0.0) learned.leave_one_out_mm = sum_mm / parts;
  atlas.made = fmt::format("learned from {} labelled bodies{}", learned.bodies,
                           prior != nullptr ? ", beginning with a prior" : "");
  if (report != nullptr) *report = learned;
  return atlas;
}

}  // namespace tuina::body
