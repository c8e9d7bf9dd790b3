// SPDX-License-Identifier: Apache-2.0
#include "tuina/body/learn_shape.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <map>

#include "tuina/body/voxels.hpp"
#include "tuina/core/units.hpp"

namespace tuina::body {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double skin_spacing_m = 13_mm;
constexpr double skin_reach_m = 65_mm;  // the model's skin ends this far beyond its labels
constexpr double coarse_m = 30_mm;      // how one back alone is expected to differ from another
constexpr double coarse_length_m = 180_mm;
constexpr double fine_length_m = 70_mm;

std::string other_side(const std::string& name) {
  if (name.ends_with("_L")) return name.substr(0, name.size() - 1) + "R";
  if (name.ends_with("_R")) return name.substr(0, name.size() - 1) + "L";
  return name;
}

std::map<std::string, Vector3> labels_of(const Example& example) {
  std::map<std::string, Vector3> labels;
  for (const auto& landmark : example.landmarks) labels[landmark.name] = landmark.at_in_couch;
  for (const auto& acupoint : example.acupoints) labels[acupoint.name] = acupoint.at_in_couch;
  return labels;
}

Places labels_in_couch(const Example& example, const std::vector<std::string>& names) {
  const auto labels = labels_of(example);
  Places places(3, static_cast<Index>(names.size()));
  for (std::size_t i = 0; i < names.size(); ++i) places.col(static_cast<Index>(i)) = labels.at(names[i]);
  return places;
}

/// The smooth map that carries labels onto labels: affine plus |r| splines in space, the 3D sibling of the
/// thin plate.
class Spline {
 public:
  Spline(const Places& from, const Places& to) : from_(from) {
    const Index n = from.cols();
    const bool affine = n >= 7;
    affine_ = affine ? 4 : 1;
    MatrixXd system = MatrixXd::Zero(n + affine_, n + affine_);
    for (Index i = 0; i < n; ++i) {
      for (Index j = 0; j < n; ++j) system(i, j) = -(from.col(i) - from.col(j)).norm();
      system(i, i) += 2_mm;  // labels a few millimetres apart need not tear the skin between them
      system(i, n) = system(n, i) = 1.0;
      if (affine) {
        system.block<1, 3>(i, n + 1) = from.col(i).transpose();
        system.block<3, 1>(n + 1, i) = from.col(i);
      }
    }
    MatrixXd values = MatrixXd::Zero(n + affine_, 3);
    values.topRows(n) = affine ? to.transpose() : (to - from).transpose().eval();
    coefficients_ = system.partialPivLu().solve(values);
  }
  [[nodiscard]] Vector3 operator()(const Vector3& x) const {
    const Index n = from_.cols();
    Vector3 y = coefficients_.row(n).transpose();
    if (affine_ == 4) {
      y += coefficients_.bottomRows(3).transpose() * x;
    } else {
      y += x;
    }
    for (Index i = 0; i < n; ++i) y -= (x - from_.col(i)).norm() * coefficients_.row(i).transpose();
    return y;
  }

