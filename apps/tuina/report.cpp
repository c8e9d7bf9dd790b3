// SPDX-License-Identifier: Apache-2.0
#include <nlohmann/json.hpp>

#include "apps/tuina/verbs.hpp"
#include "tuina/core/io/file.hpp"
#include "tuina/record/session_report.hpp"
#include "tuina/telemetry/report/page.hpp"

namespace tuina::app {
namespace {

/// The page of a session once more, from its record.
class Report final : public Verb {
 public:
  [[nodiscard]] const char* name() const override { return "report"; }
  [[nodiscard]] const char* summary() const override {
    return "the page of a recorded session, made again from its folder";
  }
  [[nodiscard]] const char* example() const override {
    return "tuina massage --out my-report\n  tuina report my-report --out page.html";
  }
  void describe(Options& options) override {
    options.add("folder", folder_, "of `tuina massage --out`").required();
    options.add("--out", out_, "one self-contained HTML page").required();
  }

  [[nodiscard]] Result<Answer> run(const CommonOptions&) override {
    const auto data = record::read_record(folder_);
    if (!data) return tl::unexpected(data.error());
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
  std::string folder_, out_;
};

}  // namespace

std::unique_ptr<Verb> make_report() {
  return std::make_unique<Report>();
}

}  // namespace tuina::app
