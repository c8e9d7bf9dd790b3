// SPDX-License-Identifier: Apache-2.0
#include <filesystem>
#include <nlohmann/json.hpp>

#include "apps/simulated/atlas_source.hpp"
#include "apps/simulated/labelled_phantom.hpp"
#include "apps/simulated/scanned_people.hpp"
#include "apps/tuina/atlas/picture.hpp"
#include "apps/tuina/verbs.hpp"
#include "tuina/core/io/file.hpp"
#include "tuina/core/units.hpp"
#include "tuina/sim/person/phantom.hpp"

namespace tuina::app {
namespace {

/// People differ from phantoms more than phantoms do from each other: with radii so much wider,
/// those of an atlas of 40 phantoms held 95 % (sitting) and 99 % (lying) of the true points on
/// laser scans of 80 of the people of docs/bodies.md.
constexpr double people_from_phantoms = 1.8;

/// Labelled surfaces to an atlas.
class AtlasLearn final : public Verb {
 public:
  [[nodiscard]] const char* name() const override { return "atlas learn"; }
  [[nodiscard]] const char* summary() const override {
    return "learn an atlas from labelled backs";
  }
  [[nodiscard]] const char* example() const override {
    return "tuina atlas learn people/ --out people.tuina\n"
           "  tuina atlas learn my_patients/ --prior default --out mine.tuina\n"
           "  tuina atlas learn --phantoms 40 --seed 1 --scan ideal --out models/atlas.tuina   "
           "(how the shipped one is made)";
  }
  void describe(Options& options) override {
    options.add("bodies", places_,
                "folders of labelled bodies, or NAME.ply with NAME.json beside it");
    options.add("--phantoms", phantoms_, "so many drawn persons in each position, by --seed")
        .between(1, 100000);
    options.add("--prior", prior_, "`default` or an atlas file that a few bodies then adapt");
    options
        .add("--scan", scan_,
             "what the points are found from while learning: ideal surfaces, or laser: each body "
             "through the simulated scanner and its calibration errors")
        .one_of({"ideal", "laser"})
        .show_default();
    options.add("--out", out_, "the atlas").required();
  }
  [[nodiscard]] Result<Answer> run(const CommonOptions& common) override {
    if (places_.empty() == (phantoms_ == 0)) {
      return fail(Fault::usage,
                  "atlas learn needs labelled bodies or --phantoms N, one of the two");
    }
    if (const auto good = check_folder_of(out_); !good) return tl::unexpected(good.error());
    auto bodies = source(common.seed);
    if (!bodies) return tl::unexpected(bodies.error());
    std::optional<body::Atlas> prior;
    if (!prior_.empty()) {
      auto read = prior_ == "default" ? open_atlas("") : body::read_atlas(prior_);
      if (!read) return tl::unexpected(read.error());
      prior = std::move(*read);
    }
    body::LearnReport report;
    // The arms of phantoms are not like those of people: with the skin of shoulders and arms,
    // people who sat were answered 11.3 mm off instead of 8.3 (laser scans of 40 of the people of
    // docs/bodies.md).
    const auto reach = phantoms_ > 0 ? body::Reach::acupoints : body::Reach::labels;
    auto atlas = body::learn_atlas(*bodies, prior ? &*prior : nullptr,
                                   progress_bar(common, "learn"), &report, reach);
    if (!atlas) return tl::unexpected(atlas.error());
    if (phantoms_ > 0) {
      const auto shipped = open_atlas("");
      if (!shipped) return tl::unexpected(shipped.error());
      for (auto& position : atlas->positions) position.shape.radius95_m *= people_from_phantoms;
      // The more phantoms, the less they differ from what was learned of them; people do not.
      body::keep_radii_above(*shipped, *atlas);
    }
    const std::string bytes = to_bytes(*atlas);
    if (const auto written = write_file(out_, bytes); !written)
      return tl::unexpected(written.error());
    nlohmann::json json{{"bodies", report.bodies}, {"points", report.points},
                        {"modes", report.modes},   {"leave_one_out_mm", nullptr},
                        {"bytes", bytes.size()},   {"skipped", report.skipped}};
    std::string text = fmt::format("{} bodies, {} points, {} modes, {} kB", report.bodies,
                                   report.points, report.modes, bytes.size() / 1000);
    if (report.leave_one_out_mm > 0.0) {
      json["leave_one_out_mm"] = report.leave_one_out_mm;
      text += fmt::format("; on bodies left out the seven points are {:.1f} mm off",
                          report.leave_one_out_mm);
    }
    for (const auto& skipped : report.skipped) text += fmt::format("\n  left out: {}", skipped);
    return Answer{.json = json.dump(2), .text = text};
  }

