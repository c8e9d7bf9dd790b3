// SPDX-License-Identifier: Apache-2.0
#include "tuina/body/atlas.hpp"

#include <algorithm>

#include "tuina/body/learn/learn_shape.hpp"
#include "tuina/core/parallel.hpp"

namespace tuina::body {
namespace {

/// The labels of the model that the examples have.
std::vector<std::string> shared_names(const Examples& examples, const ShapeModel& shape) {
  std::vector<std::string> names;
  for (const auto& name : shape.labels)
    if (examples.have(name)) names.push_back(name);
  return names;
}

/// Leaves out whom the room cannot make a back of, with the cause.
Result<void> leave_out_unusable(Examples& examples, std::vector<std::string>& causes,
                                const Progress& progress) {
  const auto cause_of = [&](std::size_t i) -> Result<std::string> {
    const auto body = examples.source->read(examples.numbers[i], BodySource::Needs::scan);
    if (!body) return tl::unexpected(body.error());
    auto example = make_example(*body);
    if (example && body->scan_in_couch.size() > 0)
      example = make_example(*body, BodySource::Needs::scan);
    return example ? "" : example.error().message;
  };
  std::vector<std::size_t> unusable;
  const auto note = [&](std::size_t i, const Result<std::string>& cause) -> Result<void> {
    if (!cause) return tl::unexpected(cause.error());
    if (!cause->empty()) {
      causes.push_back(*cause);
      unusable.push_back(i);
    }
    if (progress) progress(static_cast<double>(i + 1) / static_cast<double>(examples.size()));
    return {};
  };
  auto tried = for_each_in_order(examples.size(), cause_of, note);
  for (; !unusable.empty(); unusable.pop_back()) examples.leave_out(unusable.back());
  return tried;
}

/// Tells a part of the way.
Progress part_of(const Progress& progress, double from, double share) {
  if (!progress) return {};
  return [=](double done) { progress(from + share * done); };
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
Result<Standard> make_standard(Examples& examples, const ShapeModel& shape) {
  while (examples.size() > 0) {
    const std::size_t medium = medium_of(examples, shared_names(examples, shape));
    const auto made = examples.make(medium, BodySource::Needs::skin);
    if (!made) return tl::unexpected(made.error());
    const Example& example = *made;
    const auto outline = find_outline(example.back);
    if (!outline) {
      examples.leave_out(medium);
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

void keep_radii_above(const Atlas& other, Atlas& atlas) {
  for (auto& position : atlas.positions) {
    ShapeModel& shape = position.shape;
    const PositionAtlas* same = other.of(shape.position);
    if (same == nullptr) continue;
    const auto& names = same->shape.labels;
    for (std::size_t i = 0; i < shape.labels.size(); ++i) {
      const auto found = std::ranges::find(names, shape.labels[i]);
      if (found == names.end()) continue;
      double& radius_m = shape.radius95_m[static_cast<Eigen::Index>(i)];
      radius_m = std::max(radius_m, same->shape.radius95_m[found - names.begin()]);
    }
  }
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
  return learn_atlas(source_of(bodies), prior, progress, report, reach);
}

Result<Atlas> learn_atlas(const BodySource& bodies, const Atlas* prior, const Progress& progress,
                          LearnReport* report, Reach reach) {
  Atlas atlas;
  LearnReport learned;
  double sum_mm = 0.0;
  double parts = 0.0;
  auto read = read_examples(bodies, part_of(progress, 0.0, 0.1));
  if (!read) return tl::unexpected(read.error());
  double begun = 0.1;
  for (Examples& examples : *read) {
    const std::size_t count = examples.size();
    if (count == 0) continue;
    const double share = 0.9 * static_cast<double>(count) / static_cast<double>(bodies.count);
    const Progress step = part_of(progress, begun, share);
    begun += share;
    if (auto tried = leave_out_unusable(examples, learned.skipped, part_of(step, 0.0, 0.2)); !tried)
      return tl::unexpected(tried.error());
    // More than one failed body in ten means that something is wrong with the folder.
    if (examples.size() == 0 || 10 * learned.skipped.size() > bodies.count) {
      return fail(Fault::bad_input,
                  "{} of {} labelled bodies cannot be learned from, the first: {}",
                  learned.skipped.size(), bodies.count, learned.skipped.front());
    }
    LearnOptions options;
    const PositionAtlas* known = prior != nullptr ? prior->of(examples.position) : nullptr;
    options.reach = reach;
    if (known != nullptr) options.prior = &known->shape;
    Eigen::MatrixXd left_out_mm;
    auto shape = learn_shape(examples, options, part_of(step, 0.2, 0.8), &left_out_mm);
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
