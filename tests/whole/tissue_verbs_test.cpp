// SPDX-License-Identifier: Apache-2.0
#include <doctest/doctest.h>
#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "tests/whole/command.hpp"
#include "tuina/core/io/csv.hpp"
#include "tuina/core/io/file.hpp"
#include "tuina/sim/press_scenarios.hpp"

using namespace tuina;
using tuina::test::Folder;
using tuina::test::run_tuina;

namespace {

constexpr TangentTissue hard{9.786, 185.4};

std::string press_csv(double peak_n = 60.0) {
  sim::PressScenario scenario{.name = "verb", .about = "", .duration_s = 2.0};
  Random random = make_random(3, "verb");
  std::string csv = "time_s,position_mm,force_n\n";
  for (const auto& sample : sim::simulate_presses(scenario, hard, peak_n, random).record) {
    csv += fmt::format("{:.3f},{:.5f},{:.4f}\n", sample.time_s, sample.press.depth_m * 1e3,
                       sample.press.force_n);
  }
  return csv;
}

std::string air_csv() {
  std::string csv = "time_s,position_mm,force_n\n";
  for (int i = 0; i < 500; ++i)
    csv += fmt::format("{:.3f},{:.3f},{:.3f}\n", i * 1e-3, -5.0 + i * 0.004, 0.05 * (i % 3));
  return csv;
}

}  // namespace

TEST_CASE("tissue fit and tissue estimate find the same tissue in a record") {
  const Folder folder;
  const auto path = folder.with("press.csv", press_csv());
  const auto fit = run_tuina({"tissue", "fit", path, "--plot", folder / "fit.svg", "--json"});
  REQUIRE(fit.exit_code == 0);
  CHECK(read_file(folder / "fit.svg").value().rfind("<svg", 0) == 0);
  const auto fitted = nlohmann::json::parse(fit.out);
  CHECK(fitted["alpha_n"].get<double>() == doctest::Approx(9.786).epsilon(0.03));
  CHECK(fitted["beta_per_mm"].get<double>() == doctest::Approx(0.1854).epsilon(0.03));
  CHECK(fitted["ci95"]["alpha_n"].get<double>() > 0.0);
  CHECK(fitted["rmse_n"].get<double>() > 0.0);

  const auto estimate = run_tuina({"tissue", "estimate", path, "--out", folder / "trace.csv",
                                   "--json", "--plot", folder / "estimate.svg", "--true-alpha-n",
                                   "9.786", "--true-beta-per-mm", "0.1854"});
  CHECK(read_file(folder / "estimate.svg").value().find("truth") != std::string::npos);
  REQUIRE(estimate.exit_code == 0);
  const auto estimated = nlohmann::json::parse(estimate.out);
  CHECK(estimated["converged"] == true);
  CHECK(estimated["converged_after_s"].get<double>() < 2.0);
  CHECK(estimated["presses"] == 2);
  CHECK(estimated["class"] == "hard");
  CHECK(estimated["alpha_n"].get<double>() == doctest::Approx(9.786).epsilon(0.05));
  const auto trace = read_csv(folder / "trace.csv", {"time_s", "alpha_n", "beta_per_mm",
                                                     "alpha_ci_n", "beta_ci_per_mm", "converged"});
  REQUIRE(trace.has_value());
  CHECK(trace->rows() == 2000);
  CHECK(trace->columns[1].back() ==
        doctest::Approx(estimated["alpha_n"].get<double>()).epsilon(1e-4));
}

TEST_CASE("a record without contact cannot be fitted, and an estimate says that it knows nothing") {
  const Folder folder;
  const auto path = folder.with("air.csv", air_csv());
  const auto fit = run_tuina({"tissue", "fit", path, "--json"});
  CHECK(fit.exit_code == 2);
  CHECK(fit.out.empty());
  CHECK(fit.err.find("no contact") != std::string::npos);
  const auto estimate = run_tuina({"tissue", "estimate", path, "--json"});
  CHECK(estimate.exit_code == 0);
  const auto estimated = nlohmann::json::parse(estimate.out);
  CHECK(estimated["converged"] == false);
  CHECK(estimated["converged_after_s"].is_null());
  CHECK(estimated["class"] == "unknown");
}

TEST_CASE("a record whose time goes back is refused with its line") {
  const Folder folder;
  const auto path =
      folder.with("back.csv", "time_s,position_mm,force_n\n0,0,0\n0.001,0,0\n0.0005,0,0\n");
  for (const char* verb : {"fit", "estimate"}) {
    const auto outcome = run_tuina({"tissue", verb, path, "--json"});
    CHECK(outcome.exit_code == 2);
    CHECK(outcome.out.empty());
    CHECK(outcome.err.find("back.csv:4") != std::string::npos);
  }
}

TEST_CASE(
    "numbers out of range and unknown methods are wrong use, a trace that cannot be written is "
    "not") {
  const Folder folder;
  const auto path = folder.with("press.csv", press_csv());
  CHECK(run_tuina({"tissue", "fit", path, "--force-noise-n", "nan"}).exit_code == 1);
  CHECK(run_tuina({"tissue", "fit", path, "--force-noise-n", "-1"}).exit_code == 1);
  CHECK(run_tuina({"tissue", "estimate", path, "--method", "guess"}).exit_code == 1);
  const auto unwritable =
      run_tuina({"tissue", "estimate", path, "--out", folder / "no/such/trace.csv", "--json"});
  CHECK(unwritable.exit_code == 2);
  CHECK(unwritable.out.empty());
}

TEST_CASE("the method of the thesis answers in the same keys, without intervals") {
  const Folder folder;
  const auto path = folder.with("press.csv", press_csv());
  const auto outcome = run_tuina({"tissue", "estimate", path, "--method", "thesis", "--json"});
  REQUIRE(outcome.exit_code == 0);
  const auto estimated = nlohmann::json::parse(outcome.out);
  CHECK(estimated["converged"] == false);
  CHECK(estimated["ci95"]["alpha_n"].is_null());
  CHECK(estimated["presses"] == 2);
}
