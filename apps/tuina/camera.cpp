// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <nlohmann/json.hpp>
#include <optional>

#include "apps/cli/asked_to_end.hpp"
#include "apps/serve/live_picture.hpp"
#include "apps/tuina/line_picture.hpp"
#include "apps/tuina/scan_device.hpp"
#include "apps/tuina/verbs.hpp"
#include "tuina/core/io/file.hpp"
#include "tuina/core/io/png.hpp"
#include "tuina/core/units.hpp"

namespace tuina::app {
namespace {

using nlohmann::ordered_json;

// Half of the rows of a person's back are lit; a line of 1 to 4 pixels is found best, and where it
// clips its middle is lost (docs/scanner.md).
constexpr double min_lit_share = 0.3;
constexpr double min_width_px = 0.8, max_width_px = 4.0;
constexpr double min_amplitude_dn = 60.0;
constexpr double max_clipped_share = 0.2;
constexpr double max_background_dn = 80.0;

struct Seen {
  scanner::LaserLine line;
  double lit_share = 0.0;
  double amplitude_dn = 0.0;   // median over the lit rows
  double clipped_share = 0.0;  // of the lit rows
  double background_dn = 0.0;  // median of the picture
};

Seen look_at(const Image& picture) {
  Seen seen{.line = scanner::find_laser_line(picture, {.method = scanner::LineMethod::likelihood})};
  std::vector<std::uint8_t> all = picture.data;
  std::nth_element(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(all.size() / 2),
                   all.end());
  seen.background_dn = all[all.size() / 2];
  const auto& points = seen.line.points;
  if (points.empty()) return seen;
  std::vector<float> amplitudes;
  int clipped = 0;
  for (const scanner::LinePoint& point : points) {
    amplitudes.push_back(point.amplitude_dn);
    const std::uint8_t* row = picture.row(point.row);
    clipped += *std::max_element(row, row + picture.width) == 255 ? 1 : 0;
  }
  std::sort(amplitudes.begin(), amplitudes.end());
  seen.lit_share = static_cast<double>(points.size()) / picture.height;
  seen.amplitude_dn = static_cast<double>(amplitudes[amplitudes.size() / 2]);
  seen.clipped_share = static_cast<double>(clipped) / static_cast<double>(points.size());
  return seen;
}

std::vector<std::string> verdict_of(const Seen& seen) {
  std::vector<std::string> verdict;
  if (seen.background_dn > max_background_dn)
    verdict.emplace_back("the room is too bright: less light, or a shorter exposure");
  if (seen.lit_share < min_lit_share)
    return verdict.emplace_back(
               "hardly any line is seen: is the laser lit, and something before "
               "it?"),
           verdict;
  if (seen.clipped_share > max_clipped_share)
    verdict.emplace_back("the line is clipped: a shorter exposure");
  else if (seen.amplitude_dn < min_amplitude_dn)
    verdict.emplace_back("the line is dark: a longer exposure");
  if (seen.line.width_px > max_width_px)
    verdict.emplace_back("the line is wide: focus laser and camera");
  if (seen.line.width_px < min_width_px)
    verdict.emplace_back("the line is thinner than a pixel: focus a little beside it");
  if (verdict.empty()) verdict.emplace_back("focus and exposure are good");
  return verdict;
}

/// A camera, and the unit that turns it slowly with the laser lit where there is one.
class LitCamera {
 public:
  static Result<LitCamera> open(const hardware::DeviceFile& devices,
                                const hardware::CameraMode& mode) {
    LitCamera lit;
    if (devices.turntable) {
      auto opened = open_turntable(*devices.turntable);
      if (!opened) return tl::unexpected(opened.error());
      lit.turntable_ = std::move(*opened);
    }
    int width_px = mode.width_px, height_px = mode.height_px;
    if (devices.camera->turned_deg % 180 != 0) std::swap(width_px, height_px);
    auto camera = open_camera(*devices.camera, width_px, height_px);
    if (!camera) return tl::unexpected(camera.error());
    lit.camera_ = std::move(*camera);
    if (auto turns = lit.turn(); !turns) return tl::unexpected(turns.error());
    return lit;
  }

