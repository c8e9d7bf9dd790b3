// SPDX-License-Identifier: Apache-2.0
#include "tuina/body/learn/correspondence.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "tuina/body/voxels.hpp"
#include "tuina/core/units.hpp"

namespace tuina::body {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double skin_spacing_m = 13_mm;
constexpr double skin_reach_m = 65_mm;  // the model's skin ends this far beyond its labels

/// Smooth map that carries labels onto labels: affine plus |r| splines, the 3D analogue of thin
/// plates.
class Spline {
 public:
  Spline(const Places& from, const Places& to) : from_(from) {
    const Index n = from.cols();
    const bool affine = n >= 7;
    affine_ = affine ? 4 : 1;
    MatrixXd system = MatrixXd::Zero(n + affine_, n + affine_);
    for (Index i = 0; i < n; ++i) {
      for (Index j = 0; j < n; ++j) system(i, j) = -(from.col(i) - from.col(j)).norm();
      system(i, i) +=
          2_mm;  // regularisation: labels a few millimetres apart must not tear the skin
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

void find_neighbours(Template& made) {
  constexpr Index count = 8;
  for (Index i = 0; i < made.skin.cols(); ++i) {
    const VectorXd far = (made.skin.colwise() - made.skin.col(i)).colwise().squaredNorm();
    std::vector<Index> order(static_cast<std::size_t>(far.size()));
    for (std::size_t k = 0; k < order.size(); ++k) order[k] = static_cast<Index>(k);
    std::partial_sort(order.begin(), order.begin() + count + 1, order.end(),
                      [&](Index a, Index b) { return far[a] != far[b] ? far[a] < far[b] : a < b; });
    made.neighbours.emplace_back(order.begin() + 1, order.begin() + count + 1);
  }
}

/// Rotation from couch to axes like those of `back`.
Matrix3 back_axes(BodyPosture position) {
  return position == BodyPosture::sitting
             ? Matrix3(Matrix3::Identity())
             : Eigen::AngleAxisd(-pi / 2.0, Vector3::UnitX()).toRotationMatrix();
}

}  // namespace

Template make_template(const Example& example, const std::vector<std::string>& names, Reach reach) {
  Transform back_from_couch = Transform::Identity();
  back_from_couch.linear() = back_axes(example.back.position());
  const Transform couch_from_back = back_from_couch.inverse();
  Template made;
  made.labels = back_from_couch * labels_in_couch(example, names);
  std::vector<Vector3> near;
  const double reach_m = names.size() < 20 ? 2.0 * skin_reach_m : skin_reach_m;
  Places marks = made.labels;
  if (reach == Reach::acupoints) {
    marks.resize(3, static_cast<Index>(example.acupoints.size()));
    for (Index i = 0; i < marks.cols(); ++i) {
      marks.col(i) = back_from_couch * example.acupoints[static_cast<std::size_t>(i)].at_in_couch;
    }
  }
  for (const Vector3& p : example.back.points().points) {
    const Vector3 q = back_from_couch * p;
    if ((marks.colwise() - q).colwise().norm().minCoeff() < reach_m) near.push_back(q);
  }
  const Voxels thinned = gather(near, skin_spacing_m);
  made.skin.resize(3, static_cast<Index>(thinned.size()));
  made.normals.resize(3, made.skin.cols());
  for (Index i = 0; i < made.skin.cols(); ++i) {
    const auto found =
        example.back.nearest(couch_from_back * thinned.mean[static_cast<std::size_t>(i)]);
    made.skin.col(i) = back_from_couch * found.at_in_couch;
    made.normals.col(i) = back_from_couch.linear() * found.normal_in_couch;
  }
  find_neighbours(made);
  return made;
}

Template template_of(const ShapeModel& model) {
  const Index n = model.skin_points();
  Template made{.skin = model.mean.leftCols(n),
                .normals = model.normals,
                .labels = model.mean.rightCols(model.mean.cols() - n),
                .neighbours = {}};
  find_neighbours(made);
  return made;
}

Places correspond(const Template& standard, const Example& example,
                  const std::vector<std::string>& names) {
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
      if (std::abs(along) > 40_mm ||
          (off - along * at.normal_in_couch).norm() > 8_mm + 0.5 * std::abs(along))
        continue;
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

}  // namespace tuina::body
