// SPDX-License-Identifier: Apache-2.0
#include "tuina/scanner/recording.hpp"
#include "tests/fake_scanner.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>

#include "tests/folder.hpp"
#include "tuina/core/io/file.hpp"
#include "tuina/core/io/png.hpp"
#include "tuina/core/random.hpp"
#include "tuina/core/units.hpp"
#include "tuina/scanner/sweep.hpp"

using namespace tuina;
using namespace tuina::scanner;
using tuina::test::Folder;
namespace fs = std::filesystem;

namespace {

using Little = tests::FakeScanner;
constexpr int frames_of_a_sweep = Little::frames_of_a_sweep;
ScannerCalibration little_calibration() {
  return tests::calibration_of_fake();
}

void record_into(const fs::path& folder) {
  Little little;
  auto recorder = Recorder::open(little, little, folder);
  REQUIRE(recorder.has_value());
  REQUIRE(recorder->sweep(0.0, 1.0, 1.0).has_value());
  REQUIRE(recorder->switch_laser(true).has_value());
  while (recorder->arrived() == false) REQUIRE(recorder->next_frame(frame_timeout_s).has_value());
  REQUIRE(recorder->finish(little_calibration()).has_value());
}

void put(const fs::path& path, const std::string& text) {
  REQUIRE(write_file(path, text).has_value());
}

void replace(const fs::path& path, const std::string& from, const std::string& to) {
  std::string text = read_file(path).value();
  const auto at = text.find(from);
  REQUIRE(at != std::string::npos);
  put(path, text.replace(at, from.size(), to));
}

Image to_bytes(const PngFile& png) {
  Image image(png.image.width, png.image.height);
  for (std::size_t i = 0; i < image.data.size(); ++i) {
    image.data[i] = static_cast<std::uint8_t>(png.image.data[i]);
  }
  return image;
}

}  // namespace

TEST_CASE("a replay sees what was recorded, bit for bit, and makes the same cloud") {
  const Folder folder;
  record_into(folder.path() / "sweep");
  Little little;
  const SweepOptions options{.near_m = 0.3};
  const auto live = scan_sweep(little, little, little_calibration(), options);
  REQUIRE(live.has_value());
  auto recording = Recording::open(folder.path() / "sweep");
  REQUIRE(recording.has_value());
  CHECK(recording->frames() == frames_of_a_sweep);
  const auto replayed = scan_sweep(*recording, *recording, recording->calibration(), options);
  REQUIRE(replayed.has_value());
  CHECK(live->cloud_in_couch.size() > 500);
  CHECK(live->cloud_in_couch.points == replayed->cloud_in_couch.points);
  CHECK(live->cloud_in_couch.normals == replayed->cloud_in_couch.normals);
  CHECK(live->cloud_in_couch.deviation_m == replayed->cloud_in_couch.deviation_m);
  CHECK(live->expected_error_m == replayed->expected_error_m);
  CHECK_FALSE(fs::exists(folder.path() / "sweep.part"));
}

TEST_CASE("what goes wrong with a recording leaves nothing behind") {
  const Folder folder;
  Little little;
  {
    auto recorder = Recorder::open(little, little, folder.path() / "sweep");
    REQUIRE(recorder.has_value());
    REQUIRE(recorder->next_frame(frame_timeout_s).has_value());
  }
  CHECK(fs::is_empty(folder.path()));
  record_into(folder.path() / "sweep");
  CHECK_FALSE(Recorder::open(little, little, folder.path() / "sweep").has_value());
  CHECK_FALSE(Recorder::open(little, little, "/proc/nowhere/sweep").has_value());
}

TEST_CASE(
    "a sweep that was begun is nobody else's: neither one that is written, nor what is left") {
  const Folder folder;
  Little little;
  const fs::path sweep = folder.path() / "sweep", part = folder.path() / "sweep.part";
  const auto refused = [&](const std::string& why) {
    const auto second = Recorder::open(little, little, sweep);
    REQUIRE_FALSE(second.has_value());
    CAPTURE(second.error().message);
    CHECK(second.error().message.find(why) != std::string::npos);
  };
  {
    auto first = Recorder::open(little, little, sweep);
    REQUIRE(first.has_value());
    REQUIRE(first->next_frame(frame_timeout_s).has_value());
    refused("sweep: another program is writing it");
    CHECK(fs::exists(part / "frames/000000.png"));
    // What cannot come to its place stays.
    fs::create_directory(sweep);
    std::ofstream(sweep / "notes.txt") << "mine";
    CHECK_FALSE(first->finish(little_calibration()).has_value());
  }
  fs::remove_all(sweep);
  refused("sweep.part: is there already");
  CHECK(fs::exists(part / "frames/000000.png"));
  CHECK(fs::exists(part / "frames.csv"));
}

TEST_CASE("colour frames give their red, dark frames are taken off, sixteen bits are rounded") {
  const Folder folder;
  const fs::path sweep = folder.path() / "sweep";
  record_into(sweep);
  Image colour(96, 72, 3);
  for (std::size_t i = 0; i < colour.data.size(); i += 3) colour.data[i] = 77;
  put(sweep / "frames" / "000000.png", to_png(colour));
  fs::create_directory(sweep / "dark");
  put(sweep / "dark" / "1.png", to_png(Image(96, 72)));
  auto recording = Recording::open(sweep);
  REQUIRE(recording.has_value());
  const auto first = recording->next_frame(frame_timeout_s);
  REQUIRE(first.has_value());
  CHECK(first->image.channels == 1);
  CHECK(first->image.data.front() == 77);
  CHECK(first->dark.data.empty());
  CHECK(recording->next_frame(frame_timeout_s)->dark.data.size() == 96 * 72);
}