  /// The unit turns again where it has arrived: the laser of one that stands goes out.
  Result<Image> next() {
    auto picture = take(scanner::frame_timeout_s);
    if (!picture || !turntable_) return picture;
    const auto arrived = turntable_->arrived();
    if (!arrived) return tl::unexpected(arrived.error());
    if (*arrived)
      if (auto turns = turn(); !turns) return tl::unexpected(turns.error());
    return picture;
  }

 private:
  /// On its way to the beginning of the turn nobody asks for pictures, and the laser is dark.
  Result<void> turn() {
    if (turntable_) {
      constexpr double to_rad = 10.0_deg, rad_per_s = 6.0_deg;
      if (auto dark = turntable_->switch_laser(false); !dark) return dark;
      if (auto turns = turntable_->sweep(-to_rad, to_rad, rad_per_s); !turns) return turns;
      if (auto lit = turntable_->switch_laser(true); !lit) return lit;
    }
    // The first pictures may be older than the light, and a camera needs some to begin.
    constexpr int passed_over = 8;
    constexpr double begin_s = 1.0;
    for (int i = 0; i < passed_over; ++i) {
      const bool begins = i == 0 && !turntable_;
      const auto passed = take(begins ? begin_s : scanner::frame_timeout_s);
      if (!passed) return tl::unexpected(passed.error());
    }
    return {};
  }
  Result<Image> take(double patience_s) {
    auto frame = camera_->next_frame(patience_s);
    if (!frame) return tl::unexpected(frame.error());
    // Who asks keeps the laser lit.
    if (turntable_)
      if (const auto asked = turntable_->arrived(); !asked) return tl::unexpected(asked.error());
    return std::move(frame->image);
  }

  std::unique_ptr<scanner::Camera> camera_;
  std::unique_ptr<scanner::Turntable> turntable_;  // the first to go, and its laser with it
};

/// Says which cameras there are, and what one of them sees.
class CameraVerb final : public Verb {
 public:
  [[nodiscard]] const char* name() const override { return "camera"; }
  [[nodiscard]] const char* summary() const override {
    return "list cameras and their modes; look at the laser line: focus and exposure";
  }
  [[nodiscard]] const char* example() const override {
    return "tuina camera --device device.toml --look seen.png";
  }
  void describe(Options& options) override {
    auto device = options.add("--device", device_,
                              "the camera that this file names; its turntable, if there is one, "
                              "turns a little with the laser lit (docs/build_a_scanner.md)");
    options.add("--camera", camera_, "this one alone, such as /dev/video0; else all")
        .excludes(device);
    auto look = options.add("--look", look_,
                            "take a picture, draw the laser line over it into this PNG file");
    live_
        .describe(options,
                  "show what the camera sees, the line drawn over it, and what to change, in a "
                  "browser until Ctrl-C")
        .excludes(look);
  }

  [[nodiscard]] Result<Answer> run(const CommonOptions&) override {
    hardware::DeviceFile devices;
    if (!device_.empty()) {
      auto read = hardware::read_device_file(device_);
      if (!read) return tl::unexpected(read.error());
      devices = std::move(*read);
      if (!devices.camera) return fail(Fault::config, "{}: [camera] is missing", device_);
    } else if (!camera_.empty()) {
      devices.camera = hardware::CameraDevice{.address = camera_};
    }
    if ((!look_.empty() || live_.asked()) && !devices.camera)
      return fail(Fault::usage, "{} needs --device or --camera",
                  live_.asked() ? "--live" : "--look");
    if (const auto good = check_folder_of(look_); !good) return tl::unexpected(good.error());
    Answer answer;
    ordered_json json = {{"cameras", ordered_json::array()}};
    const auto listed = list(devices, json, answer.text);
    if (!listed) return tl::unexpected(listed.error());
    if (!look_.empty()) {
      const auto looked = look(devices, json, answer.text);
      if (!looked) return tl::unexpected(looked.error());
    }
    if (live_.asked()) {
      const auto shown = show(devices);
      if (!shown) return tl::unexpected(shown.error());
    }
    answer.text.pop_back();
    answer.json = json.dump(2);
    return answer;
  }

