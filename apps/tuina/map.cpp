// SPDX-License-Identifier: Apache-2.0
#include <chrono>
#include <filesystem>
#include <optional>

#include "apps/cli/fixed_points.hpp"
#include "apps/cli/position_option.hpp"
#include "apps/simulated/atlas_source.hpp"
#include "apps/tuina/verbs.hpp"
#include "tuina/body/acupoints.hpp"
#include "tuina/body/board_plane.hpp"
#include "tuina/body/learn/labelled_body.hpp"
#include "tuina/body/palpation.hpp"
#include "tuina/core/io/file.hpp"
#include "tuina/core/io/surface_file.hpp"
#include "tuina/core/units.hpp"
#include "tuina/record/acupoint_file.hpp"

namespace tuina::app {
namespace {

constexpr double fully_seen = 0.95;  // of a whole back, a scan leaves some skin in folds unseen

/// The fault of a palpated point, named as the option that gave it.
Error about_fix(const Error& error) {
  return {error.fault, "--fix: " + error.message};
}

/// What people read of an answer.
std::string words_of(const body::Mapping& mapping, std::size_t dropped_points, double compute_ms) {
  std::string words = fmt::format("{} points on a {} person, {:.0f} ms", mapping.acupoints.size(),
                                  name_of(mapping.position), compute_ms);
  if (mapping.coverage < fully_seen) {
    words += fmt::format("; {:.0f} % of the back is in view, the rest is guessed",
                         100.0 * mapping.coverage);
  }
  if (dropped_points > 0)
    words += fmt::format("; {} points were not numbers and are dropped", dropped_points);
  for (const body::PalpatedPoint& point : mapping.fixed)
    words += fmt::format("\n  {} was fixed, with an error of {:.1f} mm", point.name,
                         to_mm(point.error_m));
  for (const char* seven : seven_acupoints) {
    for (const Acupoint& point : mapping.acupoints) {
      if (point.name != seven) continue;
      words += fmt::format(
          "\n  {:<8} x {:7.1f}  y {:7.1f}  z {:7.1f} mm, true within {:.0f} mm in 95 of 100",
          point.name, to_mm(point.at_in_couch.x()), to_mm(point.at_in_couch.y()),
          to_mm(point.at_in_couch.z()), to_mm(point.uncertainty_m));
    }
  }
  return words;
}

/// Acupoints of a scan, in the scan's frame.
class MapVerb final : public Verb {
 public:
  [[nodiscard]] const char* name() const override { return "map"; }
  [[nodiscard]] const char* summary() const override { return "acupoints of a scan"; }
  [[nodiscard]] const char* example() const override {
    return "tuina map scan.ply --out acupoints.json\n"
           "  tuina map scan.ply --fix BL18_L=0.056,0.055,0.449 --out acupoints.json   "
           "(a finger has found BL18_L)";
  }

  void describe(Options& options) override {
    options.add("scan", scan_, "a cloud or mesh in couch, PLY or PCD, metres").required();
    position_.describe(options, "sitting, prone, or auto: recognised");
    options.add("--atlas", atlas_,
                "an atlas file, a labelled body or a folder of them; else the shipped one");
    options.add("--method", method_, "field_morphing (the thesis) or surface")
        .one_of({"field_morphing", "surface"})
        .show_default();
    options.add("--board", board_,
                "for field_morphing: the scan of a flat board that lay where the back is, which "
                "gives the plane of the projection; else the back itself gives it");
    fixed_.describe(options);
    options.add("--out", out_, "the answer, as acupoints.json");
  }

  [[nodiscard]] Result<Answer> run(const CommonOptions& common) override {
    if (const auto good = check_folder_of(out_); !good) return tl::unexpected(good.error());
    if (!board_.empty() && method_ != "field_morphing") {
      return fail(Fault::usage, "--board is for --method field_morphing; surface needs no plane");
    }
    const auto fixed = fixed_.read();
    if (!fixed) return tl::unexpected(fixed.error());
    if (!fixed->empty() && method_ != "surface") {
      return fail(Fault::usage,
                  "--fix is for --method surface; field_morphing does not know how points hang "
                  "together");
    }
    const auto bar = progress_bar(common, "map");
    const auto board_normal = read_board();
    if (!board_normal) return tl::unexpected(board_normal.error());
    auto scan = read_surface(scan_);
    if (!scan) return tl::unexpected(scan.error());
    if (bar) bar(0.3);
    const auto atlas = open_atlas(atlas_);
    if (!atlas) return tl::unexpected(atlas.error());
    const auto known = body::check_names(*fixed, body::labels_of(*atlas));
    if (!known) return tl::unexpected(about_fix(known.error()));
    if (bar) bar(0.6);

    const auto start = std::chrono::steady_clock::now();
    body::BackOptions options;
    options.position = position_.position();
    // A mesh says what lies between its vertices.
    const auto back = scan->triangles.empty()
                          ? body::fit_back(scan->cloud, options)
                          : body::fit_back(body::sample({scan->cloud.points, scan->triangles}, 5_mm,
                                                        body::max_mesh_points),
                                           options);
    if (!back) return refused(back.error());
    auto mapping =
        body::locate_acupoints(*back, *atlas, *body::parse_method(method_), *board_normal);
    if (!mapping) return refused(mapping.error());
    if (!fixed->empty()) {
      mapping = body::fix_points(*mapping, *back, *fixed);
      if (!mapping) return tl::unexpected(about_fix(mapping.error()));
    }
    const double compute_ms =
        std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
    if (bar) bar(1.0);

    const std::string text = record::to_json({.mapping = *mapping,
                                              .points = scan->cloud.size(),
                                              .dropped_points = scan->dropped_points,
                                              .compute_ms = compute_ms});
    if (!out_.empty()) {
      if (const auto written = write_file(out_, text + "\n"); !written)
        return tl::unexpected(written.error());
    }
    return Answer{.json = text, .text = words_of(*mapping, scan->dropped_points, compute_ms)};
  }

 private:
  /// Three points of a board on the couch, [thesis] 5.3.
  [[nodiscard]] Result<std::optional<Vector3>> read_board() const {
    if (board_.empty()) return std::optional<Vector3>();
    const auto scan = read_surface(board_);
    if (!scan) return tl::unexpected(scan.error());
    const auto places = body::three_places_of(scan->cloud);
    if (!places) return fail(places.error().fault, "{}: {}", board_, places.error().message);
    return std::optional(body::plane_normal(*places));
  }

  [[nodiscard]] tl::unexpected<Error> refused(const Error& error) const {
    // Scans of other programs have their own axes, as a rule.
    const char* hint = error.fault == Fault::not_found
                           ? "\na scan is in metres, with z up and 0 at the seat or the bed"
                           : "";
    return tl::unexpected(Error{error.fault, fmt::format("{}: {}{}", scan_, error.message, hint)});
  }

  std::string scan_;
  PositionOption position_;
  std::string atlas_;
  std::string method_ = "surface";
  std::string board_;
  FixedPoints fixed_;
  std::string out_;
};

}  // namespace

std::unique_ptr<Verb> make_map() {
  return std::make_unique<MapVerb>();
}

}  // namespace tuina::app
