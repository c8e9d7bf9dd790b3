// SPDX-License-Identifier: Apache-2.0
#include <doctest/doctest.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "tests/whole/command.hpp"
#include "tuina/core/io/csv.hpp"
#include "tuina/core/io/file.hpp"

using nlohmann::json;
using tuina::test::Folder;
using tuina::test::run_tuina;

namespace {

const std::vector<std::string> columns = {"time_s", "target_n", "true_force_n", "measured_force_n",
                                          "depth_mm"};

std::vector<std::string> press(std::vector<std::string> more) {
  more.insert(more.begin(), {"press", "--json", "--quiet", "--duration-s", "4"});
  return more;
}

}  // namespace

TEST_CASE("what a press has felt is a record that tissue fits and estimates") {
  const Folder folder;
  const std::string felt = folder / "felt.csv";
  const auto pressed = run_tuina({"press", "--alpha-n", "6", "--beta-per-mm", "0.2", "--force-n",
                                  "20", "--set", "simulation.realism=ideal", "--torso-n-per-mm",
                                  "rigid", "--felt", felt, "--quiet"});
  REQUIRE_MESSAGE(pressed.exit_code == 0, pressed.err);
  const auto fitted = run_tuina({"tissue", "fit", felt, "--json", "--quiet"});
  REQUIRE_MESSAGE(fitted.exit_code == 0, fitted.err);
  CHECK(json::parse(fitted.out)["alpha_n"].get<double>() == doctest::Approx(6.0).epsilon(0.1));
  const auto estimated = run_tuina({"tissue", "estimate", felt, "--json", "--quiet"});
  REQUIRE_MESSAGE(estimated.exit_code == 0, estimated.err);
  CHECK(json::parse(estimated.out)["presses"] >= 1);
}

TEST_CASE("the truth of a press is the first loading, which a tangent is only in an ideal world") {
  const auto truth_in = [](const char* world) {
    const auto outcome =
        run_tuina({"press", "--tissue", "hard", "--force-n", "30", "--seed", "3", "--set",
                   std::string("simulation.realism=") + world, "--json", "--quiet"});
    REQUIRE_MESSAGE(outcome.exit_code == 0, outcome.err);
    return json::parse(outcome.out);
  };
  const json ideal = truth_in("ideal"), usual = truth_in("usual");
  CHECK(ideal["true"]["alpha_n"].get<double>() == doctest::Approx(9.786));
  CHECK(ideal["true"]["beta_per_mm"].get<double>() == doctest::Approx(0.1854));
  CHECK(ideal["torso_n_per_mm"] == 35.0);
  // Layers that relax are softer at first and stiffer later than the tangent of the place.
  CHECK(usual["true"]["alpha_n"].get<double>() > 1.2 * 9.79);
  CHECK(usual["true"]["beta_per_mm"].get<double>() < 0.9 * 0.1854);
}

TEST_CASE("press answers with force, estimate, truth and stops, and its trace says the same") {
  const Folder folder;
  const auto outcome = run_tuina(press({"--alpha-n", "6", "--beta-per-mm", "0.2", "--force-n", "25",
                                        "--surface-error-mm", "3", "--out", folder / "trace.csv"}));
  REQUIRE_MESSAGE(outcome.exit_code == 0, outcome.err);
  CHECK(outcome.err.empty());
  const json answer = json::parse(outcome.out);
  CHECK(answer["true"]["alpha_n"].is_number());
  CHECK(answer["true"]["beta_per_mm"].is_number());
  CHECK(answer["stops"] == json::array());
  CHECK(answer["estimate"]["alpha_n"].is_number());
  CHECK(answer["estimate"]["beta_per_mm"].is_number());
  CHECK(answer["estimate"].contains("converged_after_s"));

  const std::string text = tuina::read_file(folder / "trace.csv").value();
  CHECK(text.starts_with("time_s,target_n,true_force_n,measured_force_n,depth_mm\n"));
  const auto trace = tuina::read_csv(folder / "trace.csv", columns).value();
  double squares = 0.0, count = 0.0, peak_n = 0.0, overshoot_n = 0.0;
  // The technique lasts from the first to the last row with a target.
  const auto ordered = [](double target_n) { return target_n > 0.0; };
  const auto& targets = trace.columns[1];
  const auto last = static_cast<std::size_t>(
      targets.rend() - std::find_if(targets.rbegin(), targets.rend(), ordered));
  const auto first = static_cast<std::size_t>(
      std::find_if(targets.begin(), targets.end(), ordered) - targets.begin());
  for (std::size_t i = 0; i < trace.rows(); ++i) {
    const double target_n = trace.columns[1][i], true_n = trace.columns[2][i];
    if (i > 0) CHECK(trace.columns[0][i] - trace.columns[0][i - 1] == doctest::Approx(1e-3));
    if (i < first || i >= last) continue;
    squares += (target_n - true_n) * (target_n - true_n);
    count += 1.0;
    peak_n = std::max(peak_n, true_n);
    overshoot_n = std::max(overshoot_n, true_n - target_n);
  }
  const json& force = answer["force"];
  const double told_n = force["rmse_n"], over_n = force["overshoot_n"];
  CHECK(told_n == doctest::Approx(std::sqrt(squares / count)).epsilon(1e-5));
  CHECK(force["peak_n"].get<double>() == doctest::Approx(peak_n).epsilon(1e-5));
  CHECK(over_n == doctest::Approx(overshoot_n).epsilon(1e-4));
  CHECK(force["settled_rmse_n"] <= force["rmse_n"]);
  CHECK(force["rmse_n"] < 2.0);
}

