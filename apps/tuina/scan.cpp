// SPDX-License-Identifier: Apache-2.0
#include <charconv>
#include <cmath>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>

#include "apps/simulated/ros2_option.hpp"
#include "apps/simulated/session_order.hpp"
#include "apps/tuina/atlas/sticker_words.hpp"
#include "apps/tuina/scan_device.hpp"
#include "apps/tuina/verbs.hpp"
#include "tuina/core/io/surface_file.hpp"
#include "tuina/core/io/text_lines.hpp"
#include "tuina/core/units.hpp"
#include "tuina/record/session_channels.hpp"
#include "tuina/scanner/check/check_box.hpp"
#include "tuina/scanner/check/check_sphere.hpp"
#include "tuina/scanner/recording.hpp"
#include "tuina/scanner/sweep.hpp"
#include "tuina/session/config.hpp"
#include "tuina/session/scan_step.hpp"
#include "tuina/sim/person/person.hpp"
#include "tuina/sim/scanner/laser_scanner.hpp"

namespace tuina::app {
namespace {

namespace fs = std::filesystem;

// "150x150x200mm" or "150x150x200", millimetres in both cases.
Result<Vector3> box_size(const std::string& text) {
  Vector3 size_m = Vector3::Zero();
  std::string_view rest = text;
  if (rest.ends_with("mm")) rest.remove_suffix(2);
  bool good = true;
  for (Eigen::Index k = 0; good && k < 3; ++k) {
    const std::size_t cross = k < 2 ? rest.find('x') : rest.size();
    const auto edge_mm = to_number<double>(rest.substr(0, cross));
    good = cross != std::string_view::npos && edge_mm && *edge_mm >= 20.0 && *edge_mm <= 1000.0;
    if (!good) break;
    size_m(k) = from_mm(*edge_mm);
    rest.remove_prefix(std::min(rest.size(), cross + 1));
  }
  if (!good) {
    return fail(Fault::usage,
                "--check-box {}: three edges from 20 to 1000 mm are needed, as 150x150x200mm",
                text);
  }
  return size_m;
}

nlohmann::json json_of(const scanner::FoundBox& box) {
  nlohmann::json json{{"flatness_mm", to_mm(box.flatness_m)},
                      {"border_mm", to_mm(box.border_m)},
                      {"points", box.points}};
  for (const double edge_m : box.edges_m) json["edges_mm"].push_back(to_mm(edge_m));
  for (const double angle_rad : box.angles_rad) json["angles_deg"].push_back(to_deg(angle_rad));
  return json;
}

/// One sweep of a simulated, recorded or real scanner to a cloud.
class ScanVerb final : public Verb {
 public:
  [[nodiscard]] const char* name() const override { return "scan"; }
  [[nodiscard]] const char* summary() const override { return "one sweep to a cloud in couch"; }
  [[nodiscard]] const char* example() const override {
    return "tuina scan --person phantom:medium --record sweep --out scan.ply\n"
           "  tuina scan --replay sweep --out scan.ply\n"
           "  tuina scan --device device.toml --calibration calibration.toml --out scan.ply";
  }

