// SPDX-License-Identifier: Apache-2.0
#include <filesystem>
#include <nlohmann/json.hpp>

#include "apps/cli/mark_names.hpp"
#include "apps/cli/position_option.hpp"
#include "apps/simulated/atlas_source.hpp"
#include "apps/tuina/verbs.hpp"
#include "tuina/body/learn/labelled_body.hpp"
#include "tuina/body/marks/bumps.hpp"
#include "tuina/core/io/surface_file.hpp"
#include "tuina/core/units.hpp"
#include "tuina/scanner/recording.hpp"
#include "tuina/scanner/stickers/sticker_watch.hpp"
#include "tuina/scanner/sweep.hpp"
#include "tuina/session/run.hpp"
#include "tuina/telemetry/picture/scan_mesh.hpp"

namespace tuina::app {
namespace {

namespace fs = std::filesystem;

constexpr double max_off_m = 60_mm;  // four times the largest error of the shipped atlas

/// How far a point is from where a mapping has it.
double distance_m(const std::string& name, const Vector3& at, const body::Mapping& mapping) {
  for (const Acupoint& point : mapping.acupoints)
    if (point.name == name) return (point.at_in_couch - at).norm();
  for (const Landmark& landmark : mapping.landmarks)
    if (landmark.name == name) return (landmark.at_in_couch - at).norm();
  return 0.0;
}

/// The skin of a scan as a mesh, to the edge of what was seen.
Mesh skin_of(const body::BackSurface& back, const body::Mapping& mapping) {
  Vector3 out = Vector3::Zero();
  for (const Acupoint& point : mapping.acupoints) out += point.normal_in_couch;
  const auto meshed = telemetry::mesh_scan(back.points(), out.normalized(), back.spacing_m());
  Mesh skin;
  std::vector<int> number(meshed.mesh.vertices.size(), -1);
  for (std::size_t i = 0; i < number.size(); ++i) {
    if (meshed.inside[i] < 0.5F) continue;
    number[i] = static_cast<int>(skin.vertices.size());
    skin.vertices.push_back(meshed.mesh.vertices[i]);
  }
  for (const auto& corners : meshed.mesh.triangles) {
    std::array<int, 3> kept{};
    for (std::size_t k = 0; k < 3; ++k) kept[k] = number[static_cast<std::size_t>(corners[k])];
    if (std::min({kept[0], kept[1], kept[2]}) >= 0) skin.triangles.push_back(kept);
  }
  return skin;
}

/// Half a turn about the vertical.
void turn_round(body::LabelledBody& person) {
  const auto turn = [](Vector3& v) { v = {-v.x(), -v.y(), v.z()}; };
  std::ranges::for_each(person.skin_in_couch.vertices, turn);
  for (Landmark& landmark : person.landmarks) turn(landmark.at_in_couch);
  for (Acupoint& point : person.acupoints) {
    turn(point.at_in_couch);
    turn(point.normal_in_couch);
  }
}

/// A person with stickers, as a body to learn from: [thesis] 5.1.
class AtlasRecord final : public Verb {
 public:
  [[nodiscard]] const char* name() const override { return "atlas record"; }
  [[nodiscard]] const char* summary() const override {
    return "a scan of a person with coloured stickers or small balls to a labelled back";
  }
  [[nodiscard]] const char* example() const override {
    return "tuina scan --person phantom:medium --stickers magenta=SI11,BL47,BL50 yellow=GV4 "
           "--record "
           "sweep\n"
           "  tuina atlas record sweep --labels magenta=SI11,BL47,BL50 yellow=GV4 --out "
           "people/anna.ply\n"
           "  tuina atlas learn people --prior default --out mine.tuina";
  }
  void describe(Options& options) override {
    options
        .add(
            "scan", scan_,
            "a recorded sweep with frames in colour (a folder), or a cloud whose points lie 2.5 mm "
            "apart or less (.ply, .pcd)")
        .required();
    options
        .add("--labels", labels_,
             "COLOUR=POINT,POINT,... for each colour of sticker (yellow, green, blue, magenta), "
             "of a cloud bump=POINT,...: its points from the head to the feet; SI11 means the "
             "pair, SI11_L one of it. The seven points of the thesis must be among them")
        .required();
    options.add("--out", out_, "the labelled back: NAME.ply, with NAME.json beside it").required();
    options.add("--body-type", body_type_, "slim, medium or hefty, for tables")
        .one_of({"slim", "medium", "hefty"})
        .show_default();
    position_.describe(options, "sitting, prone, or auto: recognised");
  }

