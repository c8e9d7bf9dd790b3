// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "tuina/scanner/calibration.hpp"
#include "tuina/scanner/camera.hpp"
#include "tuina/scanner/turntable.hpp"

namespace tuina::scanner {

/// A picture as 8-bit grey: the red of a colour picture, 16 bits rounded to 8.
[[nodiscard]] Result<Image> read_picture(const std::filesystem::path& path);

/// A recorded sweep (frames/, dark/, frames.csv, yaw.csv, calibration.toml) behind the doors of a
/// camera and a turntable. Opening it checks everything but the pictures, which are read one by
/// one; a picture that is missing, broken or of the wrong size fails when its turn comes.
class Recording final : public Camera, public Turntable {
 public:
  /// Frames come in grey, the red of colour ones, or as they are.
  enum class Frames : std::uint8_t { grey, as_recorded };
  [[nodiscard]] static Result<Recording> open(const std::filesystem::path& folder,
                                              Frames frames = Frames::grey);

  [[nodiscard]] Result<Frame> next_frame(double timeout_s) override;
  [[nodiscard]] Result<void> sweep(double from_rad, double to_rad, double rad_per_s) override;
  [[nodiscard]] Result<void> step(double from_rad, double to_rad, double step_rad) override;
  [[nodiscard]] Result<bool> arrived() const override { return next_ == frames_.size(); }
  [[nodiscard]] Result<void> switch_laser(bool) override { return {}; }
  [[nodiscard]] Result<std::vector<YawReading>> readings() const override { return readings_; }

  [[nodiscard]] const ScannerCalibration& calibration() const { return calibration_; }
  [[nodiscard]] int frames() const { return static_cast<int>(frames_.size()); }

 private:
  struct Entry {
    double time_s = 0.0;
    std::filesystem::path picture;
    std::filesystem::path dark;  ///< empty when there is none
  };

  Frames kind_ = Frames::grey;
  std::vector<Entry> frames_;
  std::vector<YawReading> readings_;
  ScannerCalibration calibration_;
  std::size_t next_ = 0;
};

/// Stands between a scanner and its reader and writes what passes into a folder as a recorded
/// sweep. The folder gets its name only when `finish` succeeds; until then, and after a failure,
/// nothing is there.
class Recorder final : public Camera, public Turntable {
 public:
  /// Refuses a folder that holds something already.
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
  [[nodiscard]] Result<void> finish(const ScannerCalibration& calibration);

 private:
  Recorder(Camera& camera, Turntable& turntable, std::filesystem::path folder);
  [[nodiscard]] Result<void> keep_readings();

  Camera* camera_;
  Turntable* turntable_;
  std::filesystem::path folder_;
  std::filesystem::path
      part_;  ///< where it is written until it is whole; empty when nothing is to be removed
  std::vector<double> times_s_;
  std::vector<YawReading> readings_;  ///< of the turns before this one
};

}  // namespace tuina::scanner