  void describe(Options& options) override {
    auto person = options.add("--person", person_,
                              "scan a simulated person: a labelled body FILE.ply, or phantom:slim, "
                              "phantom:medium, phantom:hefty");
    auto replay = options.add("--replay", replay_, "a recorded sweep (a folder)").excludes(person);
    options
        .add("--device", device_,
             "a real scanner: the file that names its camera and its turntable "
             "(docs/build_a_scanner.md)")
        .excludes(person)
        .excludes(replay);
    options.add("--camera", camera_, "a real one, /dev/video0; with --turntable, without --device");
    options.add("--turntable", turntable_, "the board of a real one, /dev/ttyACM0");
    auto stop_and_shoot =
        options
            .flag("--stop-and-shoot", stop_and_shoot_,
                  "stand still for every frame, in steps of 0.29 degrees, as the thesis did")
            .excludes(replay);
    auto position =
        options.add("--position", position_, "sitting or prone; a labelled body knows its own")
            .one_of({"sitting", "prone"})
            .excludes(replay);
    options
        .add("--breathing-mm", breathing_mm_,
             "how far the back moves with the breath; 0: it is held")
        .between(0.0, 50.0)
        .excludes(replay)
        .show_default();
    options
        .add("--method", method_,
             "laser line: centroid, likelihood or thesis; else from the config")
        .one_of({"centroid", "likelihood", "thesis"});
    options
        .flag("--both-ways", both_ways_,
              "turn forth and back: finds the latency again, and takes the breath off")
        .excludes(replay)
        .excludes(stop_and_shoot);
    options.add("--calibration", calibration_, "instead of the scanner's own calibration.toml");
    options
        .add("--check-sphere", check_sphere_mm_,
             "a ball of this diameter in mm is in the scene; refuse a scan that shows it "
             "hollow or of another size")
        .between(20.0, 1000.0);
    options.add(
        "--check-box", check_box_,
        "a box of this size, as 150x150x200mm, is in the scene, two or three faces in view; refuse "
        "a scan that shows it of another size or askew");
    auto record =
        options.add("--record", record_, "keep the sweep in this new folder").excludes(replay);
    options
        .add("--stickers", stickers_,
             "coloured stickers on true points of the simulated person, frames in colour: "
             "magenta=SI11,BL47,BL50 yellow=GV4; see `tuina atlas record --help`")
        .excludes(replay)
        .needs(record);
    options.add("--out", out_, "the cloud; as PCD when the name ends so, else as PLY");
    options.add("--format", format_, "of --out, when its name does not tell")
        .one_of({"ply", "ply-ascii", "ply-big-endian", "pcd", "pcd-ascii"});
    (void)position;
    ros2_.describe(options, "/profile, line by line, and /scan");
  }

  [[nodiscard]] Result<Answer> run(const CommonOptions& common) override {
    const bool real = !device_.empty() || !camera_.empty() || !turntable_.empty();
    if ((person_.empty() ? 0 : 1) + (replay_.empty() ? 0 : 1) + (real ? 1 : 0) != 1) {
      return fail(Fault::usage,
                  "scan needs one of --person (a simulated one), --replay (a recorded sweep) and "
                  "--device, or --camera with --turntable (a real scanner)");
    }
    if (real && stop_and_shoot_) {
      return fail(
          Fault::usage,
          "--stop-and-shoot needs a camera that waits for the unit; a real one runs freely, "
          "so leave it out");
    }
    const auto config = effective_config(common);
    if (!config) return tl::unexpected(config.error());
    if (const auto good = check_folder_of(out_); !good) return tl::unexpected(good.error());
    if (!check_box_.empty()) {
      const auto size_m = box_size(check_box_);
      if (!size_m) return tl::unexpected(size_m.error());
      box_size_m_ = *size_m;
    }
    if (const auto begun = ros2_.begin(); !begun) return tl::unexpected(begun.error());
    if (ros2_.node() != nullptr) told_.emplace(*ros2_.node());
    std::optional<scanner::ScannerCalibration> calibration;
    if (!calibration_.empty()) {
      const auto read = scanner::read_calibration(calibration_);
      if (!read) return tl::unexpected(read.error());
      calibration = *read;
    }
    auto options = session::sweep_options(*config);
    if (const auto method = scanner::line_method(method_)) options.method = *method;
    options.both_ways = both_ways_;
    if (stop_and_shoot_) options.step_rad = from_deg(300.0 / 1024.0);
    if (told_) options.on_profile = [this](const auto& profile) { told_->tell(profile); };
    if (real) return scan_with_devices(common, calibration, options);
    return replay_.empty() ? simulate(common, *config, calibration, options)
                           : replay(common, calibration, options);
  }

 private:
  [[nodiscard]] Result<std::vector<sim::SkinSticker>> stickers_on(const sim::Person& person) const {
    std::map<std::string, Vector3> places;
    for (const auto& point : person.acupoints) places[point.name] = point.at_in_couch;
    for (const auto& landmark : person.landmarks) places[landmark.name] = landmark.at_in_couch;
    std::vector<std::string> names;
    for (const auto& [name, place] : places) names.push_back(name);
    const auto groups = parse_stickers(stickers_, names, "--stickers");
    if (!groups) return tl::unexpected(groups.error());
    std::vector<sim::SkinSticker> stickers;
    for (const StickerGroup& group : *groups) {
      for (const auto& level : group.levels) {
        for (const auto& point : level) {
          stickers.push_back({.at_in_couch = places.at(point), .colour = group.colour});
        }
      }
    }
    return stickers;
  }