 private:
  Places from_;
  MatrixXd coefficients_;
  Index affine_ = 1;
};

struct Template {
  Places skin;     ///< in the outline frame of the example it is taken from
  Places normals;
  Places labels;
  std::vector<std::vector<Index>> neighbours;
};

void find_neighbours(Template& made) {
  constexpr Index count = 8;
  for (Index i = 0; i < made.skin.cols(); ++i) {
    const VectorXd far = (made.skin.colwise() - made.skin.col(i)).colwise().squaredNorm();
    std::vector<Index> order(static_cast<std::size_t>(far.size()));
    for (std::size_t k = 0; k < order.size(); ++k) order[k] = static_cast<Index>(k);
    std::partial_sort(order.begin(), order.begin() + count + 1, order.end(), [&](Index a, Index b) {
      return far[a] != far[b] ? far[a] < far[b] : a < b;
    });
    made.neighbours.emplace_back(order.begin() + 1, order.begin() + count + 1);
  }
}

Template make_template(const Example& example, const std::vector<std::string>& names) {
  Template made;
  made.labels = example.outline.back_from_couch * labels_in_couch(example, names);
  std::vector<Vector3> near;
  const double reach = names.size() < 20 ? 2.0 * skin_reach_m : skin_reach_m;
  for (const Vector3& p : example.back.points().points) {
    const Vector3 q = example.outline.back_from_couch * p;
    if ((made.labels.colwise() - q).colwise().norm().minCoeff() < reach) near.push_back(q);
  }
  const Voxels thinned = gather(near, skin_spacing_m);
  const Transform couch_from_back = example.outline.back_from_couch.inverse();
  made.skin.resize(3, static_cast<Index>(thinned.size()));
  made.normals.resize(3, made.skin.cols());
  for (Index i = 0; i < made.skin.cols(); ++i) {
    const auto found = example.back.nearest(couch_from_back * thinned.mean[static_cast<std::size_t>(i)]);
    made.skin.col(i) = example.outline.back_from_couch * found.at_in_couch;
    made.normals.col(i) = example.outline.back_from_couch.linear() * found.normal_in_couch;
  }
  find_neighbours(made);
  return made;
}

Template template_of(const ShapeModel& prior) {
  Template made;
  const Index n = prior.skin_points();
  made.skin = prior.mean.leftCols(n);
  made.normals = prior.normals;
  made.labels = prior.mean.rightCols(prior.mean.cols() - n);
  find_neighbours(made);
  return made;
}

/// The template's skin on another back: carried by the labels, then laid onto the skin along its normals.
Places correspond(const Template& standard, const Example& example, const std::vector<std::string>& names) {
  const auto known = labels_of(example);
  std::vector<Index> shared;
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (known.contains(names[i])) shared.push_back(static_cast<Index>(i));
  }
  Places from(3, static_cast<Index>(shared.size()));
  Places to(3, from.cols());
  for (Index i = 0; i < from.cols(); ++i) {
    from.col(i) = standard.labels.col(shared[static_cast<std::size_t>(i)]);
    to.col(i) = known.at(names[static_cast<std::size_t>(shared[static_cast<std::size_t>(i)])]);
  }
  const Spline carry(from, to);
  Places labels(3, standard.labels.cols());
  for (Index i = 0; i < labels.cols(); ++i) {
    const auto own = known.find(names[static_cast<std::size_t>(i)]);
    labels.col(i) = own != known.end() ? own->second : carry(standard.labels.col(i));
  }
  const Index n = standard.skin.cols();
  Places skin(3, n);
  for (Index i = 0; i < n; ++i) skin.col(i) = carry(standard.skin.col(i));
  for (int round = 0; round < 3; ++round) {
    Places step = Places::Zero(3, n);
    std::vector<bool> found(static_cast<std::size_t>(n), false);
    for (Index i = 0; i < n; ++i) {
      const SurfacePoint at = example.back.nearest(skin.col(i));
      const Vector3 off = at.at_in_couch - skin.col(i);
      const double along = at.normal_in_couch.dot(off);
      if (std::abs(along) > 40_mm || (off - along * at.normal_in_couch).norm() > 8_mm + 0.5 * std::abs(along)) continue;
      found[static_cast<std::size_t>(i)] = true;
      step.col(i) = along * at.normal_in_couch;
    }
    Places smooth = step;
    for (int pass = 0; pass < (round == 2 ? 1 : 6); ++pass) {
      Places next = smooth;
      for (Index i = 0; i < n; ++i) {
        Vector3 sum = Vector3::Zero();
        int count = 0;
        for (const Index j : standard.neighbours[static_cast<std::size_t>(i)]) {
          if (pass == 0 && !found[static_cast<std::size_t>(j)]) continue;
          sum += smooth.col(j);
          ++count;
        }
        if (count == 0) continue;
        const bool own = found[static_cast<std::size_t>(i)] || pass > 0;
        next.col(i) = own ? Vector3(0.5 * smooth.col(i) + 0.5 * sum / count) : Vector3(sum / count);
      }
      smooth = next;
    }
    for (Index i = 0; i < n; ++i) {
      skin.col(i) += round == 2 && found[static_cast<std::size_t>(i)] ? step.col(i) : smooth.col(i);
    }
  }
  Places all(3, n + labels.cols());
  all << skin, labels;
  return all;
}

