// SPDX-License-Identifier: Apache-2.0
#include <doctest/doctest.h>
#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "tests/whole/command.hpp"
#include "tuina/core/io/csv.hpp"
#include "tuina/core/io/file.hpp"
#include "tuina/sim/press_scenarios.hpp"
#include "tuina/sim/tissue_worlds.hpp"

using namespace tuina;
using tuina::test::Folder;
using tuina::test::run_tuina;

namespace {

constexpr TangentTissue hard{9.786, 185.4};

std::string press_csv(
    double (*written)(double mm) = [](double mm) { return mm; }, double per_newton = 1.0,
    double per_second = 1.0) {
  sim::PressScenario scenario{.name = "verb", .about = "", .duration_s = 2.0};
  Random random = make_random(3, "verb");
  std::string csv = "time_s,position_mm,force_n\n";
  for (const auto& sample : sim::simulate_presses(scenario, hard, 60.0, random).record) {
    csv += fmt::format("{:.3f},{:.6g},{:.4f}\n", per_second * sample.time_s,
                       written(sample.press.depth_m * 1e3), per_newton * sample.press.force_n);
  }
  return csv;
}

struct NextPress {
  std::string record, next;  // as files; of the next press the forces are given up to 1.5 N
  std::vector<tissue::TimedPress> truth;  // from there on
};

NextPress next_press() {
  Random random = make_random(11, "next press");
  const auto world = std::find_if(sim::tissue_worlds().begin(), sim::tissue_worlds().end(),
                                  [](const auto& known) { return known.name == "qlv30"; });
  const auto presses = sim::press_in_world(*world, sim::Pressing::swells, hard, random);
  NextPress out{"time_s,position_mm,force_n\n", "time_s,position_mm,force_n\n", {}};
  bool met = false;
  for (std::size_t i = 0; i < presses.record.size(); ++i) {
    const auto& [time_s, press] = presses.record[i];
    met = met || (i >= presses.last_press && press.force_n > 1.5);
    (i < presses.last_press ? out.record : out.next) +=
        fmt::format("{:.3f},{:.5f},{}\n", time_s, press.depth_m * 1e3,
                    met ? "" : fmt::format("{:.4f}", press.force_n));
    if (met) out.truth.push_back(presses.truth[i]);
  }
  return out;
}

std::string air_csv() {
  std::string csv = "time_s,position_mm,force_n\n";
  for (int i = 0; i < 500; ++i)
    csv += fmt::format("{:.3f},{:.3f},{:.3f}\n", i * 1e-3, -5.0 + i * 0.004, 0.05 * (i % 3));
  return csv;
}

}  // namespace

TEST_CASE(
    "a record in metres, grams or milliseconds, or with positions that fall as the tool goes "
    "deeper, is refused") {
  const Folder folder;
  const std::string metres =
      folder.with("metres.csv", press_csv([](double mm) { return 1e-3 * mm; }));
  const auto as_is = [](double mm) { return mm; };
  const std::string grams = folder.with("grams.csv", press_csv(as_is, 1000.0 / 9.81));
  const std::string ms = folder.with("ms.csv", press_csv(as_is, 1.0, 1000.0));
  const std::string outward = folder.with("outward.csv", press_csv([](double mm) { return -mm; }));
  const std::string turned =
      folder.with("turned.csv", press_csv([](double mm) { return -mm; }, -1.0));
  for (const char* verb : {"fit", "estimate"}) {
    CAPTURE(verb);
    const auto says = [&](const std::string& file, const char* told) {
      const auto outcome = run_tuina({"tissue", verb, file, "--json"});
      CAPTURE(outcome.err);
      CHECK(outcome.exit_code == 2);
      CHECK(outcome.out.empty());
      CHECK(outcome.err.find(file) != std::string::npos);
      CHECK(outcome.err.find(told) != std::string::npos);
    };
    says(metres, "are these metres? Millimetres are wanted");
    says(grams, "are these grams? Newtons are wanted");
    says(ms, "are these milliseconds?");
    says(outward, "a larger position must be a deeper one");
    says(turned, "both signs are turned");
  }
}

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
  CHECK(fitted["at_limit"] == false);

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