  Result<Answer> simulate(const CommonOptions& common, const session::Config& config,
                          const std::optional<scanner::ScannerCalibration>& given,
                          const scanner::SweepOptions& options) {
    std::optional<BodyPosture> position;
    if (!position_.empty())
      position = position_ == "prone" ? BodyPosture::prone : BodyPosture::sitting;
    const auto person = sim::parse_person(person_, position, common.seed);
    if (!person) return tl::unexpected(person.error());
    const sim::Breathing breathing{.amplitude_m = from_mm(breathing_mm_),
                                   .frequency_hz = config.simulation.breathing_hz};
    const auto stickers = stickers_on(*person);
    if (!stickers) return tl::unexpected(stickers.error());
    sim::LaserScanner simulated(person->skin_in_couch, person->position, breathing, common.seed,
                                {.room_light_dn = config.simulation.room_light_dn,
                                 .stickers = *stickers,
                                 .flaws = scan_flaws(config)});
    const auto calibration =
        given ? *given : sim::believed_calibration(simulated.true_calibration(), common.seed);

    const auto bar = progress_bar(common, "scan");
    const auto scan = sweep(simulated, simulated, calibration, options, bar);
    if (!scan) return tl::unexpected(scan.error());
    const auto truth = sim::compare_with_truth(scan->cloud_in_couch, person->skin_in_couch);
    return answer(*scan, truth);
  }

  // One scan, which is kept where it is to be recorded.
  Result<scanner::Scan> sweep(scanner::Camera& camera, scanner::Turntable& turntable,
                              const scanner::ScannerCalibration& calibration,
                              const scanner::SweepOptions& options, const Progress& bar) const {
    if (record_.empty()) return scanner::scan_sweep(camera, turntable, calibration, options, bar);
    auto recorder = scanner::Recorder::open(camera, turntable, record_);
    if (!recorder) return tl::unexpected(recorder.error());
    auto scan = scanner::scan_sweep(*recorder, *recorder, calibration, options, bar);
    if (!scan) return scan;
    if (const auto kept = recorder->finish(calibration); !kept) return tl::unexpected(kept.error());
    return scan;
  }

  Result<Answer> scan_with_devices(const CommonOptions& common,
                                   const std::optional<scanner::ScannerCalibration>& calibration,
                                   const scanner::SweepOptions& options) {
    if (!calibration) {
      return fail(Fault::usage,
                  "a real scanner needs --calibration FILE.toml, which `tuina calibrate` makes");
    }
    const auto devices = scanner_devices(device_, camera_, turntable_);
    if (!devices) return tl::unexpected(devices.error());
    const auto scanner = open_scanner(*devices, calibration->camera);
    if (!scanner) return tl::unexpected(scanner.error());
    const auto scan = sweep(*scanner->camera, *scanner->turntable, *calibration, options,
                            progress_bar(common, "scan"));
    if (scan) return answer(*scan, {});
    const Error& error = scan.error();
    // What is judged over both devices names neither.
    return error.message.starts_with('/')
               ? tl::unexpected(error)
               : fail(error.fault, "{}: {}", scanner->called, error.message);
  }

  Result<Answer> replay(const CommonOptions& common,
                        const std::optional<scanner::ScannerCalibration>& given,
                        scanner::SweepOptions options) {
    auto recording = scanner::Recording::open(replay_);
    if (!recording) return tl::unexpected(recording.error());
    options.expected_frames = recording->frames();
    const auto calibration = given ? *given : recording->calibration();
    const auto scan = scanner::scan_sweep(*recording, *recording, calibration, options,
                                          progress_bar(common, "replay"));
    if (!scan) {
      return tl::unexpected(
          Error{scan.error().fault, fmt::format("{}: {}", replay_, scan.error().message)});
    }
    return answer(*scan, {});
  }

