// SPDX-License-Identifier: Apache-2.0
#include <nlohmann/json.hpp>

#include "apps/tuina/verbs.hpp"
#include "tuina/core/io/file.hpp"
#include "tuina/robot/robot_model.hpp"
#include "tuina/robot/wheeled_body.hpp"

namespace tuina::app {
namespace {

/// A robot as other programs read it: `export urdf` and `export mjcf`.
class Export final : public Verb {
 public:
  explicit Export(bool urdf) : urdf_(urdf) {}
  [[nodiscard]] const char* name() const override { return urdf_ ? "export urdf" : "export mjcf"; }
  [[nodiscard]] const char* summary() const override {
    return urdf_ ? "the robot for ROS, as URDF" : "the robot for MuJoCo, as MJCF";
  }
  [[nodiscard]] const char* example() const override {
    return urdf_ ? "tuina export urdf --robot successor --out robot.urdf"
                 : "tuina export mjcf --out robot.xml";
  }
  void describe(Options& options) override {
    add_robot_option(options, robot_);
    options.add("--position", position_, "how arms on a linear base are mounted")
        .one_of({"sitting", "prone"})
        .show_default();
    options.add("--out", out_, "the file; else it goes to stdout");
  }
  [[nodiscard]] Result<Answer> run(const CommonOptions&) override {
    const auto model = robot::load_robot(robot_);
    if (!model) return tl::unexpected(model.error());
    const BodyPosture position = position_ == "prone" ? BodyPosture::prone : BodyPosture::sitting;
    const PerArm<robot::ArmTable> arms{.of = {model->arm, model->arm}};
    const robot::Description robot =
        model->carrier == robot::Carrier::wheeled_body
            ? robot::wheeled_robot(arms, model->mounting(position).upright_from_shoulder)
            : robot::describe(robot::place_robot(*model, position).mount, arms);
    const std::string text = urdf_ ? robot::to_urdf(robot) : robot::to_mjcf(robot, 1e-3);
    if (!out_.empty()) {
      if (auto written = write_file(out_, text); !written) return tl::unexpected(written.error());
    }
    std::size_t joints = 0;
    double mass_kg = 0.0;
    for (const robot::Part& part : robot.parts) {
      joints += part.motion != robot::Part::Motion::fixed ? 1 : 0;
      mass_kg += part.mass_kg;
    }
    nlohmann::json json = {{"robot", robot_}, {"joints", joints}, {"mass_kg", mass_kg}};
    if (out_.empty()) json["text"] = text;
    return Answer{.json = json.dump(2),
                  .text = fmt::format("{}: {} joints, {:.1f} kg", robot_, joints, mass_kg),
                  .product = out_.empty() ? text : std::string()};
  }

 private:
  bool urdf_;
  std::string robot_ = "thesis", position_ = "sitting", out_;
};

}  // namespace

std::unique_ptr<Verb> make_export_urdf() {
  return std::make_unique<Export>(true);
}

std::unique_ptr<Verb> make_export_mjcf() {
  return std::make_unique<Export>(false);
}

}  // namespace tuina::app
