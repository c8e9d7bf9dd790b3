// SPDX-License-Identifier: Apache-2.0
#include <filesystem>
#include <nlohmann/json.hpp>

#include "apps/cli/asked_to_end.hpp"
#include "apps/simulated/play_motion.hpp"
#include "apps/simulated/teaching.hpp"
#include "apps/tuina/verbs.hpp"
#include "tuina/core/io/file.hpp"
#include "tuina/core/units.hpp"
#include "tuina/massage/programme.hpp"
#include "tuina/telemetry/plot/svg_plot.hpp"

namespace tuina::app {
namespace {

namespace fs = std::filesystem;

/// The programme `relax` is what the hand shows, so its techniques are the ones to choose from.
std::vector<std::string> shown_techniques() {
  std::vector<std::string> names;
  const auto relax = massage::load_programme("relax");
  if (!relax) return names;
  for (const massage::Part& part : relax->parts) names.emplace_back(name_of(part.technique));
  return names;
}

void add_device_option(Options& options, std::string& file, const std::string& more = {}) {
  options.add("--device", file,
              "a TOML file that names the arms (docs/armlink.md), in place of those simulated "
              "here; person, position, robot and seed must be theirs" +
                  more);
}

double contact_s(const session::TaughtMotion& motion) {
  double sum_s = 0.0;
  for (std::size_t i = 1; i < motion.samples.size(); ++i)
    if (motion.samples[i].force_n > 1.0)
      sum_s += motion.samples[i].time_s - motion.samples[i - 1].time_s;
  return sum_s;
}

double peak_n(const session::TaughtMotion& motion) {
  double max_n = 0.0;
  for (const auto& sample : motion.samples) max_n = std::max(max_n, sample.force_n);
  return max_n;
}

nlohmann::json json_of(const session::TaughtMotion& motion) {
  return {{"name", motion.name},
          {"position", name_of(motion.position)},
          {"arm", name_of(motion.arm)},
          {"duration_s", motion.duration_s()},
          {"contact_s", contact_s(motion)},
          {"peak_n", peak_n(motion)}};
}

/// Force over time, and the joints below it.
std::string draw(const session::TaughtMotion& motion, const PlayedMotion* played) {
  using telemetry::Series;
  namespace palette = telemetry::palette;
  telemetry::Plot plot{.title = motion.name, .x_label = "time, s", .y_label = "force, N"};
  Series taught{.name = played != nullptr ? "taught" : "", .colour = palette::press};
  for (const auto& sample : motion.samples) {
    taught.x.push_back(sample.time_s);
    taught.y.push_back(sample.force_n);
  }
  plot.series.push_back(std::move(taught));
  if (played != nullptr) {
    Series now{.name = "played, true", .colour = palette::ink};
    for (const TeachRow& row : played->truth) {
      now.x.push_back(row.time_s);
      now.y.push_back(row.true_force_n);
    }
    plot.series.push_back(std::move(now));
  }
  return telemetry::to_svg(plot);
}

std::string draw_joints(const session::TaughtMotion& motion) {
  namespace palette = telemetry::palette;
  constexpr std::array colours = {palette::press, palette::rub,  palette::stroke,  palette::tap,
                                  palette::ink,   palette::grey, palette::hairline};
  telemetry::Plot plot{.title = "joints", .x_label = "time, s", .y_label = "angle, degrees"};
  const auto joints = motion.samples.front().q_rad.size();
  for (Eigen::Index j = 0; j < joints; ++j) {
    telemetry::Series series{.name = fmt::format("joint {}", j + 1),
                             .colour = colours[static_cast<std::size_t>(j)]};
    for (const auto& sample : motion.samples) {
      series.x.push_back(sample.time_s);
      series.y.push_back(to_deg(sample.q_rad(j)));
    }
    plot.series.push_back(std::move(series));
  }
  return telemetry::to_svg(plot);
}

class TeachRecord final : public Verb {
 public:
  [[nodiscard]] const char* name() const override { return "teach record"; }
  [[nodiscard]] const char* summary() const override {
    return "a simulated hand leads an arm over a back; what the joints did is kept";
  }
  [[nodiscard]] const char* example() const override {
    return "tuina teach record --technique stroke --arm left --out stroke.toml";
  }
  void describe(Options& options) override {
    options
        .add("--person", order_.person,
             "phantom:slim, phantom:medium, phantom:hefty, or a labelled body FILE.ply")
        .show_default();
    options.add("--position", position_, "of the person")
        .one_of({"sitting", "prone"})
        .show_default();
    add_robot_option(options, order_.robot);
    options.add("--technique", technique_, "what the hand shows: as in the programme relax")
        .one_of(shown_techniques())
        .show_default();
    options.add("--arm", arm_, "that is led").one_of({"left", "right"}).show_default();
    add_device_option(options, order_.device, "; so is the hand (`tuina robot armlink --hand`)");
    options.add("--out", out_, "FILE.toml; the samples go to FILE.csv beside it").required();
  }
  [[nodiscard]] Result<Answer> run(const CommonOptions& common) override {
    const auto config = effective_config(common);
    if (!config) return tl::unexpected(config.error());
    if (fs::path(out_).extension() != ".toml")
      return fail(Fault::usage, "--out {}: the name must end in .toml", out_);
    if (const auto good = check_folder_of(out_); !good) return tl::unexpected(good.error());
    order_.position = position_ == "prone" ? BodyPosture::prone : BodyPosture::sitting;
    order_.technique = *parse_technique(technique_);  // checked by the option
    order_.arm = arm_ == "left" ? Arm::left : Arm::right;
    end_when_asked();
    const auto taught = record_by_hand(order_, *config, common);
    if (!taught) return tl::unexpected(taught.error());
    if (contact_s(taught->motion) == 0.0)
      return fail(Fault::not_found,
                  "in {:.0f} s nobody led the {} arm onto the skin: is a hand there, at this arm?",
                  taught->motion.duration_s(), arm_);
    if (const auto written = session::write_taught(taught->motion, out_); !written)
      return tl::unexpected(written.error());
    nlohmann::json json = json_of(taught->motion);
    json["peak_hand_n"] =
        taught->peak_hand_n ? nlohmann::json(*taught->peak_hand_n) : nlohmann::json();
    const std::string hand = taught->peak_hand_n ? fmt::format("; the hand needed {:.0f} N at most",
                                                               *taught->peak_hand_n)
                                                 : "";
    return Answer{
        .json = json.dump(2),
        .text = fmt::format("{}: {:.1f} s, of these {:.1f} s on the skin with up to {:.1f} "
                            "N{}{}\nnow: tuina teach play {}",
                            taught->motion.name, taught->motion.duration_s(),
                            contact_s(taught->motion), peak_n(taught->motion), hand,
                            taught->asked_to_end ? ", asked to stop" : "", out_),
        .exit_code = taught->asked_to_end ? 4 : 0};
  }