/// The body whose labels are nearest to the mean of all: the standard model of the thesis.
std::size_t medium_of(const std::vector<Example>& examples, const std::vector<std::string>& names) {
  Places mean = examples.front().outline.back_from_couch * labels_in_couch(examples.front(), names);
  for (int round = 0; round < 3; ++round) {
    Places sum = Places::Zero(3, mean.cols());
    for (const Example& e : examples) {
      const Places labels = labels_in_couch(e, names);
      sum += align(labels, mean) * labels / static_cast<double>(examples.size());
    }
    mean = sum;
  }
  std::size_t medium = 0;
  double nearest = 1e300;
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

/// Deformations that are smooth over `length`, of `amplitude` in each axis, as columns: a Gaussian process cut
/// down to the kernel's main functions at evenly spread anchors.
MatrixXd smooth_modes(const Places& mean, double amplitude, double length, Index anchors) {
  std::vector<Index> chosen = {0};
  VectorXd far = (mean.colwise() - mean.col(0)).colwise().norm();
  while (static_cast<Index>(chosen.size()) < std::min(anchors, mean.cols())) {
    Index next = 0;
    far.maxCoeff(&next);
    chosen.push_back(next);
    far = far.cwiseMin((mean.colwise() - mean.col(next)).colwise().norm().transpose());
  }
  const auto count = static_cast<Index>(chosen.size());
  MatrixXd between(mean.cols(), count);
  for (Index j = 0; j < count; ++j) {
    between.col(j) = (mean.colwise() - mean.col(chosen[static_cast<std::size_t>(j)])).colwise().squaredNorm();
  }
  between = (-0.5 / (length * length) * between.array()).exp().matrix() * amplitude * amplitude;
  MatrixXd own(count, count);
  for (Index i = 0; i < count; ++i) own.row(i) = between.row(chosen[static_cast<std::size_t>(i)]);
  const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(own);
  std::vector<Index> kept;
  for (Index k = 0; k < count; ++k) {
    if (eigen.eigenvalues()[k] > 1e-4 * eigen.eigenvalues().maxCoeff()) kept.push_back(k);
  }
  MatrixXd modes = MatrixXd::Zero(3 * mean.cols(), 3 * static_cast<Index>(kept.size()));
  for (std::size_t k = 0; k < kept.size(); ++k) {
    const VectorXd mode =
        between * eigen.eigenvectors().col(kept[k]) / std::sqrt(eigen.eigenvalues()[kept[k]]);
    for (Index axis = 0; axis < 3; ++axis) {
      const auto column = 3 * static_cast<Index>(k) + axis;
      for (Index i = 0; i < mean.cols(); ++i) modes(3 * i + axis, column) = mode[i];
    }
  }
  return modes;
}

/// What a registered back needs besides its shape: where its outline lies.
struct Registered {
  Places shape_in_couch;
  Transform back_from_couch;
};

ShapeModel model_of(const std::vector<const Registered*>& backs, const Template& standard, int persons,
                    const LearnOptions& options) {
  const Index n = standard.skin.cols();
  ShapeModel model;
  model.mean = Places(3, n + standard.labels.cols());
  model.mean << standard.skin, standard.labels;
  std::vector<Places> aligned(backs.size());
  for (int round = 0; round < 4; ++round) {
    Places sum = Places::Zero(3, model.mean.cols());
    for (std::size_t i = 0; i < backs.size(); ++i) {
      aligned[i] = align(backs[i]->shape_in_couch, model.mean) * backs[i]->shape_in_couch;
      sum += aligned[i] / static_cast<double>(backs.size());
    }
    if (options.prior != nullptr) {
      const double counted = options.prior_mean_bodies / (options.prior_mean_bodies + persons);
      sum = counted * options.prior->mean + (1.0 - counted) * (align(sum, options.prior->mean) * sum);
    }
    model.mean = sum;
  }
  Matrix3 turn = Matrix3::Zero();
  Vector3 shift = Vector3::Zero();
  for (const Registered* back : backs) {
    const Transform model_from_outline =
        align(back->shape_in_couch, model.mean) * back->back_from_couch.inverse();
    turn += model_from_outline.linear();
    shift += model_from_outline.translation() / static_cast<double>(backs.size());
  }
  const Eigen::JacobiSVD<Matrix3> svd(turn, Eigen::ComputeFullU | Eigen::ComputeFullV);
  model.model_from_outline.linear() = svd.matrixU() * svd.matrixV().transpose();
  model.model_from_outline.translation() = shift;
  model.normals = align(standard.skin, model.mean.leftCols(n)).linear() * standard.normals;

  const MatrixXd coarse =
      smooth_modes(model.mean, (options.prior != nullptr ? 0.3 : 1.0) * coarse_m / std::sqrt(static_cast<double>(persons)), coarse_length_m, 40);
  const MatrixXd fine = smooth_modes(model.mean, options.smooth_m, fine_length_m, 70);
  const auto seen = static_cast<Index>(backs.size() > 1 ? backs.size() : 0);
  const bool prior = options.prior != nullptr;
  const Index known = prior ? options.prior->modes.cols() : 0;
  const double bodies = persons + (prior ? options.prior_modes_bodies : 0.0);
  MatrixXd factor(3 * model.mean.cols(), seen + coarse.cols() + fine.cols() + known);
  if (prior) factor.rightCols(known) = std::sqrt(options.prior_modes_bodies / bodies) * options.prior->modes;
  for (Index i = 0; i < seen; ++i) {
    const Places offset = aligned[static_cast<std::size_t>(i)] - model.mean;
    factor.col(i) = Eigen::Map<const VectorXd>(offset.data(), offset.size()) *
                    std::sqrt(persons / bodies / static_cast<double>(seen));
  }
  factor.middleCols(seen, coarse.cols()) = coarse;
  factor.middleCols(seen + coarse.cols(), fine.cols()) = fine;
  const MatrixXd gram = factor.transpose() * factor;
  const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(gram);
  const Index kept = std::min<Index>(options.modes, gram.cols());
  model.modes.resize(factor.rows(), kept);
  for (Index k = 0; k < kept; ++k) {
    // An eigenvector's sign is free; its largest entry decides it.
    VectorXd mode = factor * eigen.eigenvectors().col(gram.cols() - 1 - k);
    Index largest = 0;
    mode.cwiseAbs().maxCoeff(&largest);
    model.modes.col(k) = mode[largest] < 0.0 ? VectorXd(-mode) : mode;
  }
  model.bodies = persons;
  return model;
}

Transform start_of(const ShapeModel& model, const Outline& outline) {
  return outline.back_from_couch.inverse() * model.model_from_outline.inverse();
}

/// Ridge regression with the penalty that leaves one out best; an unpenalised constant comes last.
MatrixXd ridge(const MatrixXd& features, const MatrixXd& targets, double penalty, Index views,
 MatrixXd* left_out) {
  const Index rows = features.cols();
  MatrixXd x(features.rows() + 1, rows);
  x << features, VectorXd::Ones(rows).transpose();
  double best = 1e300;
  MatrixXd best_weights;
  std::vector<double> penalties = {3, 10, 30, 100, 300, 1000, 3000};
  if (penalty > 0.0) penalties = {penalty};
  for (const double lambda : penalties) {
    MatrixXd normal = x * x.transpose();
    normal.diagonal().head(features.rows()).array() += lambda;
    const Eigen::LDLT<MatrixXd> solver(normal);
    const MatrixXd weights = solver.solve(x * targets.transpose()).transpose();
    const MatrixXd influence = solver.solve(x);
    MatrixXd residual = targets - weights * x;
    // A person and the mirrored twin leave together; the two share an error.
    for (Index i = 0; i < rows; i += views) {
      const MatrixXd hat = x.middleCols(i, views).transpose() * influence.middleCols(i, views);
      const MatrixXd rest = MatrixXd::Identity(views, views) * 1.02 - hat;
      residual.middleCols(i, views) = residual.middleCols(i, views) * rest.inverse();
    }
    const double loss = residual.squaredNorm();
    if (loss < best) {
      best = loss;
      best_weights = weights;
      if (left_out != nullptr) *left_out = residual;
    }
  }
  return best_weights;
}

double quantile95(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(std::min<double>(static_cast<double>(values.size()) - 1.0,
                                                          std::ceil(0.95 * static_cast<double>(values.size()))))];
}

}  // namespace

