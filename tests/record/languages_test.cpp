// SPDX-License-Identifier: Apache-2.0
#include "tuina/record/languages.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cctype>
#include <set>

#include "tests/reason.hpp"
#include "tests/telemetry/sample_report.hpp"
#include "tests/telemetry/words.hpp"
#include "tuina/telemetry/report/page.hpp"

using namespace tuina;
using tests::holds;

namespace {

/// The made-up session of the report's own tests, with all that can be said besides.
telemetry::ReportData full_report() {
  telemetry::ReportData data = tests::sample_report();
  data.person = "phantom:slim";
  data.programme = "relax";
  data.version = "";
  data.numbers = {{"scan error", "0.42", "mm", "RMS distance of the scan from the true surface"}};
  data.config_toml = "";
  data.paths[0].ordered_n = data.paths[0].given_n = 18.0;
  data.paths[0].lowered_by = sentence("by_zone", "{}", "kidney");
  data.paths[1].ordered_n = 20.0;
  data.paths[1].why = sentence("why_asked", "the person asked for it: {}", "softer");
  data.paths[2].contact_fault = "no skin found";
  data.plan_notes = {sentence("note_lowered", "{}: {:.1f} N lowered to {:.1f} N ({})",
                              "press BL50_L", 22.0, 8.0, "kidney")};
  data.decisions = {{.time_s = 9.8,
                     .arm = Arm::right,
                     .path = "press GV4",
                     .rule = "A3",
                     .reason = "the person guards",
                     .key = "why_guarding",
                     .from_n = 22.0,
                     .to_n = 17.5}};
  data.distances = {{0.0, 0.2, 0.15, 0.3, 0.1}, {1.0, 0.08, 0.09, 0.25, 0.07}};
  data.stops = {{12.345, sentence("stopped_arm_by", "{} arm: {}", "left", "force over the trip")}};
  return data;
}

/// What a reader sees of a report, but for GV4, which has a name of its own in Chinese.
std::string read(const std::string& page) {
  const std::size_t begin = page.find("<style>"), end = page.find("</style>");
  std::string words = tests::words_of(page.substr(0, begin) + page.substr(end));
  for (auto at = words.find("GV4"); at != std::string::npos; at = words.find("GV4", at))
    words.erase(at, 3);
  return words;
}

/// Runs of letters or of digits, as often as they stand there.
std::multiset<std::string> runs(const std::string& text, int (*of)(int), std::size_t min_length) {
  std::multiset<std::string> found;
  std::string run;
  for (const char letter : text + " ") {
    const auto code = static_cast<unsigned char>(letter);
    if (code < 0x80 && of(code) != 0) {
      run += letter;
    } else {
      if (run.size() >= min_length) found.insert(run);
      run.clear();
    }
  }
  return found;
}

}  // namespace

TEST_CASE("a report in Chinese has no English words, and every number of the English one") {
  telemetry::ReportData data = full_report();
  const std::string english = read(telemetry::report_page(data));
  const auto language = record::find_language("zh-TW");
  REQUIRE_MESSAGE(language.has_value(), test::reason(language));
  data.language = *language;
  const std::string page = telemetry::report_page(data);
  CHECK(holds(page, "<html lang=\"zh-Hant\">"));
  const std::string chinese = read(page);
  std::multiset<std::string> words = runs(chinese, std::isalpha, 3);
  for (const char* kept : {"tuina", "min", "tan"}) words.erase(kept);
  const std::string left(words.empty() ? "" : *words.begin());
  CHECK_MESSAGE(words.empty(), left);
  CHECK(runs(chinese, std::isdigit, 1) == runs(english, std::isdigit, 1));
  for (const char* said : {"因腎區而降低", "應要求：輕一點", "右臂，按 SI11_R：找不到皮膚",
                           "按 BL50_L：力量由 22.0 N 降為 8.0 N（腎區）。", "組織變硬了",
                           "第 12.345 秒：左臂：力量超過跳脫值", "魂門 ±", "BL47 左"}) {
    CAPTURE(said);
    CHECK(holds(chinese, said));
  }
}

TEST_CASE("a language without messages is refused with those that there are") {
  CHECK(record::find_language("en").value().tag() == "en");
  CHECK(record::find_language("zh-Hant").value().tag() == "zh-Hant");
  CHECK(test::reason(record::find_language("fr")) ==
        "language fr: there are en (English) and zh-Hant (Traditional Chinese)");
}
