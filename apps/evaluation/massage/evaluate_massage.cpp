// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>

#include "apps/cli/table.hpp"
#include "apps/evaluation/cells.hpp"
#include "apps/evaluation/massage/page.hpp"
#include "apps/evaluation/verbs.hpp"
#include "tuina/core/io/file.hpp"
#include "tuina/core/random.hpp"

namespace tuina::app {
namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

/// Many whole sessions against the truth: of every programme on every labelled body, or of
/// simulated people drawn at random.
class EvaluateMassage final : public Verb {
 public:
  EvaluateMassage() {
    for (const auto& programme : massage::shipped_programmes())
      programmes_.emplace_back(programme.name);
  }
  [[nodiscard]] const char* name() const override { return "evaluate massage"; }
  [[nodiscard]] const char* summary() const override {
    return "whole sessions judged: forces, distances, points, stops";
  }
  [[nodiscard]] const char* example() const override {
    return "tuina evaluate massage --sessions 100 --adaptive both --html massages.html\n"
           "  tuina evaluate massage --bodies people --seeds 2";
  }
  void describe(Options& options) override {
    auto bodies = options.add("--bodies", bodies_,
                              "a folder of labelled bodies: every programme on every one");
    options.add("--seeds", seeds_, "for every body and programme")
        .between(1, 1000)
        .needs(bodies)
        .show_default();
    options
        .add("--sessions", sessions_,
             "of people drawn at random, one programme after the other; session n has the seed "
             "--seed and n more")
        .between(1, 100000)
        .excludes(bodies)
        .show_default();
    options.add("--programmes", programmes_, "shipped ones or files").delimiter(',').show_default();
    options.add("--atlas", atlas_, "as for `map`; else the shipped one");
    options
        .add("--adaptive", adaptive_, "both: every session with steering by the tissue and without")
        .one_of({"on", "off", "both"})
        .show_default();
    options.add("--html", html_, "the tables and plots as a page");
    options.add("--keep", keep_,
                "a file of judged sessions: those in it are not given again, the others are "
                "added, so that many sessions may be judged in pieces");
    cells_.describe(options);
  }

  [[nodiscard]] Result<Answer> run(const CommonOptions& common) override {
    const auto config = effective_config(common);
    if (!config) return tl::unexpected(config.error());
    if (const auto good = check_folder_of(html_); !good) return tl::unexpected(good.error());
    for (const std::string& programme : programmes_) {
      if (const auto known = massage::load_programme(programme); !known)
        return tl::unexpected(known.error());
    }
    auto trials = bodies_.empty() ? Result<std::vector<SessionTrial>>(drawn(common.seed))
                                  : everybody(common.seed);
    if (!trials) return tl::unexpected(trials.error());
    if (adaptive_ == "both") {
      const std::size_t count = trials->size();
      for (std::size_t i = 0; i < count; ++i) {
        trials->push_back((*trials)[i]);
        trials->back().order.adaptive = false;
      }
    }
    if (!keep_.empty()) cells_.keep(keep_, {"massage", atlas_});
    if (auto opened = cells_.open(common, *config); !opened) return tl::unexpected(opened.error());
    const auto outcomes =
        run_session_trials(*trials, *config, cells_, progress_bar(common, "massages"));
    if (!outcomes) return tl::unexpected(outcomes.error());
    return cells_.answer([&] { return answer(*trials, *outcomes); });
  }

 private:
  [[nodiscard]] std::vector<SessionTrial> drawn(std::uint64_t seed) const {
    constexpr std::array people = {"phantom:slim", "phantom:medium", "phantom:hefty"};
    std::vector<SessionTrial> trials;
    // The person and programme of a session depend on its own seed alone: pieces make the whole.
    for (int i = 0; i < sessions_; ++i) {
      const auto k = static_cast<std::size_t>(i);
      Random random = make_random(seed + k, "whose session");
      const auto person = static_cast<std::size_t>(uniform(random, 0.0, 2.999));
      const bool sitting = uniform(random, 0.0, 1.0) < 0.5;
      trials.push_back(
          {.order = order(people[person], programmes_[(seed + k - 1) % programmes_.size()]),
           .seed = seed + k});
      trials.back().order.position = sitting ? BodyPosture::sitting : BodyPosture::prone;
    }
    return trials;
  }