Result<Example> make_example(const LabelledBody& body) {
  auto back = fit_back(sample(body.skin_in_couch, 4_mm), {.position = body.position});
  if (!back) return fail(back.error().fault, "{}: {}", body.id, back.error().message);
  return make_example(body, std::move(*back));
}

Result<Example> make_example(const LabelledBody& body, BackSurface seen) {
  const auto outline = find_outline(seen);
  if (!outline) return fail(outline.error().fault, "{}: {}", body.id, outline.error().message);
  return Example{std::move(seen), *outline, body.acupoints, body.landmarks};
}

Example mirrored(const Example& example) {
  const Vector3 flip(-1.0, 1.0, 1.0);
  PointCloud cloud = example.back.points();
  for (Vector3& p : cloud.points) p = p.cwiseProduct(flip);
  for (Vector3& n : cloud.normals) n = n.cwiseProduct(flip);
  Example twin{BackSurface(std::move(cloud), example.back.position(), example.back.spacing_m()), example.outline,
               example.acupoints, example.landmarks};
  for (auto& point : twin.acupoints) {
    point.name = other_side(point.name);
    point.at_in_couch = point.at_in_couch.cwiseProduct(flip);
    point.normal_in_couch = point.normal_in_couch.cwiseProduct(flip);
  }
  for (auto& landmark : twin.landmarks) {
    landmark.name = other_side(landmark.name);
    landmark.at_in_couch = landmark.at_in_couch.cwiseProduct(flip);
  }
  // The outline frame turns with the mirror: flip its x and the world's.
  const Eigen::DiagonalMatrix<double, 3> m(flip);
  twin.outline.back_from_couch.linear() = m * example.outline.back_from_couch.linear() * m;
  twin.outline.back_from_couch.translation() = m * example.outline.back_from_couch.translation();
  const auto swap = [](const Sides& sides) {
    return Sides{Vector2(-sides[right].x(), sides[right].y()), Vector2(-sides[left].x(), sides[left].y())};
  };
  twin.outline.neck = swap(example.outline.neck);
  twin.outline.shoulder = swap(example.outline.shoulder);
  twin.outline.trunk = swap(example.outline.trunk);
  twin.outline.top.x() *= -1.0;
  twin.outline.bottom.x() *= -1.0;
  return twin;
}

