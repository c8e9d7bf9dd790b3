// SPDX-License-Identifier: Apache-2.0
#include <filesystem>
#include <nlohmann/json.hpp>

#include "apps/tuina/mount/scanner_mount.hpp"
#include "apps/tuina/verbs.hpp"
#include "tuina/core/io/file.hpp"

namespace tuina::app {
namespace {

/// What a printer makes the scanner's mount of.
class ExportMount final : public Verb {
 public:
  [[nodiscard]] const char* name() const override { return "export mount"; }
  [[nodiscard]] const char* summary() const override {
    return "the scanner's mount, to print: STL and STEP of its parts (docs/build_a_scanner.md)";
  }
  [[nodiscard]] const char* example() const override {
    return "tuina export mount --laser-mm 12 --out mount";
  }
  void describe(Options& options) override {
    options.add("--out", out_, "a folder for bar, ring and shelf, each .stl and .step; it is made")
        .required();
    options.add("--baseline-mm", baseline_mm_, "from the camera's lens to the laser's beam")
        .between(80.0, 400.0)
        .show_default();
    options.add("--lean-deg", lean_deg_, "of the laser towards the camera")
        .between(0.0, 40.0)
        .show_default();
    options.add("--laser-mm", laser_mm_, "diameter of the laser's housing")
        .between(4.0, 20.0)
        .show_default();
    options.add("--thickness-mm", thickness_mm_, "of all plates").between(3.0, 12.0).show_default();
  }
  [[nodiscard]] Result<Answer> run(const CommonOptions&) override {
    const std::filesystem::path folder(out_);
    std::error_code fault;
    std::filesystem::create_directory(folder, fault);
    if (!std::filesystem::is_directory(folder))
      return fail(Fault::file, "--out {}: the folder cannot be made: {}", out_, fault.message());
    nlohmann::ordered_json json;
    std::string text;
    for (const Plate& plate : scanner_mount({.baseline_m = from_mm(baseline_mm_),
                              .lean_rad = from_deg(lean_deg_),
                              .laser_diameter_m = from_mm(laser_mm_),
                              .thickness_m = from_mm(thickness_mm_)})) {
      for (const auto& [ending, content] :
           {std::pair(".stl", to_stl(plate)), std::pair(".step", to_step(plate))})
        if (const auto written = write_file(folder / (plate.name + ending), content); !written)
          return tl::unexpected(written.error());
      const double volume_mm3 = 1e9 * area_m2(plate) * plate.thickness_m;
      const Vector2 size = size_of(plate.outline);
      json[plate.name] = {{"width_mm", to_mm(size.x())},
                          {"height_mm", to_mm(size.y())},
                          {"volume_mm3", volume_mm3}};
      text += fmt::format("{:<6} {:.0f} x {:.0f} x {:.0f} mm, {:.0f} cm3\n", plate.name,
                          to_mm(size.x()), to_mm(size.y()), thickness_mm_, 1e-3 * volume_mm3);
    }
    return Answer{.json = json.dump(2),
                  .text = text + "print the ring twice; all lie flat and need no supports"};
  }

 private:
  static Vector2 size_of(const Outline& outline) {
    Vector2 low = outline.front(), high = outline.front();
    for (const Vector2& at : outline) low = low.cwiseMin(at), high = high.cwiseMax(at);
    return high - low;
  }
  std::string out_;
  double baseline_mm_ = 200.0, lean_deg_ = 17.0, laser_mm_ = 9.0, thickness_mm_ = 6.0;
};

}  // namespace

std::unique_ptr<Verb> make_export_mount() {
  return std::make_unique<ExportMount>();
}

}  // namespace tuina::app
