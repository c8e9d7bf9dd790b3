// SPDX-License-Identifier: Apache-2.0
#include <nlohmann/json.hpp>

#include "apps/cli/table.hpp"
#include "apps/tuina/history/open.hpp"
#include "apps/tuina/verbs.hpp"
#include "tuina/core/io/file.hpp"
#include "tuina/history/fleet_page.hpp"

namespace tuina::app {
namespace {

/// All robots that tell a history what they do.
class ShowFleet final : public Verb {
 public:
  [[nodiscard]] const char* name() const override { return "fleet"; }
  [[nodiscard]] const char* summary() const override {
    return "the robots of a practice: what they do, stops, sensors and accuracy over time";
  }
  [[nodiscard]] const char* example() const override {
    return "tuina fleet --history postgresql://toni@clinic/tuina --out fleet.html";
  }
  void describe(Options& options) override {
    add_history_option(options, address_);
    options.add("--out", out_, "one self-contained HTML page");
  }
  [[nodiscard]] Result<Answer> run(const CommonOptions&) override {
    if (const auto good = check_folder_of(out_); !good) return tl::unexpected(good.error());
    auto history = open_known_history(address_);
    if (!history) return tl::unexpected(history.error());
    const auto fleet = history::fleet_of(history->database());
    if (!fleet) return tl::unexpected(fleet.error());
    const std::string now = utc_now();
    const telemetry::Table table = history::fleet_table(*fleet, now);
    std::string text =
        fleet->empty() ? "no robot has told anything yet: `tuina serve --history`" : to_text(table);
    if (!out_.empty()) {
      if (auto written = write_file(out_, history::fleet_page(*fleet, now)); !written)
        return tl::unexpected(written.error());
      text += "\npage: " + out_;
    }
    return Answer{.json = nlohmann::ordered_json{{"at", now}, {"robots", to_json(table)}}.dump(2),
                  .text = text};
  }

 private:
  std::string address_, out_;
};

}  // namespace

std::unique_ptr<Verb> make_fleet() {
  return std::make_unique<ShowFleet>();
}

}  // namespace tuina::app