TEST_CASE("every option of press is heard") {
  const json plain = json::parse(run_tuina(press({"--force-n", "20"})).out);
  const std::vector<std::vector<std::string>> others = {
      {"--tissue", "soft"},        {"--technique", "tap"},        {"--controller", "thesis"},
      {"--surface-error-mm", "5"}, {"--torso-n-per-mm", "rigid"}, {"--torso-n-per-mm", "5"},
      {"--friction", "0"},         {"--breathing-mm", "8"},       {"--seed", "2"}};
  for (auto arguments : others) {
    arguments.insert(arguments.end(), {"--force-n", "20"});
    CAPTURE(arguments);
    const auto outcome = run_tuina(press(arguments));
    REQUIRE_MESSAGE(outcome.exit_code == 0, outcome.err);
    CHECK(json::parse(outcome.out)["force"] != plain["force"]);
  }
  json ways = json::array();
  for (const char* shape : {"circle", "ellipse", "spiral"}) {
    ways.push_back(json::parse(
        run_tuina(press({"--technique", "rub", "--rub-shape", shape, "--force-n", "20"})).out));
    CHECK(ways.back()["force"]["rmse_n"] < 2.0);
  }
  CHECK(ways[0]["force"] != ways[1]["force"]);
  CHECK(ways[1]["force"] != ways[2]["force"]);
}

TEST_CASE("press tells what happens when the person moves") {
  const auto moved = [](std::vector<std::string> more) {
    more.insert(more.end(), {"--force-n", "40"});
    const auto outcome = run_tuina(press(std::move(more)));
    CHECK(outcome.exit_code == 4);
    return json::parse(outcome.out);
  };
  const json rises = moved({"--rise-mm", "30"});
  CHECK(rises["highest_force_n"] > 45.0);
  CHECK(rises["highest_force_n"] < 75.0);
  CHECK(rises["stops"].size() == 1);
  const json leaves = moved({"--rise-mm", "-50", "--shift-mm-per-s", "500"});
  CHECK(leaves["stops"][0]["cause"] == "contact lost");
  CHECK(leaves["fastest_tool_mm_per_s"] < 250.0);
  CHECK(leaves["second_impact_n"] < 30.0);
  const json gently =
      moved({"--rise-mm", "60", "--shift-mm-per-s", "400", "--shift-m-per-s2", "5"});
  const json jumps = moved({"--rise-mm", "60", "--shift-mm-per-s", "400"});
  CHECK(gently["highest_force_n"] < jumps["highest_force_n"]);
  const auto slides = run_tuina(press({"--slide-mm", "50", "--force-n", "40"}));
  CHECK(slides.exit_code == 0);
}

TEST_CASE("the same seed gives the same press, to the last digit") {
  const Folder folder;
  const auto once = run_tuina(press({"--force-n", "20", "--seed", "7", "--out", folder / "a.csv"}));
  const auto twice =
      run_tuina(press({"--force-n", "20", "--seed", "7", "--out", folder / "b.csv"}));
  CHECK(once.out == twice.out);
  CHECK(tuina::read_file(folder / "a.csv").value() == tuina::read_file(folder / "b.csv").value());
}

TEST_CASE("press refuses what cannot be pressed before it presses") {
  const Folder folder;
  const std::string trace = folder / "trace.csv";
  const std::vector<std::pair<int, std::vector<std::string>>> cases = {
      {1, {}},
      {1, {"--force-n", "nan"}},
      {1, {"--force-n", "0"}},
      {1, {"--force-n", "1e9"}},
      {1, {"--force-n", "20", "--tissue", "steel"}},
      {1, {"--force-n", "20", "--tissue", "hard", "--alpha-n", "5", "--beta-per-mm", "0.2"}},
      {1, {"--force-n", "20", "--alpha-n", "5"}},
      {1, {"--force-n", "20", "--torso-n-per-mm", "soft"}},
      {1, {"--force-n", "20", "--friction", "-1"}},
      {1, {"--force-n", "20", "--seed", "99999999999999999999999"}},
      {2, {"--force-n", "20", "--plot", folder / "no/plot.svg"}}};
  for (auto [exit_code, arguments] : cases) {
    arguments.insert(arguments.end(), {"--json", "--out", trace});
    arguments.insert(arguments.begin(), "press");
    CAPTURE(arguments);
    const auto outcome = run_tuina(arguments);
    CHECK(outcome.exit_code == exit_code);
    CHECK(outcome.out.empty());
    CHECK(std::count(outcome.err.begin(), outcome.err.end(), '\n') <= 2);
    CHECK_FALSE(outcome.err.empty());
    CHECK_FALSE(std::filesystem::exists(trace));
  }
}
