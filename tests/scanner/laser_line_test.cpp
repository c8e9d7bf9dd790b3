// SPDX-License-Identifier: Apache-2.0
#include "tuina/scanner/line/laser_line.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "tests/scanner/lit_scene.hpp"
#include "tuina/core/random.hpp"
#include "tuina/scanner/line/clear_row.hpp"

using namespace tuina;
using namespace tuina::scanner;

namespace {

struct Picture {
  double amplitude_dn = 200.0;
  double background_dn = 20.0;
  double noise_dn = 4.0;
  double width_px = 2.5;
  double slope_dn_per_px = 0.0;  // of the room light
};

double true_column(int y) {
  return 200.37 + 0.2931 * y;
}

// A Gaussian line in noise, as an 8-bit (or, with `scale`, 16-bit) camera sees it.
template <typename Pixel = std::uint8_t>
BasicImage<Pixel> draw(const Picture& picture, std::uint64_t seed, double scale = 1.0) {
  Random random = make_random(seed, "line picture");
  BasicImage<Pixel> image(640, 480);
  const double most = std::numeric_limits<Pixel>::max();
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      const double u = (x - true_column(y)) / picture.width_px;
      const double light = picture.background_dn + picture.slope_dn_per_px * x +
                           picture.amplitude_dn * std::exp(-0.5 * u * u) +
                           gaussian(random, picture.noise_dn);
      image.row(y)[x] = static_cast<Pixel>(std::clamp(std::round(light * scale), 0.0, most));
    }
  }
  return image;
}

struct Errors {
  double bias_px = 0.0;
  double rms_px = 0.0;
  double stated_px = 0.0;
  int lit = 0;
};

Errors errors_of(const LaserLine& line) {
  Errors errors;
  for (const LinePoint& point : line.points) {
    const double error = static_cast<double>(point.column_px) - true_column(point.row);
    errors.bias_px += error;
    errors.rms_px += error * error;
    errors.stated_px +=
        static_cast<double>(point.deviation_px) * static_cast<double>(point.deviation_px);
    ++errors.lit;
  }
  errors.bias_px /= errors.lit;
  errors.rms_px = std::sqrt(errors.rms_px / errors.lit);
  errors.stated_px = std::sqrt(errors.stated_px / errors.lit);
  return errors;
}

Errors measure(const Picture& picture, LineMethod method) {
  Errors all;
  constexpr int pictures = 4;
  for (int seed = 1; seed <= pictures; ++seed) {
    const Image image = draw(picture, static_cast<std::uint64_t>(seed));
    const Errors one = errors_of(find_laser_line(image, {.method = method}));
    all.bias_px += one.bias_px / pictures;
    all.rms_px += one.rms_px * one.rms_px / pictures;
    all.stated_px += one.stated_px * one.stated_px / pictures;
    all.lit += one.lit;
  }
  all.rms_px = std::sqrt(all.rms_px);
  all.stated_px = std::sqrt(all.stated_px);
  MESSAGE("A " << picture.amplitude_dn << " on " << picture.background_dn << ": bias "
               << all.bias_px << ", rms " << all.rms_px << ", stated " << all.stated_px << ", lit "
               << all.lit);
  return all;
}

// Cramer-Rao bound of a Gaussian line whose amplitude, width and background are unknown.
double bound_px(const Picture& picture) {
  return picture.noise_dn / picture.amplitude_dn *
         std::sqrt(2.0 * picture.width_px / std::sqrt(3.14159265));
}

}  // namespace

TEST_CASE("the likeliest place of a line reaches the Cramer-Rao bound, without bias") {
  for (const double amplitude : {200.0, 60.0, 30.0}) {
    const Picture picture{.amplitude_dn = amplitude};
    const Errors errors = measure(picture, LineMethod::likelihood);
    CHECK(errors.lit >= 4 * 480 - 4);  // at 30 DN a line stands 7.5 deviations above the noise
    CHECK(std::abs(errors.bias_px) < 0.005);
    CHECK(errors.rms_px < 1.05 * bound_px(picture));
    CHECK(errors.stated_px == doctest::Approx(errors.rms_px).epsilon(0.1));
  }
}

