// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <numeric>

#include "apps/evaluation/acupoints/marker_trials.hpp"
#include "apps/evaluation/acupoints/scores.hpp"
#include "apps/evaluation/verbs.hpp"
#include "apps/simulated/atlas_source.hpp"
#include "tuina/core/io/file.hpp"
#include "tuina/core/random.hpp"
#include "tuina/core/units.hpp"
#include "tuina/telemetry/plot/svg_plot.hpp"

namespace tuina::app {
namespace {

using nlohmann::json;
namespace palette = telemetry::palette;

/// Somebody to judge on, as a scan shows them.
struct Judged {
  std::size_t person = 0;
  Result<body::BackSurface> back;
};

/// The curve of one kind of learning, in one position.
struct Curve {
  const char* name;
  bool prior;
  BodyPosture position;
  telemetry::Colour colour;
};
constexpr std::array<Curve, 4> curves = {
    {{"sitting, adapted", true, BodyPosture::sitting, palette::press},
     {"lying, adapted", true, BodyPosture::prone, palette::rub},
     {"sitting, alone", false, BodyPosture::sitting, palette::press},
     {"lying, alone", false, BodyPosture::prone, palette::rub}}};

/// How the error falls with the number of labelled people that an atlas learns from.
class EvaluateAtlas final : public Verb {
 public:
  [[nodiscard]] const char* name() const override { return "evaluate atlas"; }
  [[nodiscard]] const char* summary() const override {
    return "how many labelled people an atlas needs, or how far it is off at markers on the skin";
  }
  [[nodiscard]] const char* example() const override {
    return "tuina evaluate atlas --train people --bodies others --figure learning.svg\n"
           "  tuina evaluate atlas --markers scans";
  }
  void describe(Options& options) override {
    options.add("--train", train_, "labelled bodies to learn from");
    options.add("--bodies", bodies_, "other labelled bodies to judge on");
    auto markers =
        options.add("--markers", markers_,
                    "instead: scans (*.ply) of people with small balls or buttons on the skin; the "
                    "shipped atlas is judged at them");
    options
        .add("--labels", labels_,
             "with --markers: what all the markers on each person are stuck on, from the head to "
             "the feet; psis means the pair, psis_L one of it")
        .delimiter(',')
        .needs(markers)
        .show_default();
    options.add("--counts", counts_, "people to learn from in each position")
        .delimiter(',')
        .between(0, 10000)
        .show_default();
    options.add("--draws", draws_, "so many choices of people, of which the mean is taken")
        .between(1, 100)
        .show_default();
    options
        .add("--scan", scan_,
             "ideal, or laser: through the simulated scanner and its calibration errors")
        .one_of({"ideal", "laser"})
        .show_default();
    options.add("--figure", figure_, "the curves, as SVG");
  }

  [[nodiscard]] Result<Answer> run(const CommonOptions& common) override {
    if (const auto good = check_words(); !good) return tl::unexpected(good.error());
    const auto shipped = open_atlas("");
    if (!shipped) return tl::unexpected(shipped.error());
    if (!markers_.empty()) return at_markers(common, *shipped);
    auto train = read_labelled({train_});
    if (!train) return tl::unexpected(train.error());
    scan_everybody(*train, common.seed + 1000003, progress_bar(common, "scan"));
    const auto people = read_labelled({bodies_});
    if (!people) return tl::unexpected(people.error());
    std::vector<Judged> judged;
    for (std::size_t i = 0; i < people->size(); ++i) {
      const auto seen = see((*people)[i], {.by = parse_scan(scan_)}, common.seed + i);
      judged.push_back({i, seen ? body::fit_back(seen->cloud_in_couch)
                                : Result<body::BackSurface>(tl::unexpected(seen.error()))});
    }
    const auto bar = progress_bar(common, "learn and judge");
    const std::size_t runs = 2 * counts_.size() * static_cast<std::size_t>(draws_);
    std::size_t done = 0;
    json rows = json::array();
    for (const int count : counts_) {
      for (const bool prior : {true, false}) {
        if (count == 0 && !prior) continue;
        Score score;
        for (int draw = 0; draw < draws_; ++draw) {
          if (draw > 0 && (count == 0 || all_of(*train, count))) break;
          const auto tell = [&](double learned) {
            if (bar) bar((static_cast<double>(done) + 0.5 * learned) / static_cast<double>(runs));
          };
          Result<body::Atlas> atlas = *shipped;
          if (count > 0) {
            atlas = body::learn_atlas(
                chosen(*train, count, common.seed + static_cast<std::uint64_t>(draw)),
                prior ? &*shipped : nullptr, tell, nullptr);
          }
          if (!atlas) return tl::unexpected(atlas.error());
          judge_all(judged, *people, *atlas, score);
          if (bar) bar(static_cast<double>(++done) / static_cast<double>(runs));
        }
        json row = to_json(score);
        json shown{{"bodies", count},
                   {"prior", prior},
                   {"by_position", row["by_position"]},
                   {"coverage", row["coverage"]},
                   {"failures", row["failures"]},
                   {"failed", row["failed"]}};
        rows.push_back(std::move(shown));
      }
    }
    if (bar) bar(1.0);
    if (!figure_.empty()) {
      const auto written = write_file(figure_, figure(rows));
      if (!written) return tl::unexpected(written.error());
    }
    const json answer{
        {"atlas", rows}, {"judged_on", people->size()}, {"draws", draws_}, {"scan", scan_}};
    return Answer{.json = answer.dump(2), .text = text_of_rows(rows)};
  }