 private:
  TeachOrder order_;
  std::string position_ = "sitting", technique_ = name_of(Technique::stroke), arm_ = "left", out_;
};

class TeachPlay final : public Verb {
 public:
  [[nodiscard]] const char* name() const override { return "teach play"; }
  [[nodiscard]] const char* summary() const override {
    return "plays a taught motion to a simulated person by joint impedance, under the guard";
  }
  [[nodiscard]] const char* example() const override {
    return "tuina teach play stroke.toml --plot played.svg";
  }
  void describe(Options& options) override {
    options.add("file", file_, "of `tuina teach record`").required();
    options
        .add("--person", person_,
             "phantom:slim, phantom:medium, phantom:hefty, or a labelled body FILE.ply")
        .show_default();
    options.add("--plot", plot_, "force over time, taught and played, as SVG");
    add_device_option(options, device_);
  }
  [[nodiscard]] Result<Answer> run(const CommonOptions& common) override {
    const auto config = effective_config(common);
    if (!config) return tl::unexpected(config.error());
    const auto motion = session::read_taught(file_);
    if (!motion) return tl::unexpected(motion.error());
    end_when_asked();
    const auto played = play_motion(*motion, person_, *config, common, device_);
    if (!played) return tl::unexpected(played.error());
    if (!plot_.empty()) {
      if (const auto written = write_file(plot_, draw(*motion, &*played)); !written)
        return tl::unexpected(written.error());
    }
    nlohmann::json stops = nlohmann::json::array();
    if (played->stop) stops.push_back({{"cause", *played->stop}});
    return Answer{
        .json = nlohmann::json{{"name", motion->name},
                               {"duration_s", motion->duration_s()},
                               {"tracking_rms_mm", to_mm(played->tracking_rms_m)},
                               {"force",
                                {{"rmse_n", played->force_rmse_n}, {"peak_n", played->peak_n}}},
                               {"stops", stops}}
                    .dump(2),
        .text = fmt::format("{}: {:.1f} s, the tool within {:.1f} mm RMS of where it was led, {}{}",
                            motion->name, motion->duration_s(), to_mm(played->tracking_rms_m),
                            played->force(), played->stop ? "\nstopped: " + *played->stop : ""),
        .exit_code = played->stop ? 4 : 0};
  }