TEST_CASE("with AVX2 and without, every row tells the same and every line is in the same place") {
  if (&row_reader() == &plain_row_reader()) {
    MESSAGE("skipped: this processor has no AVX2");
    return;
  }
  Random random = make_random(8, "two readers");
  std::size_t clear = 0;
  std::size_t dark = 0;
  for (int k = 0; k < 400; ++k) {
    // Widths that are no multiple of a register, lines anywhere, some rows with a second one.
    Image image(64 + static_cast<int>(random() % 700), rows_at_once);
    const RowRule rule{.first = static_cast<int>(random() % 20),
                       .last = image.width - 1 - static_cast<int>(random() % 9),
                       .beside_px = 5 + static_cast<int>(random() % 10),
                       .min_dn = 44,
                       .min_height_dn = 22.0F,
                       .min_spike_dn = 40.0F,
                       .spike_share = 0.3F};
    const double width = uniform(random, 0.7, 3.5);
    RowBatch rows;
    // Most pictures show the line of a back, some of them nothing, others a line in every place.
    const double middle = uniform(random, 0.0, image.width);
    const double amplitude = k % 7 == 0 ? 0.0 : 150.0;
    const double spread_px = k % 3 == 0 ? image.width : 6.0;
    for (int y = 0; y < image.height; ++y) {
      const double at = middle + uniform(random, -0.5, 0.5) * spread_px;
      const double second = k % 5 == 0 ? uniform(random, 0.0, 8.0 * image.width) : -1e3;
      for (int x = 0; x < image.width; ++x) {
        const auto line = [&](double centre) {
          return std::exp(-0.5 * (x - centre) * (x - centre) / (width * width));
        };
        const double light =
            20.0 + amplitude * line(at) + 90.0 * line(second) + gaussian(random, 5.0);
        image.row(y)[x] = static_cast<std::uint8_t>(std::clamp(light, 0.0, 255.0));
      }
      rows[static_cast<std::size_t>(y)] = image.row(y);
    }
    BatchView fast;
    BatchView plain;
    const int hint = k % 2 == 0 ? static_cast<int>(middle) : static_cast<int>(random() % 900);
    row_reader().classify(rows, rule, hint, fast);
    plain_row_reader().classify(rows, rule, hint, plain);
    LineWalk walk;
    for (std::size_t i = 0; i < rows_at_once; ++i) {
      CHECK(fast.view[i] == plain.view[i]);
      const bool margin = rule.has_margin(plain.brightest[i]);
      walk.column_px[i] =
          static_cast<float>(margin ? plain.brightest[i] : rule.margin_px() + rule.first);
      if (plain.view[i] == RowView::dark) ++dark;
      if (plain.view[i] != RowView::one_line) continue;
      ++clear;
      CHECK(fast.brightest[i] == plain.brightest[i]);
    }
    if (image.width < 64 + 2 * rule.margin_px()) continue;
    for (const LineKernel* kernel : {&centroid_kernel(width), &gaussian_kernel(width)}) {
      LineWalk with = walk;
      LineWalk without = walk;
      row_reader().walk(rows, *kernel, 3, with);
      plain_row_reader().walk(rows, *kernel, 3, without);
      for (std::size_t i = 0; i < rows_at_once; ++i) {
        CHECK(with.column_px[i] == doctest::Approx(without.column_px[i]).epsilon(1e-6));
        CHECK(with.height_dn[i] == doctest::Approx(without.height_dn[i]).epsilon(1e-5));
      }
    }
  }
  CHECK(clear > 2000);
  CHECK(dark > 500);
}

TEST_CASE("the centroid comes near the bound, without bias, and knows its own error") {
  for (const double amplitude : {200.0, 60.0}) {
    const Picture picture{.amplitude_dn = amplitude};
    const Errors errors = measure(picture, LineMethod::centroid);
    CHECK(errors.lit == 4 * 480);
    CHECK(std::abs(errors.bias_px) < 0.005 * 200.0 / amplitude);
    CHECK(errors.rms_px < 1.5 * bound_px(picture));
    CHECK(errors.stated_px == doctest::Approx(errors.rms_px).epsilon(0.15));
  }
}

TEST_CASE("a clipped line is found as well as an unclipped one") {
  for (const LineMethod method : {LineMethod::centroid, LineMethod::likelihood}) {
    const Errors errors = measure({.amplitude_dn = 600.0}, method);
    CHECK(errors.lit == 4 * 480);
    CHECK(std::abs(errors.bias_px) < 0.005);
    CHECK(errors.rms_px < 0.04);
  }
}