  [[nodiscard]] Result<Answer> run(const CommonOptions& common) override {
    if (const auto good = check_files(); !good) return tl::unexpected(good.error());
    const auto atlas = open_atlas("");
    if (!atlas) return tl::unexpected(atlas.error());
    std::error_code fault;
    const bool is_sweep = fs::is_directory(scan_, fault);
    const auto groups =
        parse_marks(labels_, is_sweep ? sticker_kinds() : std::vector<std::string>{bump_kind},
                    atlas->positions.front().shape.labels, "--labels");
    if (!groups) return tl::unexpected(groups.error());
    if (const auto all = check_seven(*groups); !all) return tl::unexpected(all.error());
    const auto seen = is_sweep ? watch_sweep(common) : read_cloud();
    if (!seen) return refused(seen.error());
    const auto mapping = body::locate_acupoints(seen->back, *atlas);
    if (!mapping) return refused(mapping.error());
    const auto named = name_marks(seen->marks, *groups, *mapping, max_off_m);
    if (!named) return refused(named.error());

    const body::LabelledBody person = labelled(*named, *seen, *mapping);
    if (const auto written = body::write_labelled_body(person, out_); !written) {
      return tl::unexpected(written.error());
    }
    return answer(person, *named, *seen, *mapping);
  }

 private:
  /// What a scan shows: the skin, the marks on it, and of each what else is told of it.
  struct Seen {
    body::BackSurface back;
    std::vector<SkinMark> marks;
    std::vector<nlohmann::json> told;
  };

  [[nodiscard]] Result<void> check_files() const {
    const fs::path path(out_);
    if (path.extension() != ".ply") {
      return fail(Fault::usage, "--out {}: a labelled back is NAME.ply with NAME.json beside it",
                  out_);
    }
    if (auto good = check_folder_of(out_); !good) return good;
    std::error_code fault;
    if (!fs::exists(scan_, fault))
      return fail(Fault::file, "{}: there is no such folder or file", scan_);
    return {};
  }

  [[nodiscard]] Result<Seen> watch_sweep(const CommonOptions& common) const {
    auto recording = scanner::Recording::open(scan_, scanner::Recording::Frames::as_recorded);
    if (!recording) return tl::unexpected(recording.error());
    scanner::SweepOptions options;
    options.expected_frames = recording->frames();
    scanner::StickerWatch watch(*recording, recording->calibration(), options.near_m,
                                options.far_m);
    const auto scan = scanner::scan_sweep(watch, *recording, recording->calibration(), options,
                                          progress_bar(common, "record"));
    if (!scan) return tl::unexpected(scan.error());
    const auto stickers = watch.stickers(*recording->readings());
    if (!stickers) return tl::unexpected(stickers.error());
    auto back = body::fit_back(scan->cloud_in_couch, {.position = position_.position()});
    if (!back) return tl::unexpected(back.error());
    Seen seen{.back = std::move(*back), .marks = {}, .told = {}};
    for (const scanner::Sticker& one : *stickers) {
      seen.marks.push_back({scanner::name_of(one.colour), one.at_in_couch});
      seen.told.push_back({{"colour", scanner::name_of(one.colour)},
                           {"dots", one.dots},
                           {"spread_mm", to_mm(one.spread_m)}});
    }
    return seen;
  }

  [[nodiscard]] Result<Seen> read_cloud() const {
    const auto scan = read_surface(scan_);
    if (!scan) return tl::unexpected(scan.error());
    auto back = body::fit_back(scan->cloud, {.position = position_.position()});
    if (!back) return tl::unexpected(back.error());
    const auto bumps = body::find_bumps(scan->cloud, *back);
    if (!bumps) return tl::unexpected(bumps.error());
    // What is learned from is the skin below the balls.
    auto bare = body::fit_back(body::without_bumps(scan->cloud, *bumps, *back),
                               {.position = position_.position()});
    if (!bare) return tl::unexpected(bare.error());
    Seen seen{.back = std::move(*bare), .marks = {}, .told = {}};
    for (const body::Bump& bump : *bumps) {
      seen.marks.push_back({bump_kind, bump.at_in_couch});
      seen.told.push_back({{"height_mm", to_mm(bump.height_m)}, {"width_mm", to_mm(bump.width_m)}});
    }
    return seen;
  }

