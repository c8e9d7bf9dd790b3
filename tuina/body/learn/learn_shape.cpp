// SPDX-License-Identifier: Apache-2.0
#include "tuina/body/learn/learn_shape.hpp"

#include <algorithm>
#include <cmath>

#include "tuina/body/correction.hpp"
#include "tuina/core/parallel.hpp"
#include "tuina/core/units.hpp"

namespace tuina::body {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr std::size_t enough_to_correct = 4;  // bodies
constexpr std::size_t enough_to_learn = 16;   // fewer bodies overfit mean and modes

/// Names of the learned labels: those of the prior, else those that every body has; acupoints
/// first.
struct Names {
  std::vector<std::string> all;
  int acupoints = 0;
};

Names names_of(const Examples& examples, const ShapeModel* prior) {
  if (prior != nullptr) return {prior->labels, prior->acupoints};
  Names names{examples.acupoints, static_cast<int>(examples.acupoints.size())};
  names.all.insert(names.all.end(), examples.landmarks.begin(), examples.landmarks.end());
  return names;
}

/// Training examples; with two views, each is followed by its reflection.
struct People {
  const Examples& examples;
  Names names;
  std::size_t views = 1;

  /// An example as learning looks at it: reflected, for the second view.
  [[nodiscard]] Result<std::vector<Example>> views_of(std::size_t i,
                                                      BodySource::Needs needs) const {
    auto example = examples.make(i, needs);
    if (!example) return tl::unexpected(example.error());
    std::vector<Example> seen;
    seen.push_back(std::move(*example));
    if (views == 2) seen.push_back(mirrored(seen.front()));
    return seen;
  }
};

/// All examples registered to the template.
struct Register {
  const People& people;
  Template standard;
  RegisteredBacks backs;

  /// The model of all examples, or of all but one fold.
  [[nodiscard]] Result<ShapeModel> model(const LearnOptions& options, std::size_t fold = 0,
                                         std::size_t folds = 0) {
    const auto wanted = [=, views = people.views](std::size_t i) {
      return folds == 0 || i / views % folds != fold;
    };
    const Backs chosen = backs.chosen(wanted);
    auto made = model_of(chosen, standard, static_cast<int>(chosen.count / people.views),
                         options.statistics);
    if (!made) return made;
    made->position = people.examples.position;
    made->acupoints = people.names.acupoints;
    made->labels = people.names.all;
    return made;
  }
};

/// All examples registered to the mean of the prior, or to the medium one of them.
Result<Register> register_all(const People& people, const LearnOptions& options,
                              const Progress& progress) {
  const ShapeModel* prior = options.statistics.prior;
  Template standard;
  if (prior != nullptr) {
    standard = template_of(*prior);
  } else {
    const auto medium =
        people.examples.make(medium_of(people.examples, people.names.all), BodySource::Needs::skin);
    if (!medium) return tl::unexpected(medium.error());
    standard = make_template(*medium, people.names.all, options.reach);
  }
  auto backs = RegisteredBacks::make(standard.skin.cols() + standard.labels.cols());
  if (!backs) return tl::unexpected(backs.error());
  const auto make = [&](std::size_t i) -> Result<std::vector<Registered>> {
    const auto views = people.views_of(i, BodySource::Needs::skin);
    if (!views) return tl::unexpected(views.error());
    std::vector<Registered> made;
    for (const Example& view : *views) made.push_back(registered(standard, view, people.names.all));
    return made;
  };
  const auto keep = [&](std::size_t i, const Result<std::vector<Registered>>& made) {
    if (!made) return Result<void>(tl::unexpected(made.error()));
    for (const Registered& back : *made) {
      if (auto added = backs->add(back); !added) return added;
    }
    if (progress)
      progress(static_cast<double>(i + 1) / static_cast<double>(people.examples.size()));
    return Result<void>();
  };
  if (const auto all = for_each_in_order(people.examples.size(), make, keep); !all)
    return tl::unexpected(all.error());
  return Register{people, std::move(standard), std::move(*backs)};
}

/// Labels of an example; missing ones are taken from `otherwise`.
Places labels_or(const Example& example, const std::vector<std::string>& names,
                 const Places& otherwise) {
  const auto known = labels_of(example);
  Places places = otherwise;
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (const auto own = known.find(names[i]); own != known.end()) {
      places.col(static_cast<Index>(i)) = own->second;
    }
  }
  return places;
}