TEST_CASE("room light of 60 DN hardly matters to a line of 120 DN, even when it slopes") {
  for (const LineMethod method : {LineMethod::centroid, LineMethod::likelihood}) {
    const Errors flat = measure({.amplitude_dn = 120.0, .background_dn = 60.0}, method);
    CHECK(flat.lit == 4 * 480);
    CHECK(flat.rms_px < 0.08);
    const Errors sloping =
        measure({.amplitude_dn = 120.0, .background_dn = 20.0, .slope_dn_per_px = 0.12}, method);
    CHECK(sloping.lit == 4 * 480);
    CHECK(sloping.rms_px < 0.09);
  }
}

TEST_CASE("lines of any usual width are found without bias") {
  for (const double width : {0.8, 1.3, 4.0, 6.0}) {
    const Picture picture{.width_px = width};
    const Errors errors = measure(picture, LineMethod::likelihood);
    CHECK(errors.lit == 4 * 480);
    CHECK(std::abs(errors.bias_px) < 0.006);
    CHECK(errors.rms_px < 1.25 * bound_px(picture));
  }
}

TEST_CASE("rows without a line yield nothing, be the picture dark, bright or noisy") {
  for (const double background : {0.0, 20.0, 120.0}) {
    for (std::uint64_t seed = 1; seed <= 5; ++seed) {
      const Image image = draw({.amplitude_dn = 0.0, .background_dn = background}, seed);
      CHECK(find_laser_line(image, {.method = LineMethod::centroid}).points.empty());
      CHECK(find_laser_line(image, {.method = LineMethod::likelihood}).points.empty());
    }
  }
  CHECK(find_laser_line(Image(0, 0)).points.empty());
  CHECK(find_laser_line(Image(1, 1)).points.empty());
  CHECK(find_laser_line(Image(5, 3)).points.empty());
}

TEST_CASE("a row that is lit alone is no line, and two that continue each other are") {
  const Image lit = draw({}, 1);
  Image image = draw({.amplitude_dn = 0.0}, 2);
  std::copy_n(lit.row(100), 640, image.row(100));
  CHECK(find_laser_line(image).points.empty());
  std::copy_n(lit.row(102), 640, image.row(102));
  CHECK(find_laser_line(image).points.size() == 2);
}

TEST_CASE("a gap in the line stays a gap") {
  Image image = draw({}, 1);
  const Image empty = draw({.amplitude_dn = 0.0}, 2);
  for (int y = 100; y < 180; ++y) std::copy_n(empty.row(y), 640, image.row(y));
  const LaserLine line = find_laser_line(image);
  CHECK(line.points.size() == 400);
  for (const LinePoint& point : line.points) CHECK((point.row < 100 || point.row >= 180));
}

TEST_CASE("hot pixels are not lines and do not move one") {
  Image image = draw({.amplitude_dn = 120.0}, 1);
  for (int y = 0; y < 480; ++y) {
    image.row(y)[(37 * y) % 150] = 255;                                         // far from the line
    if (y % 10 == 0) image.row(y)[static_cast<int>(true_column(y)) + 5] = 255;  // on its flank
  }
  const LaserLine line = find_laser_line(image);
  CHECK(line.points.size() == 480);
  CHECK(errors_of(line).rms_px < 0.12);
}

TEST_CASE("a line that leaves the image is followed to the border and not beyond") {
  Image image(64, 200);
  Random random = make_random(3, "border");
  for (int y = 0; y < 200; ++y) {
    for (int x = 0; x < 64; ++x) {
      const double u = (x - (-10.0 + 0.1 * y)) / 2.5;
      const double light = 20.0 + 180.0 * std::exp(-0.5 * u * u) + gaussian(random, 4.0);
      image.row(y)[x] = static_cast<std::uint8_t>(std::clamp(std::round(light), 0.0, 255.0));
    }
  }
  double worst = 0.0;
  const LaserLine line =
      find_laser_line(image, {.method = LineMethod::likelihood, .width_px = 2.5});
  for (const LinePoint& point : line.points) {
    worst =
        std::max(worst, std::abs(static_cast<double>(point.column_px) - (-10.0 + 0.1 * point.row)));
  }
  CHECK(line.points.front().row >= 100);
  CHECK(line.points.size() > 80);
  CHECK(worst < 0.4);
}

