// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <chrono>
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>

#include "apps/tuina/line_picture.hpp"
#include "apps/tuina/verbs.hpp"
#include "tuina/core/io/file.hpp"
#include "tuina/core/io/png.hpp"
#include "tuina/scanner/line/colours.hpp"
#include "tuina/scanner/line/laser_line.hpp"

namespace tuina::app {
namespace {

using scanner::LaserLine;
using scanner::LineMethod;
using scanner::LineOptions;
using scanner::LinePoint;

// The picture with samples of its own depth.
template <typename Sample>
BasicImage<Sample> samples_of(const PngFile& png) {
  BasicImage<Sample> image(png.image.width, png.image.height, png.image.channels);
  std::transform(png.image.data.begin(), png.image.data.end(), image.data.begin(),
                 [](std::uint16_t value) { return static_cast<Sample>(value); });
  return image;
}

constexpr double max_saturated_share = 0.5;

/// Share of the samples that are as bright as the file can say.
double saturated_share(const PngFile& png) {
  const auto most = static_cast<std::uint16_t>((1U << static_cast<unsigned>(png.bits)) - 1U);
  const auto count = std::count(png.image.data.begin(), png.image.data.end(), most);
  return static_cast<double>(count) / static_cast<double>(png.image.data.size());
}

struct Measured {
  LaserLine line;
  double compute_us = 0.0;  // best of five, so that other work on the machine does not count
};

template <typename Sample>
Measured measure(const PngFile& png, const std::optional<PngFile>& dark_png,
                 const LineOptions& options) {
  const auto image = samples_of<Sample>(png);
  const bool by_colour = image.channels >= 3 && !dark_png && options.method != LineMethod::thesis;
  const auto red = scanner::red_of(image);
  const auto dark =
      dark_png ? scanner::red_of(samples_of<Sample>(*dark_png)) : BasicImage<Sample>();
  const auto dark_view = dark_png ? BasicImageView<Sample>(dark) : BasicImageView<Sample>();
  Measured measured{.line = {}, .compute_us = 1e12};
  for (int run = 0; run < 5; ++run) {
    const auto start = std::chrono::steady_clock::now();
    measured.line = by_colour ? scanner::find_red_line(image, options)
                              : find_laser_line(BasicImageView<Sample>(red), options, dark_view);
    const std::chrono::duration<double, std::micro> took = std::chrono::steady_clock::now() - start;
    measured.compute_us = std::min(measured.compute_us, took.count());
  }
  return measured;
}

std::string to_csv(const LaserLine& line) {
  std::string csv = "row,column_px,amplitude_dn\n";
  for (const LinePoint& point : line.points) {
    csv += fmt::format("{},{:.4f},{:.2f}\n", point.row, point.column_px, point.amplitude_dn);
  }
  return csv;
}

/// Finds the laser line of one picture.
class Line final : public Verb {
 public:
  [[nodiscard]] const char* name() const override { return "line"; }
  [[nodiscard]] const char* summary() const override { return "find the laser line in one image"; }
  [[nodiscard]] const char* example() const override {
    return "tuina line frame.png --dark dark.png --out line.csv --picture seen.png";
  }
  void describe(Options& options) override {
    options
        .add("image", image_,
             "PNG, grey or colour (a red laser is told by its colour), 8 or 16 bit")
        .required();
    options.add("--dark", dark_, "the same view with the laser off");
    options.add("--method", method_, "centroid, likelihood, or thesis (the plain (4.10))")
        .one_of({"centroid", "likelihood", "thesis"})
        .show_default();
    options.add("--out", out_, "CSV row,column_px,amplitude_dn; else it goes to stdout");
    options.add("--picture", picture_, "PNG with the line drawn over the image");
  }

  [[nodiscard]] Result<Answer> run(const CommonOptions&) override {
    const auto png = read_png(image_);
    if (!png) return tl::unexpected(png.error());
    std::optional<PngFile> dark;
    if (!dark_.empty()) {
      auto read = read_png(dark_);
      if (!read) return tl::unexpected(read.error());
      if (read->image.width != png->image.width || read->image.height != png->image.height ||
          read->bits != png->bits) {
        return fail(Fault::bad_input,
                    "{}: {} x {} pixels of {} bits do not belong to an image of {} x {} of {}",
                    dark_, read->image.width, read->image.height, read->bits, png->image.width,
                    png->image.height, png->bits);
      }
      if (const double share = saturated_share(*read); share > max_saturated_share) {
        return fail(
            Fault::bad_input,
            "{}: {:.0f} % of it is saturated and tells nothing of the scene, at most {:.0f} "
            "% may be: a shorter exposure is needed",
            dark_, 100.0 * share, 100.0 * max_saturated_share);
      }
      dark = std::move(*read);
    }
    const LineOptions options{.method =
                                  scanner::line_method(method_).value_or(LineMethod::centroid)};
    const Measured measured = png->bits > 8 ? measure<std::uint16_t>(*png, dark, options)
                                            : measure<std::uint8_t>(*png, dark, options);
    const LaserLine& line = measured.line;
    const std::string csv = to_csv(line);
    // The drawing first: if it cannot be written, no table is left that looks like a success.
    if (!picture_.empty()) {
      if (const auto written =
              write_file(picture_, to_png(draw_line_over(png->image, png->bits, line)));
          !written) {
        return tl::unexpected(written.error());
      }
    }
    if (!out_.empty()) {
      if (const auto written = write_file(out_, csv); !written)
        return tl::unexpected(written.error());
    }
    Answer answer;
    answer.json = nlohmann::json{{"method", method_},
                                 {"rows", png->image.height},
                                 {"lit", line.points.size()},
                                 {"ambiguous_rows", line.ambiguous_rows},
                                 {"noise_dn", line.noise_dn},
                                 {"width_px", line.width_px},
                                 {"compute_us", measured.compute_us}}
                      .dump(2);
    answer.text = fmt::format("{} of {} rows lit, {:.0f} us", line.points.size(), png->image.height,
                              measured.compute_us);
    if (line.ambiguous_rows > 0) {
      answer.text +=
          fmt::format("; {} rows show a second line (a reflection?)", line.ambiguous_rows);
    }
    if (out_.empty()) answer.product = csv;
    return answer;
  }

 private:
  std::string image_;
  std::string dark_;
  std::string method_ = "centroid";
  std::string out_;
  std::string picture_;
};

}  // namespace

std::unique_ptr<Verb> make_line() {
  return std::make_unique<Line>();
}

}  // namespace tuina::app
