// SPDX-License-Identifier: Apache-2.0
#include <nlohmann/json.hpp>

#include "apps/tuina/verbs.hpp"
#include "tuina/core/io/file.hpp"
#include "tuina/record/languages.hpp"
#include "tuina/record/session_folder.hpp"
#include "tuina/record/session_report.hpp"
#include "tuina/telemetry/report/page.hpp"

namespace tuina::app {
namespace {

/// The page of a session once more, from its record.
class Report final : public Verb {
 public:
  [[nodiscard]] const char* name() const override { return "report"; }
  [[nodiscard]] const char* summary() const override {
    return "the page of a recorded session, made again from its folder or its session.mcap";
  }
  [[nodiscard]] const char* example() const override {
    return "tuina massage --out my-report\n  tuina report my-report --out page.html";
  }
  void describe(Options& options) override {
    options.add("record", record_, "the folder of `tuina massage --out`, or the session.mcap in it")
        .required();
    options.add("--out", out_, "one self-contained HTML page").required();
    options
        .add("--language", language_,
             "in which it is written: en, or zh-Hant (Traditional Chinese)")
        .show_default();
  }

  [[nodiscard]] Result<Answer> run(const CommonOptions&) override {
    auto language = record::find_language(language_);
    if (!language) return tl::unexpected(language.error());
    const auto folder = record::SessionFolder::open(record_);
    if (!folder) return tl::unexpected(folder.error());
    auto data = record::read_record(folder->path());
    if (!data) return tl::unexpected(folder->explained(data.error()));
    data->language = std::move(*language);
    const std::string page = telemetry::report_page(*data);
    if (const auto written = write_file(out_, page); !written)
      return tl::unexpected(written.error());
    const nlohmann::ordered_json json = {{"page", out_},
                                         {"bytes", page.size()},
                                         {"person", data->person},
                                         {"paths", data->paths.size()},
                                         {"decisions", data->decisions.size()},
                                         {"stops", data->stops.size()}};
    return Answer{.json = json.dump(2), .text = fmt::format("{}: {} kB", out_, page.size() / 1000)};
  }

 private:
  std::string record_, out_, language_ = "en";
};

}  // namespace

std::unique_ptr<Verb> make_report() {
  return std::make_unique<Report>();
}

}  // namespace tuina::app