 private:
  std::string file_, plot_, device_, person_ = "phantom:medium";
};

class TeachShow final : public Verb {
 public:
  [[nodiscard]] const char* name() const override { return "teach show"; }
  [[nodiscard]] const char* summary() const override { return "what a taught motion is"; }
  [[nodiscard]] const char* example() const override {
    return "tuina teach show stroke.toml --plot stroke.svg --joints joints.svg";
  }
  void describe(Options& options) override {
    options.add("file", file_, "of `tuina teach record`").required();
    options.add("--plot", plot_, "force over time as SVG");
    options.add("--joints", joints_, "joint angles over time as SVG");
  }
  [[nodiscard]] Result<Answer> run(const CommonOptions&) override {
    const auto motion = session::read_taught(file_);
    if (!motion) return tl::unexpected(motion.error());
    if (!plot_.empty()) {
      if (const auto written = write_file(plot_, draw(*motion, nullptr)); !written)
        return tl::unexpected(written.error());
    }
    if (!joints_.empty()) {
      if (const auto written = write_file(joints_, draw_joints(*motion)); !written)
        return tl::unexpected(written.error());
    }
    return Answer{.json = json_of(*motion).dump(2),
                  .text = fmt::format("{} by the {} arm to a person {}: {:.1f} s, {:.1f} s on the "
                                      "skin, {:.1f} N at most, {} samples",
                                      motion->name, name_of(motion->arm), name_of(motion->position),
                                      motion->duration_s(), contact_s(*motion), peak_n(*motion),
                                      motion->samples.size())};
  }

 private:
  std::string file_, plot_, joints_;
};

class TeachCarry final : public Verb {
 public:
  [[nodiscard]] const char* name() const override { return "teach carry"; }
  [[nodiscard]] const char* summary() const override {
    return "a taught stroke as a programme for anybody";
  }
  [[nodiscard]] const char* example() const override {
    return "tuina teach carry stroke.toml --out mine.toml\n"
           "  tuina massage --programme mine.toml --person phantom:hefty";
  }
  void describe(Options& options) override {
    options.add("file", file_, "of `tuina teach record`").required();
    options.add("--out", out_, "a programme, as TOML").required();
  }
  [[nodiscard]] Result<Answer> run(const CommonOptions&) override {
    const auto motion = session::read_taught(file_);
    if (!motion) return tl::unexpected(motion.error());
    const auto programme = session::programme_of(*motion);
    if (!programme) return fail(Fault::bad_input, "{}: {}", file_, programme.error().message);
    if (const auto written = write_file(out_, *programme); !written)
      return tl::unexpected(written.error());
    return Answer{.json = nlohmann::json{{"name", motion->name},
                                         {"places", motion->line.size()},
                                         {"force_n", motion->force_n},
                                         {"speed_mm_per_s", to_mm(motion->speed_m_per_s)}}
                              .dump(2),
                  .text = fmt::format("{}: {} places, {:.1f} N, {:.0f} mm/s\nnow: tuina massage "
                                      "--programme {}",
                                      motion->name, motion->line.size(), motion->force_n,
                                      to_mm(motion->speed_m_per_s), out_)};
  }

 private:
  std::string file_, out_;
};

}  // namespace

std::unique_ptr<Verb> make_teach_carry() {
  return std::make_unique<TeachCarry>();
}
std::unique_ptr<Verb> make_teach_record() {
  return std::make_unique<TeachRecord>();
}
std::unique_ptr<Verb> make_teach_play() {
  return std::make_unique<TeachPlay>();
}
std::unique_ptr<Verb> make_teach_show() {
  return std::make_unique<TeachShow>();
}

}  // namespace tuina::app