 private:
  /// Bodies that are read, drawn and scanned again whenever they are looked at: nobody stays in
  /// memory.
  [[nodiscard]] Result<body::BodySource> source(std::uint64_t seed) const {
    const bool laser = scan_ == "laser";
    const auto scanned = [=](body::LabelledBody body, std::size_t number,
                             body::BodySource::Needs needs) {
      if (laser && needs == body::BodySource::Needs::scan) scan_body(body, seed + number);
      return body;
    };
    if (phantoms_ > 0) {
      const auto drawn = [=](std::size_t number, body::BodySource::Needs needs) {
        const auto position = number % 2 == 0 ? BodyPosture::sitting : BodyPosture::prone;
        const auto shape = sim::draw_phantom(seed * 100000 + number / 2);
        return Result<body::LabelledBody>(
            scanned(labelled(sim::make_phantom(shape, position)), number, needs));
      };
      return body::BodySource{2 * static_cast<std::size_t>(phantoms_), drawn};
    }
    auto paths = list_labelled(places_);
    if (!paths) return tl::unexpected(paths.error());
    const std::size_t count = paths->size();
    const auto read = [=, paths = std::move(*paths)](
                          std::size_t number,
                          body::BodySource::Needs needs) -> Result<body::LabelledBody> {
      auto body = body::read_labelled_body(paths[number]);
      if (!body) return body;
      return scanned(std::move(*body), number, needs);
    };
    return body::BodySource{count, read};
  }

  std::vector<std::string> places_;
  int phantoms_ = 0;
  std::string prior_;
  std::string scan_ = "laser";
  std::string out_;
};

/// What an atlas knows.
class AtlasShow final : public Verb {
 public:
  [[nodiscard]] const char* name() const override { return "atlas show"; }
  [[nodiscard]] const char* summary() const override { return "what an atlas knows"; }
  [[nodiscard]] const char* example() const override {
    return "tuina atlas show models/atlas.tuina --picture atlas.svg";
  }
  void describe(Options& options) override {
    options.add("atlas", atlas_, "an atlas file; else the shipped one");
    options.add("--picture", picture_, "the mean back and its first modes, as SVG");
  }
  [[nodiscard]] Result<Answer> run(const CommonOptions&) override {
    const auto atlas = open_atlas(atlas_);
    if (!atlas) return tl::unexpected(atlas.error());
    if (!picture_.empty()) {
      const auto written = write_file(picture_, atlas_picture(*atlas));
      if (!written) return tl::unexpected(written.error());
    }
    nlohmann::json positions = nlohmann::json::array();
    std::string text = atlas->made;
    int bodies = 0;
    std::size_t points = 0;
    Eigen::Index modes = 0;
    for (const auto& known : atlas->positions) {
      const auto& shape = known.shape;
      bodies += shape.bodies;
      points = std::max(points, shape.labels.size());
      modes = std::max(modes, shape.modes.cols());
      nlohmann::json radii = nlohmann::json::object();
      for (std::size_t i = 0; i < shape.labels.size(); ++i) {
        radii[shape.labels[i]] = to_mm(shape.radius95_m[static_cast<Eigen::Index>(i)]);
      }
      positions.push_back({{"position", name_of(shape.position)},
                           {"bodies", shape.bodies},
                           {"skin_points", shape.skin_points()},
                           {"most_unusual", shape.max_outlier_score},
                           {"radius95_mm", radii}});
      text += fmt::format("\n{}: {} bodies, {} skin points, {} labels ({} acupoints), {} modes",
                          name_of(shape.position), shape.bodies, shape.skin_points(),
                          shape.labels.size(), shape.acupoints, shape.modes.cols());
    }
    const nlohmann::json json{{"made", atlas->made},
                              {"bodies", bodies},
                              {"points", points},
                              {"modes", modes},
                              {"leave_one_out_mm", nullptr},
                              {"positions", positions}};
    return Answer{.json = json.dump(2), .text = text};
  }

 private:
  std::string atlas_;
  std::string picture_;
};

}  // namespace

std::unique_ptr<Verb> make_atlas_learn() {
  return std::make_unique<AtlasLearn>();
}
std::unique_ptr<Verb> make_atlas_show() {
  return std::make_unique<AtlasShow>();
}

}  // namespace tuina::app