TEST_CASE("of two lines the one that continues is chosen, and the doubt is said") {
  Image image = draw({.amplitude_dn = 110.0}, 1);
  for (int y = 200; y < 230; ++y) {  // a reflection, brighter than the line
    for (int x = 500; x < 516; ++x) {
      const double u = (x - 507.5) / 2.5;
      image.row(y)[x] = static_cast<std::uint8_t>(20.0 + 160.0 * std::exp(-0.5 * u * u));
    }
  }
  const LaserLine line = find_laser_line(image);
  CHECK(line.ambiguous_rows == 30);
  CHECK(line.points.size() == 480);
  CHECK(errors_of(line).rms_px < 0.15);
  CHECK(find_laser_line(image, {.last_column = 480}).ambiguous_rows == 0);
}

TEST_CASE("a dark frame takes the lamps off the picture") {
  Image image = draw({}, 1);
  Image dark = draw({.amplitude_dn = 0.0}, 2);
  for (int y = 0; y < 480; ++y) {
    for (int x = 560; x < 640; ++x) image.row(y)[x] = dark.row(y)[x] = 235;
  }
  const LaserLine line = find_laser_line(image, {.method = LineMethod::likelihood}, dark);
  CHECK(line.points.size() == 480);
  CHECK(errors_of(line).rms_px < 0.06);
}

TEST_CASE("a pole in a lit scene, wider than any laser line, is none") {
  Image scene = test::lit_scene(640, 480, 8, 5.0);
  for (int y = 0; y < 480; ++y) {
    for (int x = 300; x < 340; ++x) {
      const double edge = std::min({1.0, (x - 299) / 6.0, (340 - x) / 6.0});
      scene.row(y)[x] = static_cast<std::uint8_t>(scene.row(y)[x] + 60.0 * edge);
    }
  }
  CHECK(find_laser_line(test::seen(scene, 0.0, true_column, 4)).points.empty());
}

TEST_CASE("the texture of a lit scene is no line and hides none, with a dark frame or without") {
  for (const int grain_px : {4, 8, 16, 24}) {
    for (const double contrast_dn : {5.0, 15.0, 25.0}) {
      CAPTURE(grain_px);
      CAPTURE(contrast_dn);
      const Image scene = test::lit_scene(640, 480, grain_px, contrast_dn);
      const Image dark = test::seen(scene, 0.0, true_column, 1);
      const Image none = test::seen(scene, 0.0, true_column, 2);
      const Image line = test::seen(scene, 120.0, true_column, 3);
      CHECK(find_laser_line(none).points.empty());
      CHECK(find_laser_line(none, {}, dark).points.empty());
      const Errors without = errors_of(find_laser_line(line));
      CHECK(without.lit > 430);
      CHECK(find_laser_line(line, {}, dark).points.size() == 480);
    }
  }
}

TEST_CASE("what is clipped with and without the laser shows no line") {
  const auto with_lamps = [](Image image) {
    for (int y = 0; y < 480; ++y) {
      std::fill_n(image.row(y) + 100 + y % 7, 30, std::uint8_t{255});
      std::fill_n(image.row(y) + 560, 3, std::uint8_t{255});
    }
    return image;
  };
  const Image scene = test::lit_scene(640, 480, 8, 60.0);
  const Image dark = with_lamps(test::seen(scene, 0.0, true_column, 1));
  CHECK(find_laser_line(dark, {}, dark).points.empty());
  CHECK(
      find_laser_line(with_lamps(test::seen(scene, 0.0, true_column, 2)), {}, dark).points.empty());
  Image white(640, 480);
  std::fill(white.data.begin(), white.data.end(), std::uint8_t{255});
  CHECK(find_laser_line(white, {}, white).points.empty());
}

TEST_CASE("sixteen bits give the same line as eight, only finer") {
  const Image16 image = draw<std::uint16_t>({.noise_dn = 1.0}, 1, 257.0);
  const Errors errors = errors_of(find_laser_line(image, {.method = LineMethod::likelihood}));
  CHECK(errors.lit == 480);
  CHECK(errors.rms_px < 0.0095);
}

TEST_CASE(
    "[thesis] (4.10): the plain centroid above a threshold works in the dark and errs in room "
    "light") {
  const Image dark_room = draw({.background_dn = 0.0}, 1);
  CHECK(errors_of(find_laser_line(dark_room, {.method = LineMethod::thesis})).rms_px < 0.2);
  const Image lit_room = draw({.amplitude_dn = 120.0, .background_dn = 110.0}, 1);
  CHECK(errors_of(find_laser_line(lit_room, {.method = LineMethod::thesis})).rms_px > 5.0);
}
