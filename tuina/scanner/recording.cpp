// SPDX-License-Identifier: Apache-2.0
#include "tuina/scanner/recording.hpp"

#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <fstream>
#include <map>
#include <set>
#include <string>
#include <utility>

#include "tuina/core/io/csv.hpp"
#include "tuina/core/io/file.hpp"
#include "tuina/core/io/png.hpp"
#include "tuina/core/io/unfinished_file.hpp"
#include "tuina/core/units.hpp"
#include "tuina/scanner/picture.hpp"
#include "tuina/scanner/sweep.hpp"

namespace tuina::scanner {
namespace {

namespace fs = std::filesystem;

constexpr double degrees_per_count = 300.0 / 1024.0;

// Pictures of a folder by the number in their names.
Result<std::map<long, fs::path>> numbered_pictures(const fs::path& folder) {
  std::map<long, fs::path> pictures;
  std::error_code error;
  for (fs::directory_iterator at(folder, error), end; !error && at != end; at.increment(error)) {
    const fs::path& path = at->path();
    const std::string stem = path.stem().string();
    const bool digits =
        !stem.empty() && stem.size() <= 9 &&
        std::all_of(stem.begin(), stem.end(), [](char c) { return c >= '0' && c <= '9'; });
    if (path.extension() != ".png") continue;
    if (!digits)
      return fail(Fault::bad_input, "{}: its name is not a frame number such as 000012.png",
                  path.string());
    if (!pictures.emplace(std::stol(stem), path).second) {
      return fail(Fault::bad_input, "{}: a second picture with the number {}", path.string(), stem);
    }
  }
  if (error) return fail(Fault::file, "{}: {}", folder.string(), error.message());
  return pictures;
}

std::string picture_name(std::size_t index) {
  return fmt::format("{:06}.png", index);
}

Result<std::vector<YawReading>> read_readings(const fs::path& yaw_csv) {
  const auto yaw = read_csv(yaw_csv, {"time_s", "yaw_deg"});
  if (!yaw) return tl::unexpected(yaw.error());
  std::vector<YawReading> readings;
  for (std::size_t i = 0; i < yaw->rows(); ++i) {
    const double time_s = yaw->columns[0][i];
    const double yaw_deg = yaw->columns[1][i];
    if (!std::isfinite(time_s) || !std::isfinite(yaw_deg)) {
      return fail(Fault::bad_input, "{}:{}: a number is not finite", yaw_csv.string(), i + 2);
    }
    readings.push_back({time_s, from_deg(yaw_deg)});
  }
  return readings;
}

/// Fails for a picture or a dark picture without a row in the table.
Result<void> check_listed(const std::map<long, fs::path>& pictures,
                          const std::map<long, fs::path>& darks, const std::set<long>& listed,
                          const fs::path& frames_csv) {
  for (const auto& [frame, path] : pictures) {
    if (!listed.contains(frame)) {
      return fail(Fault::bad_input, "{}: {} does not list it", path.string(), frames_csv.string());
    }
  }
  for (const auto& [frame, path] : darks) {
    if (!listed.contains(frame)) {
      return fail(Fault::bad_input, "{}: no frame {} belongs to it", path.string(), frame);
    }
  }
  return {};
}

// Pictures come by the clock and cannot wait for the disk; their folder becomes whole as one.
Result<void> keep_picture(const fs::path& path, const Image& picture) {
  const std::string png = to_png(picture);
  std::ofstream file(path, std::ios::binary);
  file.write(png.data(), static_cast<std::streamsize>(png.size()));
  file.close();
  if (file) return {};
  return fail(Fault::file, "{}: cannot be written: {}", path.string(), std::strerror(errno));
}

}  // namespace

Result<Recording> Recording::open(const fs::path& folder, Frames kind) {
  std::error_code error;
  if (!fs::is_directory(folder, error))
    return fail(Fault::file, "{}: there is no such folder", folder.string());
  Recording recording;
  recording.kind_ = kind;
  auto calibration = read_calibration(folder / "calibration.toml");
  if (!calibration) return tl::unexpected(calibration.error());
  recording.calibration_ = *calibration;

  const fs::path frames_csv = folder / "frames.csv";
  const auto frames = read_csv(frames_csv, {"frame", "time_s"});
  if (!frames) return tl::unexpected(frames.error());
  auto pictures = numbered_pictures(folder / "frames");
  if (!pictures) return tl::unexpected(pictures.error());
  std::map<long, fs::path> darks;
  if (fs::exists(folder / "dark", error)) {
    auto found = numbered_pictures(folder / "dark");
    if (!found) return tl::unexpected(found.error());
    darks = std::move(*found);
  }
  if (frames->rows() == 0)
    return fail(Fault::bad_input, "{}: it lists no frame", frames_csv.string());
  std::set<long> listed;
  for (std::size_t i = 0; i < frames->rows(); ++i) {
    const double number = frames->columns[0][i];
    const double time_s = frames->columns[1][i];
    // Line 1 is the header, so row i is on line i + 2.
    const auto where = fmt::format("{}:{}", frames_csv.string(), i + 2);
    if (!(number >= 0.0 && number < 1e9) || number != std::floor(number)) {
      return fail(Fault::bad_input, "{}: frame {} is not a whole number", where, number);
    }
    if (!std::isfinite(time_s)) return fail(Fault::bad_input, "{}: time_s is not finite", where);
    if (i > 0 && !(time_s > recording.frames_.back().time_s)) {
      return fail(
          Fault::bad_input,
          "{}: time {} s is not later than {} s of the frame before; frames are out of order",
          where, time_s, recording.frames_.back().time_s);
    }
    const auto frame = static_cast<long>(number);
    if (!listed.insert(frame).second)
      return fail(Fault::bad_input, "{}: frame {} is listed twice", where, frame);
    const auto picture = pictures->find(frame);
    if (picture == pictures->end()) {
      return fail(Fault::bad_input, "{}: frame {} has no picture in {}", where, frame,
                  (folder / "frames").string());
    }
    const auto dark = darks.find(frame);
    recording.frames_.push_back(
        {time_s, picture->second, dark != darks.end() ? dark->second : fs::path()});
  }
  const auto checked = check_listed(*pictures, darks, listed, frames_csv);
  if (!checked) return tl::unexpected(checked.error());
  const fs::path yaw_csv = folder / "yaw.csv";
  auto readings = read_readings(yaw_csv);
  if (!readings) return tl::unexpected(readings.error());
  recording.readings_ = std::move(*readings);
  std::vector<double> times_s;
  times_s.reserve(recording.frames_.size());
  for (const Entry& entry : recording.frames_) times_s.push_back(entry.time_s);
  const auto covered = yaw_at(times_s, recording.readings_, recording.calibration_.latency_s);
  if (!covered) return fail(Fault::bad_input, "{}: {}", yaw_csv.string(), covered.error().message);
  return recording;
}

Result<Frame> Recording::next_frame(double) {
  if (next_ == frames_.size()) return fail(Fault::device, "the recording has no more frames");
  const Entry& entry = frames_[next_++];
  Frame frame{.time_s = entry.time_s, .image = {}, .dark = {}};
  // A picture that has disappeared is an error, not the end of the recording.
  const auto read = kind_ == Frames::grey ? read_picture : read_colours;
  auto image = read(entry.picture);
  if (!image) return tl::unexpected(image.error());
  frame.image = std::move(*image);
  if (!entry.dark.empty()) {
    auto dark = read(entry.dark);
    if (!dark) return tl::unexpected(dark.error());
    frame.dark = std::move(*dark);
  }
  return frame;
}

Result<void> Recording::sweep(double, double, double) {
  next_ = 0;
  return {};
}

Result<void> Recording::step(double, double, double) {
  next_ = 0;
  return {};
}

Recorder::Recorder(Camera& camera, Turntable& turntable, fs::path folder)
    : camera_(&camera),
      turntable_(&turntable),
      folder_(std::move(folder)),
      part_(folder_.string() + ".part") {}

Recorder::Recorder(Recorder&& other) noexcept
    : camera_(other.camera_),
      turntable_(other.turntable_),
      folder_(std::move(other.folder_)),
      part_(std::exchange(other.part_, {})),
      lock_(std::exchange(other.lock_, -1)),
      times_s_(std::move(other.times_s_)),
      readings_(std::move(other.readings_)) {}

Recorder::~Recorder() {
  std::error_code ignored;  // a destructor cannot report
  if (!part_.empty()) fs::remove_all(part_, ignored);
  if (lock_ >= 0) ::close(lock_);
}

Result<Recorder> Recorder::open(Camera& camera, Turntable& turntable, const fs::path& folder) {
  std::error_code error;
  fs::path name = folder;
  if (!name.has_filename()) name = name.parent_path();  // trailing slash
  if (fs::exists(name, error) && (!fs::is_directory(name, error) || !fs::is_empty(name, error))) {
    return fail(Fault::file, "{}: it exists already and is not an empty folder", name.string());
  }
  Recorder recorder(camera, turntable, name);
  const fs::path part = std::exchange(recorder.part_, {});
  const auto lock = begin_folder(name);
  if (!lock) return tl::unexpected(lock.error());
  recorder.part_ = part;
  recorder.lock_ = *lock;
  if (!fs::create_directory(part / "frames", error))
    return fail(Fault::file, "{}: it cannot be made: {}", part.string(), error.message());
  return recorder;
}

Result<Frame> Recorder::next_frame(double timeout_s) {
  auto frame = camera_->next_frame(timeout_s);
  if (!frame) return frame;
  const std::string name = picture_name(times_s_.size());
  if (auto kept = keep_picture(part_ / "frames" / name, frame->image); !kept)
    return tl::unexpected(kept.error());
  if (!frame->dark.data.empty()) {
    std::error_code error;
    fs::create_directories(part_ / "dark", error);
    if (auto kept = keep_picture(part_ / "dark" / name, frame->dark); !kept)
      return tl::unexpected(kept.error());
  }
  times_s_.push_back(frame->time_s);
  return frame;
}

// Keeps the readings of the way forth before the way back starts.
Result<void> Recorder::keep_readings() {
  if (times_s_.empty()) return {};
  const auto so_far = turntable_->readings();
  if (!so_far) return tl::unexpected(so_far.error());
  readings_.insert(readings_.end(), so_far->begin(), so_far->end());
  return {};
}

Result<void> Recorder::sweep(double from_rad, double to_rad, double rad_per_s) {
  if (auto kept = keep_readings(); !kept) return kept;
  return turntable_->sweep(from_rad, to_rad, rad_per_s);
}

Result<void> Recorder::step(double from_rad, double to_rad, double step_rad) {
  if (auto kept = keep_readings(); !kept) return kept;
  return turntable_->step(from_rad, to_rad, step_rad);
}

Result<std::vector<YawReading>> Recorder::readings() const {
  return turntable_->readings();
}

Result<void> Recorder::finish(const ScannerCalibration& calibration) {
  const auto last = turntable_->readings();
  if (!last) return tl::unexpected(last.error());
  const fs::path part = std::exchange(part_, {});  // what was recorded stays, whatever comes
  std::vector<YawReading> readings = readings_;
  readings.insert(readings.end(), last->begin(), last->end());
  // Tables have as many digits as a double needs, so that a replay sees the same numbers.
  std::string frames = "frame,time_s\n";
  for (std::size_t i = 0; i < times_s_.size(); ++i)
    frames += fmt::format("{},{}\n", i, times_s_[i]);
  std::string yaw = "time_s,yaw_deg\n";
  for (const YawReading& reading : readings) {
    const double counts = std::round(to_deg(reading.yaw_rad) / degrees_per_count);
    yaw += fmt::format("{},{}\n", reading.time_s, counts * degrees_per_count);
  }
  for (const auto& [name, text] : {std::pair<const char*, std::string>{"frames.csv", frames},
                                   {"yaw.csv", yaw},
                                   {"calibration.toml", to_toml(calibration)}}) {
    if (auto written = write_file(part / name, text); !written) return written;
  }
  std::error_code error;
  fs::remove(folder_, error);  // removes an empty folder of that name
  fs::rename(part, folder_, error);
  if (!error) return {};
  return fail(Fault::file, "{}: {}; the sweep is left as {}", folder_.string(), error.message(),
              part.string());
}

}  // namespace tuina::scanner
