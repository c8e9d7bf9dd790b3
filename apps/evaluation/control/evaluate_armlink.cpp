// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <thread>

#include "apps/cli/table.hpp"
#include "apps/evaluation/control/report.hpp"
#include "apps/evaluation/control/worlds.hpp"
#include "apps/evaluation/verbs.hpp"
#include "tuina/core/io/file.hpp"
#include "tuina/telemetry/plot/svg_plot.hpp"

namespace tuina::app {
namespace {

constexpr double usual_jitter_ms = 0.5, usual_loss_percent = 1.0;
// The target: so much force error up to so much delay.
constexpr double max_rmse_n = 1.0, max_target_delay_ms = 2.0;

// What armlink's host does, and what it would lack if each command were one datagram.
constexpr const char* again = "again each half cycle";
constexpr const char* once = "once";

struct Cable {
  double delay_ms, jitter_ms, loss_percent;
};

/// Presses of three forces on three tissues.
ControlRow row_of(const Cable& cable, bool sent_again, int seeds, std::uint64_t first_seed) {
  ControlRow row{.labels = {{"commands_sent", sent_again ? again : once},
                            {"delay_ms", fmt::format("{:g}", cable.delay_ms)},
                            {"jitter_ms", fmt::format("{:g}", cable.jitter_ms)},
                            {"loss_percent", fmt::format("{:g}", cable.loss_percent)}},
                 .runs = {}};
  for (const double force_n : {10.0, 20.0, 30.0}) {
    for (ContactExperiment run : on_all_tissues(force_n, seeds, first_seed).runs) {
      run.duration_s = 3.0;
      run.network = Network{.delay_s = 1e-3 * cable.delay_ms,
                            .jitter_s = 1e-3 * cable.jitter_ms,
                            .loss = 1e-2 * cable.loss_percent,
                            .sent_again = sent_again};
      row.runs.push_back(std::move(run));
    }
  }
  if (sent_again && cable.delay_ms <= max_target_delay_ms)
    row.target = ControlTarget{.rmse_n = max_rmse_n};
  return row;
}

ControlTable table_of(bool full, std::uint64_t seed) {
  ControlTable table{.name = "armlink",
                     .about =
                         "Presses of 10, 20 and 30 N by arms at the other end of a network, "
                         "each way: the worst of all runs.",
                     .rows = {}};
  const int seeds = full ? 4 : 1;
  const std::vector<double> delays_ms =
      full ? std::vector{0.0, 0.25, 0.5, 0.75, 1.0, 1.5, 2.0, 2.5, 3.0, 3.5, 4.0}
           : std::vector{0.0, 0.5, 1.0, 2.0, 3.0, 4.0};
  const auto add = [&](const Cable& cable, bool sent_again) {
    table.rows.push_back(row_of(cable, sent_again, seeds, seed));
  };
  for (const Cable& alone :
       {Cable{0.0, 0.0, 0.0}, Cable{0.5, 0.0, 0.0}, Cable{1.0, 0.0, 0.0}, Cable{2.0, 0.0, 0.0},
        Cable{0.0, usual_jitter_ms, 0.0}, Cable{0.0, 0.0, usual_loss_percent}})
    add(alone, true);
  for (const bool sent_again : {true, false})
    for (const double delay_ms : delays_ms)
      add({delay_ms, usual_jitter_ms, usual_loss_percent}, sent_again);
  return table;
}

/// The figures, file name and drawing: of presses with everything at once, by delay.
std::vector<std::pair<std::string, std::string>> figures_of(const ControlTable& table) {
  telemetry::Plot error{.title = "error of a press by the delay between host and arms",
                        .x_label = "delay each way, ms, with 0.5 ms of jitter and 1 % of loss",
                        .y_label = "force error, N RMS",
                        .y_low = 0.0};
  telemetry::Plot ended = error;
  ended.title = "presses that ended by the delay between host and arms";
  ended.y_label = "presses that ended, %";
  ended.y_high = 100.0;
  for (const char* sent : {again, once}) {
    telemetry::Series line{
        .name = fmt::format("commands sent {}", sent),
        .colour = sent == once ? telemetry::palette::stop : telemetry::palette::ink};
    telemetry::Series share = line;
    for (const ControlRow& row : table.rows) {
      if (row.label("jitter_ms") == "0" || row.label("loss_percent") == "0") continue;
      if (row.label("commands_sent") != sent) continue;
      const ControlResult& result = row.result;
      share.x.push_back(std::stod(row.label("delay_ms")));
      share.y.push_back(100.0 * result.stopped / result.runs);
      if (result.stopped > 0) continue;  // the error of what was left out is not known
      line.x.push_back(share.x.back());
      line.y.push_back(result.rmse_n);
    }
    ended.series.push_back(std::move(share));
    if (!line.x.empty()) error.series.push_back(std::move(line));
  }
  error.x_low = 0.0, error.x_high = ended.series[0].x.back();
  error.series.push_back({.name = "target",
                          .x = {0.0, max_target_delay_ms},
                          .y = {max_rmse_n, max_rmse_n},
                          .colour = telemetry::palette::grey,
                          .dashed = true});
  return {{"armlink_error", telemetry::to_svg(error)}, {"armlink_ended", telemetry::to_svg(ended)}};
}

/// What delay, jitter and loss between tuina and its arms do to the force (docs/armlink.md).
class EvaluateArmlink final : public Verb {
 public:
  [[nodiscard]] const char* name() const override { return "evaluate armlink"; }
  [[nodiscard]] const char* summary() const override {
    return "delay, jitter and loss between tuina and its arms: force errors, and where it ends";
  }
  [[nodiscard]] const char* example() const override {
    return "tuina evaluate armlink --figures docs/figures";
  }
  void describe(Options& options) override {
    options.flag("--full", full_, "more delays, four seeds");
    options.add("--figures", figures_,
                "the figures armlink_error.svg and armlink_ended.svg into this folder");
    cells_.describe(options);
  }
  [[nodiscard]] Result<Answer> run(const CommonOptions& common) override {
    if (!figures_.empty() && !std::filesystem::is_directory(figures_))
      return fail(Fault::file, "the folder {} does not exist", figures_);
    const auto config = effective_config(common);
    if (!config) return tl::unexpected(config.error());
    if (auto opened = cells_.open(common, *config); !opened) return tl::unexpected(opened.error());
    std::vector<ControlTable> tables = {table_of(full_, common.seed)};
    for (ControlRow& row : tables[0].rows)
      for (ContactExperiment& experiment : row.runs) live_in(*config, experiment);
    const unsigned threads = std::clamp(std::thread::hardware_concurrency(), 1U, 8U);
    if (auto done = run_tables(tables, cells_, threads, progress_bar(common, "armlink")); !done)
      return tl::unexpected(done.error());
    return cells_.answer([&] { return answer(tables, common, *config); });
  }

 private:
  [[nodiscard]] Result<Answer> answer(const std::vector<ControlTable>& tables,
                                      const CommonOptions& common,
                                      const session::Config& config) const {
    if (!figures_.empty()) {
      for (const auto& [name, drawing] : figures_of(tables[0])) {
        const auto path = std::filesystem::path(figures_) / (name + ".svg");
        if (auto written = write_file(path, drawing); !written)
          return tl::unexpected(written.error());
      }
    }
    const telemetry::Table shown = shown_table(tables[0]);
    const nlohmann::ordered_json json = {{"seed", common.seed},
                                         {"full", full_},
                                         {"realism", config.simulation.realism},
                                         {"armlink", to_json(shown)}};
    return Answer{.json = json.dump(2), .text = to_text(shown)};
  }

  Cells cells_;
  bool full_ = false;
  std::string figures_;
};

}  // namespace

std::unique_ptr<Verb> make_evaluate_armlink() {
  return std::make_unique<EvaluateArmlink>();
}

}  // namespace tuina::app