  Result<Answer> answer(const scanner::Scan& scan, const std::optional<sim::ScanTruth>& truth) {
    std::optional<scanner::FoundSphere> ball;
    if (check_sphere_mm_ > 0.0) {
      const auto checked = scanner::check_sphere(scan.cloud_in_couch, from_mm(check_sphere_mm_));
      if (!checked) return tl::unexpected(checked.error());
      ball = *checked;
    }
    std::optional<scanner::FoundBox> box;
    if (!check_box_.empty()) {
      const auto checked = scanner::check_box(scan.cloud_in_couch, box_size_m_);
      if (!checked) return tl::unexpected(checked.error());
      box = *checked;
    }
    if (!out_.empty()) {
      const bool pcd = format_.empty() && fs::path(out_).extension() == ".pcd";
      const auto format = cloud_format(pcd ? "pcd" : format_).value_or(CloudFormat::ply_binary);
      const auto written = write_cloud(out_, scan.cloud_in_couch, format);
      if (!written) return tl::unexpected(written.error());
    }
    nlohmann::json json{{"profiles", scan.profiles},
                        {"points", scan.cloud_in_couch.size()},
                        {"rows_lit", scan.rows_lit},
                        {"ambiguous_rows", scan.ambiguous_rows},
                        {"sweep_s", scan.sweep_s},
                        {"compute_ms", scan.compute_ms},
                        {"expected_error_mm", to_mm(scan.expected_error_m)},
                        {"rms_error_mm", nullptr}};
    std::string text = fmt::format(
        "{} profiles, {} points in {:.1f} s of sweep and {:.0f} ms of computing; "
        "expected error {:.2f} mm RMS",
        scan.profiles, scan.cloud_in_couch.size(), scan.sweep_s, scan.compute_ms,
        to_mm(scan.expected_error_m));
    if (scan.ways) {
      const scanner::WaysCompared& ways = *scan.ways;
      json["both_ways"] = {{"latency_error_ms", 1e3 * ways.latency_error_s},
                           {"latency_deviation_ms", 1e3 * ways.latency_deviation_s},
                           {"breath_mm", to_mm(ways.breath_m)},
                           {"breath_hz", ways.breath_hz},
                           {"disagreement_mm", to_mm(ways.disagreement_m)},
                           {"remaining_mm", to_mm(ways.remaining_m)}};
      if (ways.breath_m > 0.0) {
        text += fmt::format(", breath of {:.1f} mm at {:.2f} Hz taken off", to_mm(ways.breath_m),
                            ways.breath_hz);
      }
      constexpr double agreed_s = 5e-3;
      if (std::abs(ways.latency_error_s) > agreed_s) {
        text += fmt::format(
            ", the latency is {:.0f} ms {} than the calibration says (taken off; calibrate again)",
            1e3 * std::abs(ways.latency_error_s), ways.latency_error_s > 0.0 ? "more" : "less");
      }
    }
    if (truth) {
      json["rms_error_mm"] = to_mm(truth->rms_error_m);
      json["mean_error_mm"] = to_mm(truth->mean_error_m);
      json["worst_error_mm"] = to_mm(truth->worst_error_m);
      text += fmt::format(", true error {:.2f} mm", to_mm(truth->rms_error_m));
    }
    if (ball) {
      json["sphere"] = {{"diameter_mm", to_mm(ball->diameter_m)},
                        {"rms_mm", to_mm(ball->rms_m)},
                        {"points", ball->points}};
      text += fmt::format("; the ball of {} mm measures {:.2f} mm", check_sphere_mm_,
                          to_mm(ball->diameter_m));
    }
    if (box) {
      json["box"] = json_of(*box);
      text += fmt::format("; the box of {} measures {:.1f} x {:.1f} x {:.1f} mm", check_box_,
                          to_mm(box->edges_m[0]), to_mm(box->edges_m[1]), to_mm(box->edges_m[2]));
    }
    if (told_) {
      told_->tell(scan);
      text += "\n" + ros2_.text();
    }
    return Answer{.json = json.dump(2), .text = text};
  }

  Ros2Option ros2_;
  std::optional<record::ScanChannels> told_;
  std::string person_;
  std::string replay_;
  std::string device_;
  std::string camera_;
  std::string turntable_;
  std::string position_;
  double breathing_mm_ = 0.0;
  bool both_ways_ = false;
  bool stop_and_shoot_ = false;
  std::string format_;
  double check_sphere_mm_ = 0.0;
  std::string check_box_;
  Vector3 box_size_m_ = Vector3::Zero();
  std::string method_;
  std::string calibration_;
  std::string record_;
  std::vector<std::string> stickers_;
  std::string out_;
};

}  // namespace

std::unique_ptr<Verb> make_scan() {
  return std::make_unique<ScanVerb>();
}

}  // namespace tuina::app