TEST_CASE("every broken recording is refused with its cause") {
  struct Damage {
    const char* said;
    std::function<void(const fs::path&)> make;
  };
  const Damage damages[] = {
      {"calibration.toml", [](const fs::path& s) { fs::remove(s / "calibration.toml"); }},
      {"camera.fx_px",
       [](const fs::path& s) { replace(s / "calibration.toml", "fx_px = 150.0", "fx_px = nan"); }},
      {"frames.csv", [](const fs::path& s) { fs::remove(s / "frames.csv"); }},
      {"yaw.csv", [](const fs::path& s) { fs::remove(s / "yaw.csv"); }},
      {"frames", [](const fs::path& s) { fs::remove_all(s / "frames"); }},
      {"frame 3 has no picture",
       [](const fs::path& s) { fs::remove(s / "frames" / "000003.png"); }},
      {"does not list it",
       [](const fs::path& s) {
         fs::copy(s / "frames" / "000003.png", s / "frames" / "000099.png");
       }},
      {"second picture",
       [](const fs::path& s) { fs::copy(s / "frames" / "000003.png", s / "frames" / "3.png"); }},
      {"frame number",
       [](const fs::path& s) { fs::copy(s / "frames" / "000003.png", s / "frames" / "a.png"); }},
      {"listed twice", [](const fs::path& s) { replace(s / "frames.csv", "\n5,", "\n4,"); }},
      {"out of order", [](const fs::path& s) { replace(s / "frames.csv", "\n5,0.1", "\n5,0.0"); }},
      {"not a whole number",
       [](const fs::path& s) { replace(s / "frames.csv", "\n5,", "\n5.5,"); }},
      {"frames.csv", [](const fs::path& s) { replace(s / "frames.csv", "\n5,", "\nfive,"); }},
      {"frames.csv:2: no row", [](const fs::path& s) { put(s / "frames.csv", "frame,time_s\n"); }},
      {"no frame 70",
       [](const fs::path& s) {
         fs::create_directory(s / "dark");
         fs::copy(s / "frames" / "000003.png", s / "dark" / "000070.png");
       }},
      {"outside the yaw readings",
       [](const fs::path& s) { put(s / "yaw.csv", "time_s,yaw_deg\n5,0\n6,1\n"); }},
      {"yaw.csv:2: no row", [](const fs::path& s) { put(s / "yaw.csv", "time_s,yaw_deg\n"); }},
      {"yaw.csv", [](const fs::path& s) { put(s / "yaw.csv", "time_s,angle\n0,0\n1,1\n"); }},
      {"stalled",
       [](const fs::path& s) { put(s / "yaw.csv", "time_s,yaw_deg\n-1,3\n0,3\n2,3\n"); }},
      {"not a PNG", [](const fs::path& s) { put(s / "frames" / "000007.png", "hello"); }},
      {"000007.png",
       [](const fs::path& s) {
         const std::string whole = read_file(s / "frames" / "000007.png").value();
         put(s / "frames" / "000007.png", whole.substr(0, whole.size() / 2));
       }},
      {"does not belong to a calibration",
       [](const fs::path& s) { put(s / "frames" / "000007.png", to_png(Image(64, 48))); }},
      {"repeat the one before",
       [](const fs::path& s) {
         for (int i = 8; i < 14; ++i) {
           fs::copy_file(s / "frames" / "000007.png", s / "frames" / fmt::format("{:06}.png", i),
                         fs::copy_options::overwrite_existing);
         }
       }},
      {"frames are cut",
       [](const fs::path& s) {
         for (int i = 8; i < 14; ++i) {
           const fs::path path = s / "frames" / fmt::format("{:06}.png", i);
           Image image = to_bytes(read_png(path).value());
           std::fill(image.row(40), image.row(71) + 96, std::uint8_t{128});
           put(path, to_png(image));
         }
       }},
      {"a laser line is seen in 0 of 24 frames",
       [](const fs::path& s) {
         for (int i = 0; i < frames_of_a_sweep; ++i) {
           put(s / "frames" / fmt::format("{:06}.png", i), to_png(Image(96, 72)));
         }
       }},
  };
  for (const Damage& damage : damages) {
    const Folder folder;
    const fs::path sweep = folder.path() / "sweep";
    record_into(sweep);
    damage.make(sweep);
    std::string message = "nothing was refused";
    auto recording = Recording::open(sweep);
    if (!recording) {
      message = recording.error().message;
    } else {
      const auto scan = scan_sweep(*recording, *recording, recording->calibration(),
                                   {.near_m = 0.3, .expected_frames = recording->frames()});
      if (!scan) message = scan.error().message;
    }
    CAPTURE(damage.said);
    CHECK_MESSAGE(message.find(damage.said) != std::string::npos, message);
  }
  CHECK(Recording::open("/nowhere").error().fault == Fault::file);
}
