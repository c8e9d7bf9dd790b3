// SPDX-License-Identifier: Apache-2.0
// One picture of 640 x 480 with a line of 2.5 px and 4 DN of noise. The limit is reading the
// picture once; the peers are what a user would write and what the open scanners do, written out
// plainly.
#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <vector>

#if defined(__x86_64__) && defined(__GNUC__)
#include <immintrin.h>
#endif
#ifdef TUINA_BENCH_OPENCV
#include <opencv2/imgproc.hpp>
#endif

#include "tests/scanner/lit_scene.hpp"
#include "tuina/core/random.hpp"
#include "tuina/core/units.hpp"
#include "tuina/scanner/line/colours.hpp"
#include "tuina/scanner/line/laser_line.hpp"
#include "tuina/scanner/sweep.hpp"

namespace {

using namespace tuina;
using namespace tuina::scanner;

double true_column(int y) {
  return 300.0 + 40.0 * std::sin(0.01 * y);
}

Image draw(double amplitude_dn, double background_dn, std::uint64_t seed) {
  Random random = make_random(seed, "bench picture");
  Image image(640, 480);
  for (int y = 0; y < 480; ++y) {
    for (int x = 0; x < 640; ++x) {
      const double u = (x - true_column(y)) / 2.5;
      const double light =
          background_dn + amplitude_dn * std::exp(-0.5 * u * u) + gaussian(random, 4.0);
      image.row(y)[x] = static_cast<std::uint8_t>(std::clamp(std::round(light), 0.0, 255.0));
    }
  }
  return image;
}

// Amplitude and background from the arguments of the benchmark.
Image picture_of(const benchmark::State& state) {
  return draw(static_cast<double>(state.range(0)), static_cast<double>(state.range(1)), 1);
}

template <typename Columns>
void report(benchmark::State& state, const Columns& columns) {
  double bias = 0.0;
  double rms = 0.0;
  int lit = 0;
  for (const auto& [row, column] : columns) {
    const double error = static_cast<double>(column) - true_column(row);
    bias += error;
    rms += error * error;
    ++lit;
  }
  state.counters["lit"] = lit;
  state.counters["bias_px"] = bias / std::max(1, lit);
  state.counters["rms_px"] = std::sqrt(rms / std::max(1, lit));
}

using Columns = std::vector<std::pair<int, double>>;

// The read limit as a user writes it; the compiler makes vectors of it.
void sum_of_all_pixels(benchmark::State& state) {
  const Image image = picture_of(state);
  for (auto _ : state) {
    std::uint32_t sum = 0;
    for (const std::uint8_t pixel : image.data) sum += pixel;
    benchmark::DoNotOptimize(sum);
  }
}

// The limit: 32 pixels of an L2-resident picture in one instruction that adds them up, four sums
// side by side. No reading of the picture is faster.
#if defined(__x86_64__) && defined(__GNUC__)
__attribute__((target("avx2"))) std::int64_t sum_wide(const std::uint8_t* pixels,
                                                      std::size_t count) {
  __m256i sums[4] = {};
  for (std::size_t i = 0; i < count; i += 128) {
    for (std::size_t k = 0; k < 4; ++k) {
      const auto* from = reinterpret_cast<const __m256i*>(pixels + i + 32 * k);
      sums[k] = _mm256_add_epi64(sums[k],
                                 _mm256_sad_epu8(_mm256_loadu_si256(from), _mm256_setzero_si256()));
    }
  }
  const __m256i all =
      _mm256_add_epi64(_mm256_add_epi64(sums[0], sums[1]), _mm256_add_epi64(sums[2], sums[3]));
  return _mm256_extract_epi64(all, 0) + _mm256_extract_epi64(all, 1) +
         _mm256_extract_epi64(all, 2) + _mm256_extract_epi64(all, 3);
}

void read_limit_avx2(benchmark::State& state) {
  const Image image = picture_of(state);
  if (!__builtin_cpu_supports("avx2")) return state.SkipWithError("this processor has no AVX2");
  for (auto _ : state) benchmark::DoNotOptimize(sum_wide(image.data.data(), image.data.size()));
}
#else
void read_limit_avx2(benchmark::State& state) {
  state.SkipWithError("not an x86-64 processor");
}
#endif

void ours(benchmark::State& state, LineMethod method) {
  const Image image = picture_of(state);
  // In a sweep the noise of the camera is known after the first frame; here it is estimated every
  // time.
  LaserLine line;
  for (auto _ : state) {
    line = find_laser_line(image, {.method = method});
    benchmark::DoNotOptimize(line.points.data());
  }
  Columns columns;
  for (const LinePoint& point : line.points) {
    columns.emplace_back(point.row, static_cast<double>(point.column_px));
  }
  report(state, columns);
}

void ours_centroid(benchmark::State& state) {
  ours(state, LineMethod::centroid);
}
void ours_likelihood(benchmark::State& state) {
  ours(state, LineMethod::likelihood);
}
void thesis_centroid(benchmark::State& state) {
  ours(state, LineMethod::thesis);
}

// Row by row the brightest pixel, then the moments of a window around it: what most users write
// first.
void row_maximum_and_moments(benchmark::State& state) {
  const Image image = picture_of(state);
  Columns columns;
  for (auto _ : state) {
    columns.clear();
    for (int y = 0; y < image.height; ++y) {
      const std::uint8_t* row = image.row(y);
      int best = 0;
      for (int x = 1; x < image.width; ++x) {
        if (row[x] > row[best]) best = x;
      }
      if (row[best] < 40) continue;
      double light = 0.0;
      double moment = 0.0;
      for (int x = std::max(0, best - 8); x <= std::min(image.width - 1, best + 8); ++x) {
        light += row[x];
        moment += static_cast<double>(row[x]) * x;
      }
      columns.emplace_back(y, moment / light);
    }
    benchmark::DoNotOptimize(columns.data());
  }
  report(state, columns);
}

#ifdef TUINA_BENCH_OPENCV
// The same with OpenCV, as a user would write it.
void opencv_maximum_and_moments(benchmark::State& state) {
  Image image = picture_of(state);
  const cv::Mat picture(image.height, image.width, CV_8U, image.data.data());
  Columns columns;
  for (auto _ : state) {
    columns.clear();
    for (int y = 0; y < picture.rows; ++y) {
      double most = 0.0;
      cv::Point at;
      cv::minMaxLoc(picture.row(y), nullptr, &most, nullptr, &at);
      if (most < 40.0) continue;
      const int from = std::max(0, at.x - 8);
      const int to = std::min(picture.cols, at.x + 9);
      const cv::Moments moments = cv::moments(picture(cv::Range(y, y + 1), cv::Range(from, to)));
      columns.emplace_back(y, from + moments.m10 / moments.m00);
    }
    benchmark::DoNotOptimize(columns.data());
  }
  report(state, columns);
}
#endif

// The open scanners: laser on minus laser off, a fixed threshold, the centroid of what is left of
// each row.
void on_off_difference_threshold(benchmark::State& state) {
  const Image on = picture_of(state);
  const Image off = draw(0.0, static_cast<double>(state.range(1)), 2);
  std::vector<int> difference(static_cast<std::size_t>(on.width));
  Columns columns;
  for (auto _ : state) {
    columns.clear();
    for (int y = 0; y < on.height; ++y) {
      int best = 0;
      for (int x = 0; x < on.width; ++x) {
        const auto i = static_cast<std::size_t>(x);
        difference[i] = std::max(0, on.row(y)[x] - off.row(y)[x]);
        if (difference[i] < 20) difference[i] = 0;
        if (difference[i] > difference[static_cast<std::size_t>(best)]) best = x;
      }
      double light = 0.0;
      double moment = 0.0;
      for (int x = std::max(0, best - 10); x <= std::min(on.width - 1, best + 10); ++x) {
        light += difference[static_cast<std::size_t>(x)];
        moment += static_cast<double>(difference[static_cast<std::size_t>(x)]) * x;
      }
      if (light > 0.0) columns.emplace_back(y, moment / light);
    }
    benchmark::DoNotOptimize(columns.data());
  }
  report(state, columns);
}

ScannerCalibration upright_scanner() {
  ScannerCalibration calibration;
  calibration.camera = {.width_px = 480,
                        .height_px = 640,
                        .fx_px = 1041.67,
                        .fy_px = 1041.67,
                        .cx_px = 239.5,
                        .cy_px = 319.5};
  calibration.laser_normal_in_camera = {std::sin(73.0_deg), 0.0, std::cos(73.0_deg)};
  calibration.laser_distance_m = 0.2 * std::sin(73.0_deg);
  return calibration;
}

std::vector<YawReading> even_turn(int frames) {
  std::vector<YawReading> readings;
  for (int i = 0; i < frames; ++i) readings.push_back({i / 30.0, from_deg(0.2 * i)});
  return readings;
}

// 200 lines of 640 rows to a cloud with normals, the lines already found.
void lines_to_cloud(benchmark::State& state) {
  const ScannerCalibration calibration = upright_scanner();
  std::vector<TimedLine> lines;
  for (int i = 0; i < 200; ++i) {
    TimedLine line{.time_s = i / 30.0, .line = {}};
    for (int row = 0; row < 640; ++row) {
      line.line.points.push_back(
          {.row = row, .column_px = 110.0F, .amplitude_dn = 200.0F, .deviation_px = 0.03F});
    }
    lines.push_back(line);
  }
  const auto readings = even_turn(200);
  for (auto _ : state) benchmark::DoNotOptimize(make_cloud(lines, readings, calibration));
}

// The whole of it: 200 frames in memory (61 MB) to a cloud with normals.
void frames_to_cloud(benchmark::State& state, LineMethod method) {
  const ScannerCalibration calibration = upright_scanner();
  Random random = make_random(1, "bench frames");
  Image noise(480, 640);
  for (auto& pixel : noise.data) {
    pixel = static_cast<std::uint8_t>(std::max(0.0, 20.5 + gaussian(random, 4.0)));
  }
  std::vector<Image> frames(200, noise);
  for (std::size_t i = 0; i < frames.size(); ++i) {
    std::rotate(frames[i].data.begin(),
                frames[i].data.begin() + static_cast<std::ptrdiff_t>(1237 * i),
                frames[i].data.end());
    for (int y = 0; y < 640; ++y) {
      const double middle = 110.0 + 10.0 * std::sin(0.01 * y);
      for (int x = 90; x < 130; ++x) {
        const double u = (x - middle) / 2.5;
        auto& pixel = frames[i].row(y)[x];
        pixel = static_cast<std::uint8_t>(pixel + 200.0 * std::exp(-0.5 * u * u));
      }
    }
  }
  const auto readings = even_turn(200);
  std::size_t points = 0;
  for (auto _ : state) {
    std::vector<TimedLine> lines;
    for (std::size_t i = 0; i < frames.size(); ++i) {
      lines.push_back({readings[i].time_s, find_laser_line(frames[i], {.method = method})});
    }
    const auto scan = make_cloud(lines, readings, calibration);
    if (scan) points = scan->cloud_in_couch.size();
  }
  state.counters["points"] = static_cast<double>(points);
}

void frames_to_cloud_centroid(benchmark::State& state) {
  frames_to_cloud(state, LineMethod::centroid);
}
void frames_to_cloud_likelihood(benchmark::State& state) {
  frames_to_cloud(state, LineMethod::likelihood);
}

// A lit, textured scene without a line and without a dark frame, where every row is in doubt; of
// 640 x 480 and of 12 million pixels.
void lit_scene_without_line(benchmark::State& state) {
  const int width = static_cast<int>(state.range(0));
  const Image scene = test::lit_scene(width, width * 3 / 4, static_cast<int>(state.range(1)), 15.0);
  const Image image = test::seen(scene, 0.0, true_column, 1);
  LaserLine line;
  for (auto _ : state) {
    line = find_laser_line(image);
    benchmark::DoNotOptimize(line.points.data());
  }
  state.counters["lit"] = static_cast<double>(line.points.size());
}

// The same scene with a line and with a dark frame.
void lit_scene_with_dark_frame(benchmark::State& state) {
  const int width = static_cast<int>(state.range(0));
  const Image scene = test::lit_scene(width, width * 3 / 4, static_cast<int>(state.range(1)), 15.0);
  const Image dark = test::seen(scene, 0.0, true_column, 1);
  const Image image = test::seen(scene, 120.0, true_column, 2);
  LaserLine line;
  for (auto _ : state) {
    line = find_laser_line(image, {}, dark);
    benchmark::DoNotOptimize(line.points.data());
  }
  state.counters["lit"] = static_cast<double>(line.points.size());
}

// A line in a lit, textured scene without a dark frame, told by its colour.
void line_by_colour(benchmark::State& state) {
  const int width = static_cast<int>(state.range(0));
  const auto at = [&](double share) { return [=](int y) { return share * width + 0.2 * y; }; };
  const Image image = test::coloured(width, width * 3 / 4,
                                     {.laser_dn = static_cast<double>(state.range(1)),
                                      .white_dn = static_cast<double>(state.range(2))},
                                     at(0.3), at(0.6));
  LaserLine line;
  for (auto _ : state) {
    line = find_red_line(image);
    benchmark::DoNotOptimize(line.points.data());
  }
  state.counters["lit"] = static_cast<double>(line.points.size());
}

void pictures(benchmark::internal::Benchmark* bench) {
  bench->ArgNames({"amplitude", "background"});
  for (const int amplitude : {200, 60}) bench->Args({amplitude, 20});
  bench->Args({600, 20});
  bench->Args({120, 60});
  bench->Unit(benchmark::kMicrosecond);
}

}  // namespace