  [[nodiscard]] Result<std::vector<SessionTrial>> everybody(std::uint64_t seed) const {
    std::error_code fault;
    std::vector<std::string> files;
    for (const auto& entry : fs::directory_iterator(bodies_, fault)) {
      if (entry.path().extension() == ".ply") files.push_back(entry.path().string());
    }
    if (files.empty()) return fail(Fault::file, "{}: no labelled bodies (*.ply)", bodies_);
    std::sort(files.begin(), files.end());
    std::vector<SessionTrial> trials;
    for (const std::string& programme : programmes_) {
      for (const std::string& file : files) {
        for (int i = 0; i < seeds_; ++i) {
          trials.push_back(
              {.order = order(file, programme), .seed = seed + static_cast<std::uint64_t>(i)});
        }
      }
    }
    return trials;
  }

  [[nodiscard]] SessionOrder order(const std::string& person, const std::string& programme) const {
    return {
        .person = person, .programme = programme, .atlas = atlas_, .adaptive = adaptive_ != "off"};
  }

  [[nodiscard]] Result<Answer> answer(const std::vector<SessionTrial>& trials,
                                      const std::vector<SessionOutcome>& outcomes) const {
    const auto rows_of = [&](const std::string& name, const auto& wanted) {
      std::vector<const SessionOutcome*> chosen;
      for (std::size_t i = 0; i < trials.size(); ++i) {
        if (wanted(trials[i].order)) chosen.push_back(&outcomes[i]);
      }
      return SessionRow{name, summarise(chosen)};
    };
    const bool steered = adaptive_ != "off";
    std::vector<SessionRow> rows, adaptive;
    for (const std::string& programme : programmes_) {
      rows.push_back(rows_of(programme, [&](const SessionOrder& order) {
        return order.programme == programme && order.adaptive == steered;
      }));
    }
    rows.push_back(
        rows_of("all", [&](const SessionOrder& order) { return order.adaptive == steered; }));
    if (adaptive_ == "both") {
      adaptive.push_back(rows_of("steered", [](const SessionOrder& o) { return o.adaptive; }));
      adaptive.push_back(rows_of("as planned", [](const SessionOrder& o) { return !o.adaptive; }));
    }
    std::vector<std::string> incidents;
    for (std::size_t i = 0; i < trials.size(); ++i) {
      const auto tell = [&](const std::string& what) {
        const SessionOrder& order = trials[i].order;
        incidents.push_back(fmt::format(
            "{}{}{} --seed {} --programme {}{}: {}", order.person,
            order.position ? " --position " : "", order.position ? name_of(*order.position) : "",
            trials[i].seed, order.programme, order.adaptive ? "" : " --adaptive off", what));
      };
      if (!outcomes[i].refused.empty()) tell("refused: " + outcomes[i].refused);
      for (const std::string& stop : outcomes[i].stops) tell("stopped: " + stop);
      for (const std::string& contact_fault : outcomes[i].troubles) tell(contact_fault);
      for (const std::string& beyond : outcomes[i].beyond) tell(beyond);
      for (const std::string& note : outcomes[i].left_out) tell(note);
    }
    std::vector<const SessionOutcome*> given;
    for (std::size_t i = 0; i < trials.size(); ++i) {
      if (trials[i].order.adaptive == steered) given.push_back(&outcomes[i]);
    }
    ordered_json json{{"massages", to_json_by_name(session_table(rows))},
                      {"given", to_json_by_name(given_table(given))},
                      {"felt", to_json_by_name(felt_table(given))},
                      {"incidents", incidents}};
    if (!adaptive.empty()) json["adaptive"] = to_json_by_name(session_table(adaptive));
    if (!html_.empty()) {
      std::vector<SessionOutcome> judged;
      for (std::size_t i = 0; i < trials.size(); ++i) {
        if (trials[i].order.adaptive == steered) judged.push_back(outcomes[i]);
      }
      const auto written = write_file(html_, session_page(rows, adaptive, judged, incidents));
      if (!written) return tl::unexpected(written.error());
    }
    std::string text = to_text(session_table(rows)) + "\n" + to_text(given_table(given)) + "\n" +
                       to_text(felt_table(given));
    if (!adaptive.empty()) text += "\n" + to_text(session_table(adaptive));
    for (const std::string& incident : incidents) text += incident + "\n";
    return Answer{.json = json.dump(2), .text = text};
  }

  std::string bodies_, atlas_, html_, keep_, adaptive_ = "on";
  std::vector<std::string> programmes_;
  int seeds_ = 1;
  int sessions_ = 20;
  Cells cells_;
};

}  // namespace

std::unique_ptr<Verb> make_evaluate_massage() {
  return std::make_unique<EvaluateMassage>();
}

}  // namespace tuina::app