Result<ShapeModel> learn_shape(const std::vector<Example>& examples, const LearnOptions& options,
                               const Progress& progress, MatrixXd* out_of_fold_mm) {
  if (examples.empty()) return fail(Fault::bad_input, "no body to learn from");
  // Only labels that every body has: acupoints first, in the order of the first body.
  std::vector<std::string> names;
  int acupoints = 0;
  const auto everywhere = [&](const std::string& name) {
    return std::all_of(examples.begin(), examples.end(), [&](const Example& e) { return labels_of(e).contains(name); });
  };
  if (options.prior != nullptr) {
    names = options.prior->labels;
    acupoints = options.prior->acupoints;
  }
  for (const auto& acupoint : examples.front().acupoints) {
    if (options.prior == nullptr && everywhere(acupoint.name)) names.push_back(acupoint.name);
  }
  acupoints = static_cast<int>(names.size());
  for (const auto& landmark : examples.front().landmarks) {
    if (options.prior == nullptr && everywhere(landmark.name)) names.push_back(landmark.name);
  }

  const Template standard = options.prior != nullptr ? template_of(*options.prior)
 : make_template(examples[medium_of(examples, names)], names);
  const std::size_t views = options.mirror && examples.size() > 1 ? 2 : 1;
  std::vector<Registered> registered;
  for (std::size_t i = 0; i < examples.size(); ++i) {
    registered.push_back({correspond(standard, examples[i], names), examples[i].outline.back_from_couch});
    if (views == 2) {
      const Example twin = mirrored(examples[i]);
      registered.push_back({correspond(standard, twin, names), twin.outline.back_from_couch});
    }
    if (progress) progress(0.4 * static_cast<double>(i + 1) / static_cast<double>(examples.size()));
  }
  const auto finish = [&](ShapeModel model) {
    model.position = examples.front().back.position();
    model.acupoints = acupoints;
    model.labels = names;
    return model;
  };
  const auto learned_from = [&](std::size_t fold, std::size_t folds) {
    std::vector<const Registered*> backs;
    int persons = 0;
    for (std::size_t i = 0; i < registered.size(); ++i) {
      if (folds > 0 && i / views % folds == fold) continue;
      backs.push_back(&registered[i]);
      persons += i % views == 0 ? 1 : 0;
    }
    return finish(model_of(backs, standard, persons, options));
  };
  ShapeModel model = learned_from(0, 0);
  const auto label_count = static_cast<Index>(names.size());
  const Index n = model.skin_points();

  // Every back is fitted by a model that has not seen it; what is then wrong teaches the correction.
  const auto folds = std::min(static_cast<std::size_t>(options.folds), examples.size());
  model.radius95_m = VectorXd::Constant(label_count, 30_mm);
  model.nominal_var_m2 = VectorXd::Constant(label_count, std::pow(10_mm, 2));
  if (examples.size() < 4) {
    const auto own = fit_shape(model, examples.front().back, start_of(model, examples.front().outline),
                               {.sigma_m = options.sigma_m});
    model.nominal_var_m2 = own.label_var_m2;
    // A sphere holds 95 % of a round Gaussian within 2.8 standard deviations.
    model.radius95_m = 2.8 * own.label_var_m2.cwiseSqrt();
    return model;
  }
  MatrixXd features(model.modes.cols(), static_cast<Index>(registered.size()));
  MatrixXd targets(3 * label_count, features.cols());
  model.nominal_var_m2.setZero();
  for (std::size_t fold = 0; fold < folds; ++fold) {
    const ShapeModel others = learned_from(fold, folds);
    for (std::size_t i = 0; i < registered.size(); ++i) {
      if (i / views % folds != fold) continue;
      const Example* example = &examples[i / views];
      std::optional<Example> twin;
      if (i % views == 1) {
        twin.emplace(mirrored(*example));
        example = &*twin;
      }
      const ShapeFit fit =
          fit_shape(others, example->back, start_of(others, example->outline), {.sigma_m = options.sigma_m});
      const Transform model_from_couch = align(fit.skin_in_couch, model.mean.leftCols(n));
      features.col(static_cast<Index>(i)) = skin_features(model, model_from_couch * fit.skin_in_couch);
      const Places off = model_from_couch.linear() * (labels_in_couch(*example, names) - fit.labels_in_couch);
      targets.col(static_cast<Index>(i)) = 1e3 * Eigen::Map<const VectorXd>(off.data(), off.size());
      model.nominal_var_m2 += fit.label_var_m2 / static_cast<double>(registered.size());
    }
    if (progress) progress(0.4 + 0.6 * static_cast<double>(fold + 1) / static_cast<double>(folds));
  }
  MatrixXd left_out;
  model.correction = ridge(features, targets, options.ridge, static_cast<Index>(views), &left_out);
  for (Index l = 0; l < label_count; ++l) {
    std::vector<double> errors;
    for (Index i = 0; i < left_out.cols(); ++i) errors.push_back(1e-3 * left_out.block<3, 1>(3 * l, i).norm());
    model.radius95_m[l] = quantile95(errors);
  }
  if (out_of_fold_mm != nullptr) {
    out_of_fold_mm->resize(acupoints, left_out.cols());
    for (Index i = 0; i < left_out.cols(); ++i) {
      for (Index l = 0; l < acupoints; ++l) (*out_of_fold_mm)(l, i) = left_out.block<3, 1>(3 * l, i).norm();
    }
  }
  return model;
}

