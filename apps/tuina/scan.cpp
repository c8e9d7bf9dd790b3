// SPDX-License-Identifier: Apache-2.0
#include <cctype>
#include <cmath>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>

#include "apps/cli/mark_words.hpp"
#include "apps/cli/position_option.hpp"
#include "apps/simulated/ros2_option.hpp"
#include "apps/simulated/session_order.hpp"
#include "apps/tuina/known_bodies.hpp"
#include "apps/tuina/scan_device.hpp"
#include "apps/tuina/verbs.hpp"
#include "tuina/core/io/surface_file.hpp"
#include "tuina/core/units.hpp"
#include "tuina/record/session_channels.hpp"
#include "tuina/scanner/recording.hpp"
#include "tuina/scanner/sweep.hpp"
#include "tuina/session/config.hpp"
#include "tuina/session/scan_step.hpp"
#include "tuina/sim/person/person.hpp"
#include "tuina/sim/scanner/laser_scanner.hpp"

namespace tuina::app {
namespace {

namespace fs = std::filesystem;

nlohmann::json json_of(const scanner::Scan& scan) {
  nlohmann::json json{{"profiles", scan.profiles},
                      {"points", scan.cloud_in_couch.size()},
                      {"rows_lit", scan.rows_lit},
                      {"ambiguous_rows", scan.ambiguous_rows},
                      {"sweep_s", scan.sweep_s},
                      {"compute_ms", scan.compute_ms},
                      {"expected_error_mm", to_mm(scan.expected_error_m)},
                      {"rms_error_mm", nullptr}};
  if (scan.ways) {
    const scanner::WaysCompared& ways = *scan.ways;
    json["both_ways"] = {{"latency_error_ms", 1e3 * ways.latency_error_s},
                         {"latency_deviation_ms", 1e3 * ways.latency_deviation_s},
                         {"breath_mm", to_mm(ways.breath_m)},
                         {"breath_hz", ways.breath_hz},
                         {"disagreement_mm", to_mm(ways.disagreement_m)},
                         {"remaining_mm", to_mm(ways.remaining_m)}};
  }
  return json;
}

std::string text_of(const scanner::Scan& scan) {
  std::string text = fmt::format(
      "{} profiles, {} points in {:.1f} s of sweep and {:.0f} ms of computing; "
      "expected error {:.2f} mm RMS",
      scan.profiles, scan.cloud_in_couch.size(), scan.sweep_s, scan.compute_ms,
      to_mm(scan.expected_error_m));
  if (!scan.ways) return text;
  const scanner::WaysCompared& ways = *scan.ways;
  if (ways.breath_m > 0.0)
    text += fmt::format(", breath of {:.1f} mm at {:.2f} Hz taken off", to_mm(ways.breath_m),
                        ways.breath_hz);
  constexpr double agreed_s = 5e-3;
  if (std::abs(ways.latency_error_s) > agreed_s)
    text += fmt::format(
        ", the latency is {:.0f} ms {} than the calibration says (taken off; calibrate again)",
        1e3 * std::abs(ways.latency_error_s), ways.latency_error_s > 0.0 ? "more" : "less");
  return text;
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
    known_bodies_.describe(options);
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
    ros2_.describe(options, "/profile, line by line, and /scan");
  }

  [[nodiscard]] Result<Answer> run(const CommonOptions& common) override {
    const bool real = !device_.empty() || !camera_.empty() || !turntable_.empty();
    if ((person_.empty() ? 0 : 1) + (replay_.empty() ? 0 : 1) + (real ? 1 : 0) != 1)
      return fail(Fault::usage,
                  "scan needs one of --person (a simulated one), --replay (a recorded sweep) and "
                  "--device, or --camera with --turntable (a real scanner)");
    if (real && stop_and_shoot_)
      return fail(Fault::usage,
                  "--stop-and-shoot needs a camera that waits for the unit; a real one does not");
    const auto config = effective_config(common);
    if (!config) return tl::unexpected(config.error());
    if (const auto good = check_folder_of(out_); !good) return tl::unexpected(good.error());
    std::string ending = fs::path(out_).extension();
    for (char& letter : ending) letter = static_cast<char>(std::tolower(letter));
    if (!format_.empty() && (ending == ".ply" || ending == ".pcd") &&
        !format_.starts_with(ending.substr(1)))
      return fail(Fault::usage, "--format {}: the name of --out {} says otherwise", format_, out_);
    if (format_.empty() && ending == ".pcd") format_ = "pcd";
    if (const auto good = known_bodies_.begin(); !good) return tl::unexpected(good.error());
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
    names.reserve(places.size());
    for (const auto& [name, place] : places) names.push_back(name);
    const auto groups = parse_marks(stickers_, sticker_kinds(), names, "--stickers");
    if (!groups) return tl::unexpected(groups.error());
    std::vector<sim::SkinSticker> stickers;
    for (const MarkGroup& group : *groups) {
      for (const auto& level : group.levels)
        for (const auto& point : level)
          stickers.push_back({places.at(point), *scanner::sticker_colour(group.kind)});
    }
    return stickers;
  }

  Result<Answer> simulate(const CommonOptions& common, const session::Config& config,
                          const std::optional<scanner::ScannerCalibration>& given,
                          const scanner::SweepOptions& options) {
    const auto person = sim::parse_person(person_, posture_of(position_), common.seed);
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
    if (!calibration)
      return fail(Fault::usage,
                  "a real scanner needs --calibration FILE.toml, which `tuina calibrate` makes");
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
    if (!scan) return fail(scan.error().fault, "{}: {}", replay_, scan.error().message);
    return answer(*scan, {});
  }

  Result<Answer> answer(const scanner::Scan& scan, const std::optional<sim::ScanTruth>& truth) {
    nlohmann::json json = json_of(scan);
    std::string text = text_of(scan);
    if (truth) {
      json["rms_error_mm"] = to_mm(truth->rms_error_m);
      json["mean_error_mm"] = to_mm(truth->mean_error_m);
      json["worst_error_mm"] = to_mm(truth->worst_error_m);
      text += fmt::format(", true error {:.2f} mm", to_mm(truth->rms_error_m));
    }
    if (const auto good = known_bodies_.check(scan.cloud_in_couch, json, text); !good)
      return tl::unexpected(good.error());
    if (!out_.empty()) {
      const auto format = cloud_format(format_).value_or(CloudFormat::ply_binary);
      const auto written = write_cloud(out_, scan.cloud_in_couch, format);
      if (!written) return tl::unexpected(written.error());
    }
    if (told_) {
      told_->tell(scan);
      text += "\n" + ros2_.text();
    }
    return Answer{.json = json.dump(2), .text = text};
  }

  Ros2Option ros2_;
  std::optional<record::ScanChannels> told_;
  std::string person_, replay_, device_, camera_, turntable_, position_;
  double breathing_mm_ = 0.0;
  bool both_ways_ = false, stop_and_shoot_ = false;
  std::string method_, calibration_;
  KnownBodies known_bodies_;
  std::string record_;
  std::vector<std::string> stickers_;
  std::string out_, format_;
};

}  // namespace

std::unique_ptr<Verb> make_scan() {
  return std::make_unique<ScanVerb>();
}

}  // namespace tuina::app
