// SPDX-License-Identifier: Apache-2.0
// Whole massages of labelled people of another modeller, whom no table of tuina has seen.
#include <doctest/doctest.h>
#include <fmt/format.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "tests/whole/command.hpp"

using nlohmann::json;
using tuina::test::Folder;
using tuina::test::run_tuina;

TEST_CASE("people who sit and people who lie are massaged from neck to loin without a stop") {
  const std::filesystem::path bodies = std::filesystem::path(TUINA_BODIES) / "dev";
  if (!std::filesystem::exists(bodies)) {
    MESSAGE("skipped: no labelled bodies in " << bodies.string());
    return;
  }
  for (const std::string name : {"ds01", "ds05", "dp01", "dp05"}) {
    CAPTURE(name);
    const Folder folder;
    const auto outcome = run_tuina({"massage", "--person", bodies / (name + ".ply"), "--json",
                                    "--quiet", "--out", folder / "out"});
    CHECK_MESSAGE(outcome.exit_code == 0, outcome.err);
    if (outcome.out.empty()) continue;
    const json session = json::parse(outcome.out);
    const json& force = session["massage"]["force"];
    MESSAGE(fmt::format("{}: acupoints {:.1f} mm off, force {:.2f} N RMS, peak {:.1f} N, {} paths",
                        name, session["acupoints"]["mean_error_mm"].get<double>(),
                        force["rmse_n"].get<double>(), force["peak_n"].get<double>(),
                        session["massage"]["performed"].size()));
    CHECK(session["position"] == (name[1] == 's' ? "sitting" : "prone"));
    CHECK(session["stops"].empty());
    CHECK(session["acupoints"]["mean_error_mm"] < 25.0);
    CHECK(force["rmse_n"] < 1.5);
    CHECK(force["peak_n"] < 45.0);
    int presses = 0;
    for (const json& path : session["massage"]["performed"]) {
      presses += path["name"].get<std::string>().starts_with("press ") ? 1 : 0;
    }
    CHECK(presses == 7);
  }
}