std::size_t medium_example(const std::vector<Example>& examples, const ShapeModel& model) {
  std::vector<std::string> names;
  for (const auto& name : model.labels) {
    if (std::all_of(examples.begin(), examples.end(), [&](const Example& e) { return labels_of(e).contains(name); })) {
      names.push_back(name);
    }
  }
  return medium_of(examples, names);
}

LabelEstimate estimate_labels(const ShapeModel& model, const BackSurface& back, const Outline& outline,
                              double sigma_m) {
  LabelEstimate estimate;
  estimate.fit = fit_shape(model, back, start_of(model, outline), {.sigma_m = sigma_m});
  estimate.at_in_couch = estimate.fit.labels_in_couch;
  if (model.correction.size() > 0) {
    const Transform model_from_couch = align(estimate.fit.skin_in_couch, model.mean.leftCols(model.skin_points()));
    const VectorXd features = skin_features(model, model_from_couch * estimate.fit.skin_in_couch);
    const VectorXd off = 1e-3 * (model.correction.leftCols(features.size()) * features + model.correction.rightCols<1>());
    estimate.at_in_couch += model_from_couch.linear().transpose() * Eigen::Map<const Places>(off.data(), 3, off.size() / 3);
  }
  estimate.radius95_m = model.radius95_m.array() *
                        (estimate.fit.label_var_m2.array() / model.nominal_var_m2.array()).sqrt().max(1.0);
  return estimate;
}

}  // namespace tuina::body