TEST_CASE("a fit that ends where the search does says so in its JSON") {
  const Folder folder;
  const auto path = folder.with("press.csv", press_csv([](double mm) { return 40.0 * mm; }));
  const auto fit = run_tuina({"tissue", "fit", path, "--json"});
  REQUIRE_MESSAGE(fit.exit_code == 0, fit.err);
  CHECK(nlohmann::json::parse(fit.out)["at_limit"] == true);
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

TEST_CASE("the force of the next press on tissue that relaxes is predicted, with its band") {
  const Folder folder;
  const NextPress press = next_press();
  const auto outcome = run_tuina({"tissue", "estimate", folder.with("press.csv", press.record),
                                  "--predict", folder.with("next.csv", press.next), "--predict-out",
                                  folder / "told.csv", "--json"});
  REQUIRE(outcome.exit_code == 0);
  CHECK(nlohmann::json::parse(outcome.out)["converged"] == true);
  const auto told =
      read_csv(folder / "told.csv", {"time_s", "force_n", "force_low_n", "force_high_n"});
  REQUIRE(told.has_value());
  REQUIRE(told->rows() == press.truth.size());
  double strongest_n = 0.0, strongest_told_n = 0.0, held = 0.0;
  for (std::size_t i = 0; i < told->rows(); ++i) {
    const double true_n = press.truth[i].press.force_n;
    CHECK(told->columns[0][i] == doctest::Approx(press.truth[i].time_s));
    strongest_n = std::max(strongest_n, true_n);
    strongest_told_n = std::max(strongest_told_n, told->columns[1][i]);
    held += told->columns[2][i] <= true_n && true_n <= told->columns[3][i];
  }
  CHECK(strongest_told_n == doctest::Approx(strongest_n).epsilon(0.05));
  CHECK(held > 0.9 * static_cast<double>(told->rows()));
}

TEST_CASE(
    "a next press that cannot be predicted is refused with file, line and what would be right") {
  const Folder folder;
  const auto record = folder.with("press.csv", press_csv());
  const auto refused = [&](const std::string& next, const std::string& with) {
    const auto outcome = run_tuina({"tissue", "estimate", record, "--predict",
                                    folder.with("next.csv", "time_s,position_mm,force_n\n" + next),
                                    "--predict-out", folder / "told.csv", "--json"});
    CHECK(outcome.exit_code == 2);
    CHECK(outcome.out.empty());
    CHECK_MESSAGE(outcome.err.find(with) != std::string::npos, outcome.err);
  };
  refused("3,0,\n3.001,0.00001,\n", "are these metres? Millimetres are wanted");
  refused("3,0,0.1\n3.001,0,0.1\n", "leave it empty where it is to be predicted");
  refused("3,0,0.1\n3.001,,\n", "next.csv:3: position_mm");
  refused("3,0,\n2.9,0,\n", "next.csv:3: time_s goes from 3 to 2.9");
  refused("1,0,0.1\n1.001,0,\n", "next.csv: the first time_s, 1, lies within the record");
  refused("3,0,x\n", "next.csv:2: force_n");
  CHECK(run_tuina({"tissue", "estimate", record, "--predict", record}).exit_code == 1);
}

TEST_CASE("what is said at a time does not change with what comes later") {
  const Folder folder;
  const std::string whole = press_csv();
  const auto rows_of = [&](const std::string& csv) {
    const auto outcome = run_tuina({"tissue", "estimate", folder.with("press.csv", csv), "--out",
                                    folder / "trace.csv", "--json"});
    REQUIRE(outcome.exit_code == 0);
    return read_file(folder / "trace.csv").value();
  };
  const std::string trace = rows_of(whole);
  for (const std::size_t rows : {20U, 700U, 1300U}) {
    std::size_t end = 0;
    for (std::size_t k = 0; k <= rows; ++k) end = whole.find('\n', end) + 1;
    const std::string cut = rows_of(whole.substr(0, end));
    CHECK(trace.compare(0, cut.size(), cut) == 0);
  }
}
