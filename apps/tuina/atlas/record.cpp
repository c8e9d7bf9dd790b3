// SPDX-License-Identifier: Apache-2.0
#include <filesystem>
#include <nlohmann/json.hpp>

#include "apps/cli/mark_names.hpp"
#include "apps/cli/position_option.hpp"
#include "apps/simulated/atlas_source.hpp"
#include "apps/tuina/verbs.hpp"
#include "tuina/body/learn/labelled_body.hpp"
#include "tuina/core/units.hpp"
#include "tuina/scanner/recording.hpp"
#include "tuina/scanner/sweep.hpp"
#include "tuina/telemetry/picture/scan_mesh.hpp"

namespace tuina::app {
namespace {

namespace fs = std::filesystem;

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

/// A person with stickers, as a body to learn from: [thesis] 5.1.
class AtlasRecord final : public Verb {
 public:
  [[nodiscard]] const char* name() const override { return "atlas record"; }
  [[nodiscard]] const char* summary() const override {
    return "a recorded sweep of a person with coloured stickers to a labelled back";
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
    options.add("sweep", sweep_, "a recorded sweep with frames in colour (a folder)").required();
    options
        .add("--labels", labels_,
             "COLOUR=POINT,POINT,... for each colour of sticker (yellow, green, blue, "
             "magenta): its points from the head to the feet; SI11 means the pair, SI11_L one "
             "of it. The seven points of the thesis must be among them")
        .required();
    options.add("--out", out_, "the labelled back: NAME.ply, with NAME.json beside it").required();
    options.add("--body-type", body_type_, "slim, medium or hefty, for tables")
        .one_of({"slim", "medium", "hefty"})
        .show_default();
    position_.describe(options, "sitting, prone, or auto: recognised");
  }

  [[nodiscard]] Result<Answer> run(const CommonOptions& common) override {
    if (const auto good = check_out(); !good) return tl::unexpected(good.error());
    const auto atlas = open_atlas("");
    if (!atlas) return tl::unexpected(atlas.error());
    const auto groups = parse_stickers(labels_, atlas->positions.front().shape.labels, "--labels");
    if (!groups) return tl::unexpected(groups.error());
    if (const auto all = check_seven(*groups); !all) return tl::unexpected(all.error());

    auto recording = scanner::Recording::open(sweep_, scanner::Recording::Frames::as_recorded);
    if (!recording) return tl::unexpected(recording.error());
    scanner::SweepOptions options;
    options.expected_frames = recording->frames();
    scanner::StickerWatch watch(*recording, recording->calibration(), options.near_m,
                                options.far_m);
    const auto scan = scanner::scan_sweep(watch, *recording, recording->calibration(), options,
                                          progress_bar(common, "record"));
    if (!scan) return refused(scan.error());
    const auto stickers = watch.stickers(*recording->readings());
    if (!stickers) return refused(stickers.error());

    body::BackOptions back_options;
    back_options.position = position_.position();
    const auto back = body::fit_back(scan->cloud_in_couch, back_options);
    if (!back) return refused(back.error());
    const auto mapping = body::locate_acupoints(*back, *atlas);
    if (!mapping) return refused(mapping.error());
    const auto named = name_stickers(*stickers, *groups, *mapping);
    if (!named) return refused(named.error());

    const body::LabelledBody person = labelled(*named, *back, *mapping);
    if (const auto written = body::write_labelled_body(person, out_); !written) {
      return tl::unexpected(written.error());
    }
    return answer(person, *named, stickers->size());
  }

 private:
  [[nodiscard]] Result<void> check_out() const {
    const fs::path path(out_);
    if (path.extension() != ".ply") {
      return fail(Fault::usage, "--out {}: a labelled back is NAME.ply with NAME.json beside it",
                  out_);
    }
    if (auto good = check_folder_of(out_); !good) return good;
    std::error_code fault;
    if (fs::is_directory(sweep_, fault)) return {};
    if (!fs::exists(sweep_, fault)) return fail(Fault::file, "{}: there is no such folder", sweep_);
    return fail(Fault::bad_input,
                "{}: a recorded sweep (a folder, `tuina scan --record`) is needed: a cloud has no "
                "colours",
                sweep_);
  }

  [[nodiscard]] static Result<void> check_seven(const std::vector<StickerGroup>& groups) {
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

  [[nodiscard]] body::LabelledBody labelled(const std::map<std::string, scanner::Sticker>& named,
                                            const body::BackSurface& back,
                                            const body::Mapping& mapping) const {
    body::LabelledBody person;
    person.id = fs::path(out_).stem().string();
    person.body_type = body_type_;
    person.position = back.position();
    person.skin_in_couch = skin_of(back, mapping);
    for (const Acupoint& expected : mapping.acupoints) {
      const auto sticker = named.find(expected.name);
      if (sticker == named.end()) continue;
      const auto skin = back.nearest(sticker->second.at_in_couch);
      person.acupoints.push_back({expected.name, skin.at_in_couch, skin.normal_in_couch, 0.0});
    }
    for (const Landmark& expected : mapping.landmarks) {
      const auto sticker = named.find(expected.name);
      if (sticker == named.end()) continue;
      person.landmarks.push_back(
          {expected.name, back.nearest(sticker->second.at_in_couch).at_in_couch});
    }
    return person;
  }

  [[nodiscard]] Answer answer(const body::LabelledBody& person,
                              const std::map<std::string, scanner::Sticker>& named,
                              std::size_t seen) const {
    nlohmann::json points = nlohmann::json::object();
    std::string text =
        fmt::format("{} stickers on a {} person; {} vertices, {} triangles", named.size(),
                    name_of(person.position), person.skin_in_couch.vertices.size(),
                    person.skin_in_couch.triangles.size());
    for (const auto& [name, sticker] : named) {
      const Vector3& at = sticker.at_in_couch;
      points[name] = {{"colour", scanner::name_of(sticker.colour)},
                      {"position_m", {at.x(), at.y(), at.z()}},
                      {"dots", sticker.dots},
                      {"spread_mm", to_mm(sticker.spread_m)}};
      text += fmt::format("\n  {:<24} {:<8} x {:7.1f}  y {:7.1f}  z {:7.1f} mm, {} laser dots",
                          name, scanner::name_of(sticker.colour), to_mm(at.x()), to_mm(at.y()),
                          to_mm(at.z()), sticker.dots);
    }
    if (seen > named.size()) {
      text += fmt::format("\n{} stickers of colours that --labels does not name are left alone",
                          seen - named.size());
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
    return tl::unexpected(Error{error.fault, fmt::format("{}: {}", sweep_, error.message)});
  }

  std::string sweep_;
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