  [[nodiscard]] static Result<void> check_seven(const std::vector<MarkGroup>& groups) {
    std::string missing;
    for (const std::string seven : seven_acupoints) {
      bool there = false;
      for (const auto& group : groups) {
        for (const auto& level : group.levels) {
          there = there || std::find(level.begin(), level.end(), seven) != level.end();
        }
      }
      if (!there) missing += (missing.empty() ? "" : ", ") + seven;
    }
    if (missing.empty()) return {};
    return fail(Fault::usage, "--labels lacks {}; an atlas is learned from all seven points",
                missing);
  }

  [[nodiscard]] body::LabelledBody labelled(const std::map<std::string, std::size_t>& named,
                                            const Seen& seen, const body::Mapping& mapping) const {
    body::LabelledBody person;
    person.id = fs::path(out_).stem().string();
    person.body_type = body_type_;
    person.position = seen.back.position();
    person.skin_in_couch = skin_of(seen.back, mapping);
    for (const Acupoint& expected : mapping.acupoints) {
      const auto mark = named.find(expected.name);
      if (mark == named.end()) continue;
      const auto skin = seen.back.nearest(seen.marks[mark->second].at_in_couch);
      person.acupoints.push_back({expected.name, skin.at_in_couch, skin.normal_in_couch, 0.0});
    }
    for (const Landmark& expected : mapping.landmarks) {
      const auto mark = named.find(expected.name);
      if (mark == named.end()) continue;
      const auto skin = seen.back.nearest(seen.marks[mark->second].at_in_couch);
      person.landmarks.push_back({expected.name, skin.at_in_couch});
    }
    // A person may lie with the head at either end; bodies lie with the feet at +y.
    if (person.position == BodyPosture::prone && session::head_at_plus_y(person.acupoints))
      turn_round(person);
    return person;
  }

  [[nodiscard]] static Answer answer(const body::LabelledBody& person,
                                     const std::map<std::string, std::size_t>& named,
                                     const Seen& seen, const body::Mapping& mapping) {
    nlohmann::json points = nlohmann::json::object();
    std::string text =
        fmt::format("{} marks on a {} person; {} vertices, {} triangles", named.size(),
                    name_of(person.position), person.skin_in_couch.vertices.size(),
                    person.skin_in_couch.triangles.size());
    for (const auto& [name, mark] : named) {
      const Vector3& at = seen.marks[mark].at_in_couch;
      const nlohmann::json& told = seen.told[mark];
      points[name] = told;
      points[name]["position_m"] = {at.x(), at.y(), at.z()};
      const double off_mm = to_mm(distance_m(name, at, mapping));
      points[name]["from_atlas_mm"] = off_mm;
      text += fmt::format("\n  {:<24} {:<8} x {:7.1f}  y {:7.1f}  z {:7.1f} mm, {}", name,
                          seen.marks[mark].kind, to_mm(at.x()), to_mm(at.y()), to_mm(at.z()),
                          told.contains("dots")
                              ? fmt::format("{} laser dots", told["dots"].get<int>())
                              : fmt::format("{:.1f} mm high", told["height_mm"].get<double>()));
    }
    if (seen.marks.size() > named.size()) {
      text += fmt::format("\n{} stickers of colours that --labels does not name are left alone",
                          seen.marks.size() - named.size());
    }
    const nlohmann::json json{{"bodies", 1},
                              {"points", named.size()},
                              {"modes", 0},
                              {"leave_one_out_mm", nullptr},
                              {"position", name_of(person.position)},
                              {"stickers", points}};
    return Answer{.json = json.dump(2), .text = text};
  }

  [[nodiscard]] tl::unexpected<Error> refused(const Error& error) const {
    const bool named = error.message.find(scan_) != std::string::npos;
    return tl::unexpected(
        Error{error.fault, named ? error.message : fmt::format("{}: {}", scan_, error.message)});
  }

  std::string scan_;
  std::vector<std::string> labels_;
  std::string out_;
  std::string body_type_ = "medium";
  PositionOption position_;
};

}  // namespace

std::unique_ptr<Verb> make_atlas_record() {
  return std::make_unique<AtlasRecord>();
}

}  // namespace tuina::app