BENCHMARK(sum_of_all_pixels)->Args({200, 20})->Unit(benchmark::kMicrosecond);
BENCHMARK(read_limit_avx2)->Args({200, 20})->Unit(benchmark::kMicrosecond);
BENCHMARK(ours_centroid)->Apply(pictures);
BENCHMARK(ours_likelihood)->Apply(pictures);
BENCHMARK(thesis_centroid)->Apply(pictures);
BENCHMARK(row_maximum_and_moments)->Apply(pictures);
#ifdef TUINA_BENCH_OPENCV
BENCHMARK(opencv_maximum_and_moments)->Apply(pictures);
#endif
BENCHMARK(on_off_difference_threshold)->Apply(pictures);
BENCHMARK(lit_scene_without_line)
    ->ArgNames({"width", "grain"})
    ->ArgsProduct({{640, 4000}, {8, 16}})
    ->Unit(benchmark::kMillisecond);
BENCHMARK(lit_scene_with_dark_frame)
    ->ArgNames({"width", "grain"})
    ->ArgsProduct({{640, 4000}, {8}})
    ->Unit(benchmark::kMillisecond);
BENCHMARK(line_by_colour)
    ->ArgNames({"width", "laser", "white"})
    ->ArgsProduct({{640, 4000}, {0, 90, 2500}, {0}})
    ->ArgsProduct({{640, 4000}, {90}, {130}})
    ->Unit(benchmark::kMillisecond);
