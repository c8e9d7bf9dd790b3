// SPDX-License-Identifier: Apache-2.0
#include "tuina/body/learn_shape.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "tuina/body/correction.hpp"
#include "tuina/core/units.hpp"

namespace tuina::body {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr std::size_t enough_to_correct = 4;  // bodies

/// What is learned: the labels of the prior, else those that every body has, acupoints first.
struct Names {
  std::vector<std::string> all;
  int acupoints = 0;
};

Names names_of(const std::vector<Example>& examples, const ShapeModel* prior) {
  if (prior != nullptr) return {prior->labels, prior->acupoints};
  const auto everywhere = [&](const std::string& name) {
    return std::all_of(examples.begin(), examples.end(),
                       [&](const Example& e) { return labels_of(e).contains(name); });
  };
  Names names;
  for (const auto& acupoint : examples.front().acupoints) {
    if (everywhere(acupoint.name)) names.all.push_back(acupoint.name);
  }
  names.acupoints = static_cast<int>(names.all.size());
  for (const auto& landmark : examples.front().landmarks) {
    if (everywhere(landmark.name)) names.all.push_back(landmark.name);
  }
  return names;
}

/// Everybody registered, each followed by the mirrored twin when there are two views.
struct Register {
  const std::vector<Example>& examples;
  const Names& names;
  Template standard;
  std::size_t views;
  std::vector<Registered> backs;

  /// The model of everybody, or of everybody but one fold.
  [[nodiscard]] ShapeModel model(const LearnOptions& options, std::size_t fold = 0,
                                 std::size_t folds = 0) const {
    std::vector<const Registered*> chosen;
    int persons = 0;
    for (std::size_t i = 0; i < backs.size(); ++i) {
      if (folds > 0 && i / views % folds == fold) continue;
      chosen.push_back(&backs[i]);
      persons += i % views == 0 ? 1 : 0;
    }
    ShapeModel made = model_of(chosen, standard, persons, options.statistics);
    made.position = examples.front().back.position();
    made.acupoints = names.acupoints;
    made.labels = names.all;
    return made;
  }
};

/// Which labels an example has; what is not there teaches nothing.
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

/// Every back fitted by a model that has not seen it.
LeftOut leave_out(const Register& all, const ShapeModel& model, const LearnOptions& options,
                  const Progress& progress) {
  const auto columns = static_cast<Index>(all.backs.size());
  const auto labels = static_cast<Index>(all.names.all.size());
  LeftOut left{.features = MatrixXd(model.modes.cols(), columns),
               .targets_mm = MatrixXd(3 * labels, columns),
               .variance_m2 = MatrixXd(labels, columns),
               .residual_m = VectorXd(columns),
               .views = static_cast<Index>(all.views)};
  const auto folds = std::min(static_cast<std::size_t>(options.folds), all.examples.size());
  for (std::size_t fold = 0; fold < folds; ++fold) {
    const ShapeModel others = all.model(options, fold, folds);
    for (std::size_t i = 0; i < all.backs.size(); ++i) {
      if (i / all.views % folds != fold) continue;
      const Example* example = &all.examples[i / all.views];
      std::optional<Example> twin;
      if (i % all.views == 1) {
        twin.emplace(mirrored(*example));
        example = &*twin;
      }
      const auto column = static_cast<Index>(i);
      const ShapeFit fit = fit_shape(others, example->back);
      const Transform model_from_couch =
          align(fit.skin_in_couch, model.mean.leftCols(model.skin_points()));
      left.features.col(column) = skin_features(model, model_from_couch * fit.skin_in_couch);
      const Places off =
          1e3 * (model_from_couch.linear() *
                 (labels_or(*example, all.names.all, fit.labels_in_couch) - fit.labels_in_couch));
      left.targets_mm.col(column) = Eigen::Map<const VectorXd>(off.data(), off.size());
      left.variance_m2.col(column) = fit.label_var_m2;
      left.residual_m[column] = fit.residual_m;
    }
    if (progress) progress(static_cast<double>(fold + 1) / static_cast<double>(folds));
  }
  return left;
}

}  // namespace

Result<ShapeModel> learn_shape(const std::vector<Example>& examples, const LearnOptions& options,
                               const Progress& progress, MatrixXd* out_of_fold_mm) {
  if (examples.empty()) return fail(Fault::bad_input, "no body to learn from");
  const ShapeModel* prior = options.statistics.prior;
  const Names names = names_of(examples, prior);
  Register all{.examples = examples,
               .names = names,
               .standard = prior != nullptr
                               ? template_of(*prior)
                               : make_template(examples[medium_of(examples, names.all)], names.all),
               .views = options.mirror && examples.size() > 1 ? 2U : 1U,
               .backs = {}};
  for (const Example& example : examples) {
    all.backs.push_back(registered(all.standard, example, names.all));
    if (all.views == 2) all.backs.push_back(registered(all.standard, mirrored(example), names.all));
    if (progress) {
      progress(0.4 * static_cast<double>(all.backs.size()) /
               static_cast<double>(all.views * examples.size()));
    }
  }
  ShapeModel model = all.model(options);
  const auto label_count = static_cast<Index>(names.all.size());
  if (examples.size() < enough_to_correct) {
    const ShapeFit own = fit_shape(model, examples.front().back);
    model.nominal_var_m2 = own.label_var_m2;
    model.usual_residual_m = own.residual_m;
    // A sphere holds 95 % of a round Gaussian within 2.8 standard deviations.
    model.radius95_m = 2.8 * own.label_var_m2.cwiseSqrt();
    return model;
  }
  model.radius95_m = VectorXd::Zero(label_count);
  const LeftOut left = leave_out(all, model, options, [&](double done) {
    if (progress) progress(0.4 + 0.6 * done);
  });
  const MatrixXd wrong_mm = learn_correction(left, model);
  if (out_of_fold_mm != nullptr) {
    out_of_fold_mm->resize(names.acupoints, wrong_mm.cols());
    for (Index i = 0; i < wrong_mm.cols(); ++i) {
      for (Index l = 0; l < names.acupoints; ++l) {
        (*out_of_fold_mm)(l, i) = wrong_mm.block<3, 1>(3 * l, i).norm();
      }
    }
  }
  return model;
}

}  // namespace tuina::body