/// Fits every back with a model of the other folds.
template <typename OthersOf>
Result<LeftOut> leave_out(const People& people, const ShapeModel& model, std::size_t folds,
                          const OthersOf& others_of, const Progress& progress) {
  const auto columns = static_cast<Index>(people.views * people.examples.size());
  const auto labels = static_cast<Index>(people.names.all.size());
  LeftOut left{.features = MatrixXd(model.modes.cols(), columns),
               .targets_mm = MatrixXd(3 * labels, columns),
               .variance_m2 = MatrixXd(labels, columns),
               .residual_m = VectorXd(columns),
               .outlier_score = VectorXd(columns),
               .views = static_cast<Index>(people.views)};
  for (const std::string& name : people.names.all) left.shown.push_back(people.examples.have(name));
  for (std::size_t fold = 0; fold < folds; ++fold) {
    const Result<ShapeModel> others = others_of(fold);
    if (!others) return tl::unexpected(others.error());
    const auto fit_one = [&](std::size_t k) -> Result<void> {
      const std::size_t i = fold + k * folds;
      const auto views = people.views_of(i, BodySource::Needs::scan);
      if (!views) return tl::unexpected(views.error());
      auto column = static_cast<Index>(i * people.views);
      for (const Example& view : *views) {
        const ShapeFit fit = fit_shape(*others, view.back);
        const Transform model_from_couch =
            align(fit.skin_in_couch, model.mean.leftCols(model.skin_points()));
        left.features.col(column) = skin_features(model, model_from_couch * fit.skin_in_couch);
        const Places off =
            1e3 * (model_from_couch.linear() *
                   (labels_or(view, people.names.all, fit.labels_in_couch) - fit.labels_in_couch));
        left.targets_mm.col(column) = Eigen::Map<const VectorXd>(off.data(), off.size());
        left.variance_m2.col(column) = fit.label_var_m2;
        left.residual_m[column] = fit.residual_m;
        left.outlier_score[column] = fit.outlier_score();
        ++column;
      }
      return {};
    };
    const std::size_t among = (people.examples.size() - fold + folds - 1) / folds;
    const auto note = [&](std::size_t k, const Result<void>& fitted) {
      if (progress) {
        progress(
            (static_cast<double>(fold) + static_cast<double>(k + 1) / static_cast<double>(among)) /
            static_cast<double>(folds));
      }
      return fitted;
    };
    if (const auto all = for_each_in_order(among, fit_one, note); !all)
      return tl::unexpected(all.error());
  }
  return left;
}

/// A model, and the cross-validated error of each acupoint (row) of each back (column); empty with
/// too few bodies.
struct Learned {
  ShapeModel model;
  MatrixXd out_of_fold_mm;
};

MatrixXd acupoint_errors(const MatrixXd& wrong_mm, int acupoints) {
  MatrixXd errors_mm(acupoints, wrong_mm.cols());
  for (Index i = 0; i < wrong_mm.cols(); ++i) {
    for (Index l = 0; l < acupoints; ++l) errors_mm(l, i) = wrong_mm.block<3, 1>(3 * l, i).norm();
  }
  return errors_mm;
}