 private:
  [[nodiscard]] Result<void> check_words() const {
    if (!markers_.empty() && !(train_.empty() && bodies_.empty() && figure_.empty()))
      return fail(Fault::usage,
                  "--markers judges its own people: without --train, --bodies and "
                  "--figure");
    if (markers_.empty() && (train_.empty() || bodies_.empty()))
      return fail(Fault::usage, "--train and --bodies are required, or --markers");
    for (const std::string& label : labels_) {
      if (label.find('=') != std::string::npos)
        return fail(Fault::usage, "--labels: '{}' is no point; here they stand alone, as C7,psis",
                    label);
    }
    return check_folder_of(figure_);
  }

  [[nodiscard]] Result<Answer> at_markers(const CommonOptions& common,
                                          const body::Atlas& shipped) const {
    const auto labels =
        parse_marks({fmt::format("{}={}", bump_kind, fmt::join(labels_, ","))}, {bump_kind},
                    shipped.positions.front().shape.labels, "--labels");
    if (!labels) return tl::unexpected(labels.error());
    const auto judged =
        judge_markers(markers_, labels->front(), shipped, progress_bar(common, "evaluate"));
    if (!judged) return tl::unexpected(judged.error());
    return Answer{.json = json{{"markers", *judged}}.dump(2), .text = markers_text(*judged)};
  }

  [[nodiscard]] static bool all_of(const std::vector<body::LabelledBody>& bodies, int count) {
    return 2 * static_cast<std::size_t>(count) >= bodies.size();
  }

  /// So many people in each position; more people of one draw contain the fewer.
  [[nodiscard]] static std::vector<body::LabelledBody> chosen(
      const std::vector<body::LabelledBody>& bodies, int count, std::uint64_t seed) {
    Random random = make_random(seed, "people to learn from");
    std::vector<std::size_t> order(bodies.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    for (std::size_t i = order.size(); i > 1; --i) {
      const auto j = static_cast<std::size_t>(uniform(random, 0.0, static_cast<double>(i)));
      std::swap(order[i - 1], order[std::min(j, i - 1)]);
    }
    std::array<int, 2> taken = {};
    std::vector<body::LabelledBody> some;
    for (const std::size_t i : order) {
      int& of_position = taken[bodies[i].position == BodyPosture::sitting ? 0 : 1];
      if (of_position >= count) continue;
      ++of_position;
      some.push_back(bodies[i]);
    }
    return some;
  }

  static void judge_all(const std::vector<Judged>& judged,
                        const std::vector<body::LabelledBody>& people, const body::Atlas& atlas,
                        Score& score) {
    for (const Judged& one : judged) {
      const body::LabelledBody& person = people[one.person];
      const auto found = one.back ? body::locate_acupoints(*one.back, atlas)
                                  : Result<body::Mapping>(tl::unexpected(one.back.error()));
      if (!found) {
        score.failures.push_back(fmt::format("{}: {}", person.id, found.error().message));
        continue;
      }
      add_findings(person, one.person, *found, person.acupoints, score);
    }
  }

  [[nodiscard]] static std::string figure(const json& rows) {
    telemetry::Plot plot{.title = "error of the seven points against the number of labelled people",
                         .x_label = "labelled people in each position",
                         .y_label = "mean error, mm",
                         .y_low = 0.0,
                         .y_high = 20.0,
                         .height_px = 340};
    for (const Curve& curve : curves) {
      telemetry::Series line{.name = curve.name, .colour = curve.colour, .dashed = !curve.prior};
      for (const json& row : rows) {
        const json& group = row["by_position"][name_of(curve.position)];
        if (row["prior"] != curve.prior || group.is_null()) continue;
        line.x.push_back(row["bodies"].get<double>());
        line.y.push_back(group["mean_mm"].get<double>());
      }
      telemetry::Series dots{
          .name = {}, .x = line.x, .y = line.y, .colour = curve.colour, .dots = true};
      plot.series.push_back(std::move(line));
      plot.series.push_back(std::move(dots));
    }
    return telemetry::to_svg(plot);
  }

  [[nodiscard]] static std::string text_of_rows(const json& rows) {
    telemetry::Table table{.title = "mean over the seven points, mm",
                           .columns = {{.head = "people"},
                                       {.head = "learned from"},
                                       {.head = "sitting", .digits = 1},
                                       {.head = "prone", .digits = 1},
                                       {.head = "95 %", .digits = 0},
                                       {.head = "refused"}}};
    for (const json& row : rows) {
      table.add({row["bodies"].get<int>(),
                 row["prior"].get<bool>() ? "them and the shipped atlas" : "them alone",
                 number_in(row["by_position"]["sitting"], "mean_mm"),
                 number_in(row["by_position"]["prone"], "mean_mm"),
                 number_in(row, "coverage", 100.0), row["failures"].get<std::size_t>()});
    }
    return to_text(table);
  }

  std::string train_, bodies_, markers_, figure_;
  std::vector<std::string> labels_ = {"C7", "scapula_inferior_angle", "psis"};
  std::vector<int> counts_ = {0, 1, 5, 10, 20, 80};
  int draws_ = 2;
  std::string scan_ = "ideal";
};

}  // namespace

std::unique_ptr<Verb> make_evaluate_atlas() {
  return std::make_unique<EvaluateAtlas>();
}

}  // namespace tuina::app