 private:
  /// The camera that is named, or all that there are.
  static Result<void> list(const hardware::DeviceFile& devices, ordered_json& json,
                           std::string& text) {
    const bool named = devices.camera.has_value();
    for (const std::string& address :
         named ? std::vector{devices.camera->address} : hardware::video_devices()) {
      const auto found = hardware::list_camera(address);
      if (!found && named) return tl::unexpected(found.error());
      if (!found) continue;  // a camera has devices beside it that give no pictures
      ordered_json all = ordered_json::array();
      text += fmt::format("{}: {}\n", address, found->name);
      for (const hardware::CameraMode& mode : found->modes) {
        all.push_back({{"format", mode.format},
                       {"width_px", mode.width_px},
                       {"height_px", mode.height_px},
                       {"max_frames_per_s", mode.max_frames_per_s}});
        text += fmt::format("  {} {} x {}, {:g} frames per second\n", mode.format, mode.width_px,
                            mode.height_px, mode.max_frames_per_s);
      }
      json["cameras"].push_back({{"address", address}, {"name", found->name}, {"modes", all}});
    }
    if (text.empty()) text = "no camera is found\n";
    return {};
  }

  Result<void> look(const hardware::DeviceFile& devices, ordered_json& json,
                    std::string& text) const {
    const auto mode = picture_mode(*devices.camera);
    if (!mode) return tl::unexpected(mode.error());
    auto camera = LitCamera::open(devices, *mode);
    if (!camera) return tl::unexpected(camera.error());
    const auto picture = camera->next();
    if (!picture) return tl::unexpected(picture.error());
    const Seen seen = look_at(*picture);
    auto written = write_file(look_, to_png(draw_line_over(*picture, 8, seen.line)));
    if (!written) return written;
    const auto verdict = verdict_of(seen);
    json["look"] = {{"picture", look_},
                    {"rows", picture->height},
                    {"lit", seen.line.points.size()},
                    {"width_px", seen.line.width_px},
                    {"amplitude_dn", seen.amplitude_dn},
                    {"clipped_share", seen.clipped_share},
                    {"background_dn", seen.background_dn},
                    {"verdict", verdict}};
    text += fmt::format(
        "{} of {} rows lit, line {:.1f} px wide and {:.0f} DN high, room {:.0f} DN; {}\n",
        seen.line.points.size(), picture->height, seen.line.width_px, seen.amplitude_dn,
        seen.background_dn, fmt::join(verdict, "; "));
    return {};
  }

  Result<void> show(const hardware::DeviceFile& devices) {
    const auto mode = picture_mode(*devices.camera);
    if (!mode) return tl::unexpected(mode.error());
    auto camera = LitCamera::open(devices, *mode);
    if (!camera) return tl::unexpected(camera.error());
    if (auto begun = live_.begin(); !begun) return begun;
    end_when_asked();
    while (!asked_to_end()) {
      const auto picture = camera->next();
      if (!picture) return tl::unexpected(picture.error());
      const Seen seen = look_at(*picture);
      live_.show(draw_line_over(*picture, 8, seen.line),
                 fmt::format("{}", fmt::join(verdict_of(seen), "; ")));
    }
    return {};
  }

  std::string device_;
  std::string camera_;
  LivePicture live_;
  std::string look_;
};

}  // namespace

std::unique_ptr<Verb> make_camera() {
  return std::make_unique<CameraVerb>();
}

}  // namespace tuina::app