/// Mean and modes of these people, with the prior in the statistics.
Result<Learned> learned_shape(const People& people, const LearnOptions& options,
                              const Progress& progress) {
  const auto& examples = people.examples;
  const auto& names = people.names;
  const ShapeModel* prior = options.statistics.prior;
  auto all = register_all(people, options, [&](double done) {
    if (progress) progress(0.4 * done);
  });
  if (!all) return tl::unexpected(all.error());
  auto made = all->model(options);
  if (!made) return tl::unexpected(made.error());
  Learned learned{.model = std::move(*made), .out_of_fold_mm = {}};
  ShapeModel& model = learned.model;
  if (prior != nullptr) {
    model.bodies += prior->bodies;
    if (prior->correction.size() > 0) model.correction = correction_carried(*prior, model);
  }
  if (examples.size() < enough_to_correct) {
    const auto first = examples.make(0, BodySource::Needs::scan);
    if (!first) return tl::unexpected(first.error());
    const ShapeFit own = fit_shape(model, first->back);
    model.nominal_var_m2 = own.label_var_m2;
    model.usual_residual_m = own.residual_m;
    // 95 % of an isotropic 3D Gaussian lies within 2.8 standard deviations.
    model.radius95_m = 2.8 * own.label_var_m2.cwiseSqrt();
    return learned;
  }
  model.radius95_m = VectorXd::Zero(static_cast<Index>(names.all.size()));
  const auto folds = std::min(static_cast<std::size_t>(options.folds), examples.size());
  const auto left = leave_out(
      people, model, folds, [&](std::size_t fold) { return all->model(options, fold, folds); },
      [&](double done) {
        if (progress) progress(0.4 + 0.6 * done);
      });
  if (!left) return tl::unexpected(left.error());
  learned.out_of_fold_mm = acupoint_errors(learn_correction(*left, model), names.acupoints);
  if (prior != nullptr) carry_radii(*prior, *left, model);
  return learned;
}

/// The prior's shape with a correction learned from these people: the mean and modes of a few
/// people describe their selection more than others.
Result<Learned> corrected_prior(const People& people, const ShapeModel& prior,
                                const Progress& progress) {
  const auto left = leave_out(
      people, prior, 1, [&](std::size_t) { return Result<ShapeModel>(prior); }, progress);
  if (!left) return tl::unexpected(left.error());
  Learned learned{.model = prior, .out_of_fold_mm = {}};
  ShapeModel& model = learned.model;
  const MatrixXd wrong_mm = learn_correction(*left, model);
  model.bodies += static_cast<int>(people.examples.size());
  if (people.examples.size() >= enough_to_correct) {
    learned.out_of_fold_mm = acupoint_errors(wrong_mm, people.names.acupoints);
    // A few easy people are no evidence against the prior's radii.
    model.radius95_m = model.radius95_m.cwiseMax(prior.radius95_m);
  } else {
    model.radius95_m = prior.radius95_m;
    model.max_outlier_score = prior.max_outlier_score;
  }
  return learned;
}

}  // namespace

Result<ShapeModel> learn_shape(const Examples& examples, const LearnOptions& options,
                               const Progress& progress, MatrixXd* out_of_fold_mm) {
  if (examples.size() == 0) return fail(Fault::bad_input, "no body to learn from");
  const ShapeModel* prior = options.prior;
  const std::size_t views = options.mirror && (examples.size() > 1 || prior != nullptr) ? 2U : 1U;
  const People people{.examples = examples, .names = names_of(examples, nullptr), .views = views};
  const People known{.examples = examples, .names = names_of(examples, prior), .views = views};
  Result<Learned> learned;
  if (prior != nullptr && examples.size() < enough_to_learn) {
    learned = corrected_prior(known, *prior, progress);
  } else if (prior != nullptr) {
    // With enough people both variants are tried; the one with the smaller cross-validated error is
    // kept.
    const bool alone = people.names.all.size() >= known.names.all.size();
    LearnOptions with_prior = options;
    with_prior.statistics.prior = prior;
    learned = learned_shape(known, with_prior, [&](double done) {
      if (progress) progress(alone ? 0.5 * done : done);
    });
    if (learned && alone) {
      auto own = learned_shape(people, options, [&](double done) {
        if (progress) progress(0.5 + 0.5 * done);
      });
      if (!own || own->out_of_fold_mm.mean() < learned->out_of_fold_mm.mean())
        learned = std::move(own);
    }
  } else {
    learned = learned_shape(people, options, progress);
  }
  if (!learned) return tl::unexpected(learned.error());
  if (out_of_fold_mm != nullptr && learned->out_of_fold_mm.size() > 0) {
    *out_of_fold_mm = std::move(learned->out_of_fold_mm);
  }
  return std::move(learned->model);
}

}  // namespace tuina::body
