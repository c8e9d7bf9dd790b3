// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "tuina/scanner/calibration.hpp"
#include "tuina/scanner/camera.hpp"
#include "tuina/scanner/turntable.hpp"

namespace tuina::scanner {

/// A recorded sweep (frames/, dark/, frames.csv, yaw.csv, calibration.toml) as camera and
/// turntable. `open` checks everything but the pictures; a missing or broken picture fails in
/// `next_frame`.
class Recording final : public Camera, public Turntable {
 public:
  /// Conversion of frames: grey (red of colour pictures), or unchanged.
  enum class Frames : std::uint8_t { grey, as_recorded };
  /// Opens a folder with frames, yaw readings and calibration. Fails with the file and what is
  /// wrong in it.
  [[nodiscard]] static Result<Recording> open(const std::filesystem::path& folder,
                                              Frames frames = Frames::grey);

  [[nodiscard]] Result<Frame> next_frame(double timeout_s) override;
  [[nodiscard]] Result<void> sweep(double from_rad, double to_rad, double rad_per_s) override;
  [[nodiscard]] Result<void> step(double from_rad, double to_rad, double step_rad) override;
  [[nodiscard]] Result<bool> arrived() const override { return next_ == frames_.size(); }
  [[nodiscard]] Result<void> switch_laser(bool) override { return {}; }
  [[nodiscard]] Result<std::vector<YawReading>> readings() const override { return readings_; }

  /// As the folder states it.
  [[nodiscard]] const ScannerCalibration& calibration() const { return calibration_; }
  /// Number of frames.
  [[nodiscard]] int frames() const { return static_cast<int>(frames_.size()); }

 private:
  struct Entry {
    double time_s = 0.0;
    std::filesystem::path picture;
    std::filesystem::path dark;  ///< empty if there is none
  };

  Frames kind_ = Frames::grey;
  std::vector<Entry> frames_;
  std::vector<YawReading> readings_;
  ScannerCalibration calibration_;
  std::size_t next_ = 0;
};

/// Passes a camera and turntable through and records them as a sweep folder. The folder appears
/// when `finish` succeeds; without `finish` nothing is left behind. Until then it is FOLDER.part,
/// locked against other programs, which stays when this one is killed or `finish` fails.
class Recorder final : public Camera, public Turntable {
 public:
  /// Fails when the folder is not empty, and when a FOLDER.part is there: it may be all that is
  /// left of another sweep.
  [[nodiscard]] static Result<Recorder> open(Camera& camera, Turntable& turntable,
                                             const std::filesystem::path& folder);
  Recorder(Recorder&& other) noexcept;
  Recorder(const Recorder&) = delete;
  Recorder& operator=(const Recorder&) = delete;
  Recorder& operator=(Recorder&&) = delete;
  ~Recorder() override;

  [[nodiscard]] Result<Frame> next_frame(double timeout_s) override;
  [[nodiscard]] Result<void> sweep(double from_rad, double to_rad, double rad_per_s) override;
  [[nodiscard]] Result<void> step(double from_rad, double to_rad, double step_rad) override;
  [[nodiscard]] Result<bool> arrived() const override { return turntable_->arrived(); }
  [[nodiscard]] Result<void> switch_laser(bool on) override { return turntable_->switch_laser(on); }
  [[nodiscard]] Result<std::vector<YawReading>> readings() const override;
  /// Writes readings and calibration beside the frames. Fails with Fault::file.
  [[nodiscard]] Result<void> finish(const ScannerCalibration& calibration);

 private:
  Recorder(Camera& camera, Turntable& turntable, std::filesystem::path folder);
  [[nodiscard]] Result<void> keep_readings();

  Camera* camera_;
  Turntable* turntable_;
  std::filesystem::path folder_;
  std::filesystem::path part_;  ///< temporary folder until `finish`; empty: nothing to remove
  int lock_ = -1;               ///< descriptor of that folder
  std::vector<double> times_s_;
  std::vector<YawReading> readings_;  ///< readings of the turns before this one
};

}  // namespace tuina::scanner
