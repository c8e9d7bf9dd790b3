// SPDX-License-Identifier: Apache-2.0
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <numeric>
#include <string>

#include "apps/simulated/labelled_phantom.hpp"
#include "tests/reason.hpp"
#include "tuina/body/atlas.hpp"
#include "tuina/body/correction.hpp"
#include "tuina/body/learn/shape_statistics.hpp"
#include "tuina/core/random.hpp"
#include "tuina/core/units.hpp"

namespace tuina::body {
namespace {

using Eigen::Index;

/// A curved sheet of 200 points, and two labels on it.
Template sheet() {
  Template made;
  made.skin.resize(3, 200);
  for (Index i = 0; i < 200; ++i) {
    const double x = 30_mm * static_cast<double>(i % 10), z = 30_mm * static_cast<double>(i / 10);
    made.skin.col(i) << x - 135_mm, 0.3 * x * (270_mm - x) + 0.1 * z * z, z;
  }
  made.normals = Vector3::UnitY().replicate(1, 200);
  made.labels = made.skin.leftCols(2);
  return made;
}

/// The sheet bent in five ways, with unevenness of its own, somewhere on the couch.
Registered drawn(std::size_t number) {
  Random random = make_random(number, "a bent sheet");
  const Template flat = sheet();
  Places shape(3, 202);
  shape << flat.skin, flat.labels;
  for (int wave = 1; wave <= 5; ++wave) {
    const double high_m = gaussian(random, 12_mm / wave);
    for (Index i = 0; i < shape.cols(); ++i)
      shape(1, i) += high_m * std::sin(5.0 * wave * shape(2, i) + 3.0 * wave * shape(0, i));
  }
  for (double& value : shape.reshaped()) value += gaussian(random, 1_mm);
  const Eigen::AngleAxisd turn(gaussian(random, 0.2), Vector3::UnitZ());
  shape = (turn.toRotationMatrix() * shape).eval();
  return {shape, Transform(turn)};
}

/// Sheets with these numbers, one after another.
Backs drawn_backs(std::vector<std::size_t> numbers) {
  const std::size_t count = numbers.size();
  return {count, [numbers = std::move(numbers)](const auto& each) -> Result<void> {
            for (const std::size_t number : numbers) each(drawn(number));
            return {};
          }};
}

std::vector<std::size_t> first(std::size_t count) {
  std::vector<std::size_t> numbers(count);
  std::iota(numbers.begin(), numbers.end(), std::size_t{0});
  return numbers;
}

ShapeModel model(const Backs& backs, Index max_products) {
  auto made = model_of(backs, sheet(), static_cast<int>(backs.count),
                       {.modes = 20, .max_products = max_products});
  REQUIRE(made.has_value());
  return std::move(*made);
}

/// The largest difference of means, and of what the modes say, in parts of the largest value.
double difference(const ShapeModel& a, const ShapeModel& b) {
  const Eigen::MatrixXd spread = a.modes * a.modes.transpose();
  const Eigen::MatrixXd other = b.modes * b.modes.transpose();
  return std::max((a.mean - b.mean).cwiseAbs().maxCoeff() / a.mean.cwiseAbs().maxCoeff(),
                  (spread - other).cwiseAbs().maxCoeff() / spread.cwiseAbs().maxCoeff());
}

/// The most memory that work takes at once, in kilobytes.
template <typename Work>
long peak_kb(const Work& work) {
  std::ofstream("/proc/self/clear_refs") << 5;  // the peak begins anew
  work();
  std::ifstream status("/proc/self/status");
  std::string word;
  while (status >> word && word != "VmHWM:") {
  }
  long peak = 0;
  status >> peak;
  return peak;
}

}  // namespace

TEST_CASE("the sum over many backs has the modes that the products of few have") {
  const Backs backs = drawn_backs(first(60));
  const ShapeModel by_products = model(backs, 1000), by_sum = model(backs, 0);
  CHECK(difference(by_products, by_sum) < 1e-9);
  CHECK((by_products.modes - by_sum.modes).cwiseAbs().maxCoeff() < 1e-9);
}

TEST_CASE("a model does not depend on the order of people, nor on how they are split into parts") {
  const ShapeModel usual = model(drawn_backs(first(120)), 0);
  auto numbers = first(120);
  std::reverse(numbers.begin(), numbers.end());
  CHECK(difference(model(drawn_backs(numbers), 0), usual) < 1e-9);
  // Seven parts, of which the last is visited first.
  std::stable_sort(numbers.begin(), numbers.end(),
                   [](std::size_t a, std::size_t b) { return a % 7 > b % 7; });
  CHECK(difference(model(drawn_backs(numbers), 0), usual) < 1e-9);
  CHECK(difference(model(drawn_backs(first(119)), 0), usual) > 1e-6);
}

TEST_CASE("a back that was found head to feet spoils no correction, and is no small error") {
  constexpr Eigen::Index people = 40, views = 2, labels = 3;
  const auto drawn_fits = [](Eigen::Index others) {
    Random random = make_random(5, "left out");
    const Eigen::Index columns = views * (people + others);
    LeftOut fits{.features = Eigen::MatrixXd(2, columns),
                 .targets_mm = Eigen::MatrixXd(3 * labels, columns),
                 .variance_m2 = Eigen::MatrixXd::Constant(labels, columns, 1e-6),
                 .residual_m = Eigen::VectorXd::Constant(columns, 1e-3),
                 .outlier_score = Eigen::VectorXd::Ones(columns),
                 .views = views};
    for (Eigen::Index i = 0; i < columns; ++i) {
      for (double& feature : fits.features.col(i)) feature = gaussian(random, 1.0);
      for (double& off_mm : fits.targets_mm.col(i)) off_mm = gaussian(random, 1.0);
      fits.targets_mm.col(i).array() += 4.0 * fits.features(0, i);
    }
    return fits;
  };
  const auto learned = [](const LeftOut& fits, Eigen::MatrixXd& wrong_mm) {
    ShapeModel model;
    model.radius95_m = Eigen::VectorXd::Zero(labels);
    wrong_mm = learn_correction(fits, model);
    return model;
  };
  Eigen::MatrixXd right_mm, wrong_mm;
  const ShapeModel usual = learned(drawn_fits(0), right_mm);
  CHECK(usual.correction(0, 0) == doctest::Approx(4.0).epsilon(0.1));
  LeftOut fits = drawn_fits(1);
  const Eigen::Index elsewhere = views * people;  // one of its views, which is enough
  fits.targets_mm.col(elsewhere).array() += 200.0;
  fits.outlier_score[elsewhere] = fits.outlier_score[elsewhere + 1] = 9.0;
  fits.residual_m[elsewhere] = 9e-3;
  const ShapeModel spared = learned(fits, wrong_mm);
  CHECK((spared.correction - usual.correction).norm() < 1e-9);
  CHECK(spared.max_outlier_score == 1.0);
  CHECK((wrong_mm.leftCols(elsewhere) - right_mm).norm() < 1e-9);
  CHECK(wrong_mm.col(elsewhere) == fits.targets_mm.col(elsewhere));
  // As one of forty it hardly widens a radius of 95 %, as every tenth it does.
  CHECK((spared.radius95_m.array() < 1.3 * usual.radius95_m.array()).all());
  LeftOut many = drawn_fits(4);
  for (Eigen::Index i = 0; i < 4; ++i) many.targets_mm.col(elsewhere + views * i).array() += 200.0;
  const ShapeModel warned = learned(many, wrong_mm);
  CHECK((warned.radius95_m.array() > 0.1).all());
}

TEST_CASE("labels that nobody has shown keep their radii, and what the prior says of them") {
  const auto prior = read_atlas(TUINA_SOURCE_DIR "/models/atlas.tuina");
  REQUIRE(prior.has_value());
  const ShapeModel& known = prior->of(BodyPosture::sitting)->shape;
  std::vector<LabelledBody> people;
  for (std::uint64_t seed = 1; seed <= 16; ++seed) {
    people.push_back(app::labelled(sim::make_phantom(sim::draw_phantom(seed), known.position)));
    people.back().id = std::to_string(seed);
    people.back().acupoints.resize(seven_acupoints.size());
    people.back().landmarks.clear();
  }
  const auto learned = [&] {
    auto atlas = learn_atlas(people, &*prior, {}, nullptr);
    REQUIRE_MESSAGE(atlas.has_value(), test::reason(atlas));
    return std::move(atlas->positions.front().shape);
  };
  const auto shown = [](const std::string& name) {
    return std::ranges::find(seven_acupoints, name) != seven_acupoints.end();
  };
  const ShapeModel of_many = learned();
  REQUIRE(of_many.labels == known.labels);
  CHECK((of_many.radius95_m.head<7>().array() < known.radius95_m.head<7>().array()).any());
  people.resize(6);
  const ShapeModel of_few = learned();
  // Stated radii are divided by these, and do not shrink where they stay.
  CHECK(of_few.nominal_var_m2 == known.nominal_var_m2);
  CHECK(of_few.usual_residual_m == known.usual_residual_m);
  for (Index l = 0; l < known.radius95_m.size(); ++l) {
    const std::string& name = known.labels[static_cast<std::size_t>(l)];
    CAPTURE(name);
    CHECK(of_few.radius95_m[l] >= known.radius95_m[l]);
    if (shown(name)) continue;
    CHECK(of_many.radius95_m[l] >= known.radius95_m[l]);
    const Eigen::MatrixXd moved = of_few.correction - known.correction;
    CHECK(moved.middleRows<3>(3 * l).norm() < 1e-9);
  }
}

TEST_CASE("backs come out of their file as they went in") {
  auto kept = RegisteredBacks::make(202);
  REQUIRE(kept.has_value());
  for (const std::size_t number : first(5)) REQUIRE(kept->add(drawn(number)).has_value());
  std::size_t next = 1;
  const Backs odd = kept->chosen([](std::size_t number) { return number % 2 == 1; });
  REQUIRE(odd.count == 2);
  REQUIRE(odd.visit([&](const Registered& back) {
               CHECK(back.shape_in_couch == drawn(next).shape_in_couch);
               CHECK(back.couch_from_person.isApprox(drawn(next).couch_from_person, 0.0));
               next += 2;
             })
              .has_value());
  CHECK(next == 5);
}

TEST_CASE("an atlas is no surer of a label than another that has it in the same position") {
  const auto one = [](BodyPosture position, std::vector<std::string> labels,
                      const Eigen::VectorXd& radii_m) {
    PositionAtlas made;
    made.shape.position = position;
    made.shape.labels = std::move(labels);
    made.shape.radius95_m = radii_m;
    return made;
  };
  const Atlas other{
      .positions = {one(BodyPosture::prone, {"GV4", "GV14"}, Eigen::Vector2d(12_mm, 20_mm))}};
  Atlas atlas{.positions = {one(BodyPosture::sitting, {"GV14"}, Eigen::VectorXd::Constant(1, 5_mm)),
                            one(BodyPosture::prone, {"GV14", "BL13_L", "GV4"},
                                Eigen::Vector3d(5_mm, 6_mm, 15_mm))}};
  keep_radii_above(other, atlas);
  CHECK(atlas.positions[0].shape.radius95_m[0] == 5_mm);
  CHECK(atlas.positions[1].shape.radius95_m == Eigen::Vector3d(20_mm, 6_mm, 15_mm));
}

TEST_CASE("ten times as many backs need no more memory") {
  // Held in memory, each would take 5 kB.
  const long of_some_kb = peak_kb([] { (void)model(drawn_backs(first(300)), 0); });
  const long of_many_kb = peak_kb([] { (void)model(drawn_backs(first(3000)), 0); });
  REQUIRE(of_some_kb > 1000);
  CHECK(of_many_kb - of_some_kb < 2000);
}

}  // namespace tuina::body