BENCHMARK(lines_to_cloud)->Unit(benchmark::kMillisecond);
BENCHMARK(frames_to_cloud_centroid)->Unit(benchmark::kMillisecond);
BENCHMARK(frames_to_cloud_likelihood)->Unit(benchmark::kMillisecond);

// Keeps the times, so that their ratios can be printed below them.
class Reporter : public benchmark::ConsoleReporter {
 public:
  void ReportRuns(const std::vector<Run>& runs) override {
    for (const Run& run : runs) cpu[run.benchmark_name()] = run.GetAdjustedCPUTime();
    ConsoleReporter::ReportRuns(runs);
  }
  std::map<std::string, double> cpu;
};

int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
  Reporter reporter;
  benchmark::RunSpecifiedBenchmarks(&reporter);
  // Ratios of what ran: a filter leaves some out.
  const auto us = [&](const std::string& name) {
    const auto found = reporter.cpu.find(name);
    return found == reporter.cpu.end() ? std::nan("") : found->second;
  };
  const std::string picture = "/amplitude:200/background:20";
  const double centroid_us = us("ours_centroid" + picture);
  const double likelihood_us = us("ours_likelihood" + picture);
  for (const std::string limit : {"sum_of_all_pixels", "read_limit_avx2"}) {
    const double limit_us = us(limit + "/200/20");
    if (const double sum = limit_us + centroid_us + likelihood_us; std::isnan(sum)) continue;
    fmt::print("over {}: centroid {:.2f}, likelihood {:.2f}\n", limit, centroid_us / limit_us,
               likelihood_us / limit_us);
  }
  for (const std::string peer :
       {"row_maximum_and_moments", "opencv_maximum_and_moments", "on_off_difference_threshold"}) {
    const double ratio = us(peer + picture) / centroid_us;
    if (!std::isnan(ratio)) fmt::print("{} over centroid: {:.1f}\n", peer, ratio);
  }
  return 0;
}
