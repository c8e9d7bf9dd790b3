// SPDX-License-Identifier: Apache-2.0
// A campaign in pieces: `evaluate ... --shard` and `evaluate merge`.
#include <doctest/doctest.h>

#include <algorithm>
#include <sstream>

#include "tests/whole/command.hpp"
#include "tuina/core/io/file.hpp"

using tuina::read_file;
using tuina::test::Folder;
using tuina::test::run_tuina;

namespace {

const std::vector<std::string> campaign = {"evaluate",     "tissue", "--scenario", "N0",
                                           "--runs",       "2",      "--arm-runs", "0",
                                           "--world-runs", "0"};

std::vector<std::string> with(std::vector<std::string> words,
                              const std::vector<std::string>& more) {
  words.insert(words.end(), more.begin(), more.end());
  return words;
}

/// The files of so many shards, done in any order.
std::vector<std::string> shards_in(const Folder& folder, int parts,
                                   const std::vector<std::string>& words = campaign) {
  std::vector<std::string> files;
  for (int part = parts; part >= 1; --part) {
    files.push_back(folder / (std::to_string(part) + ".cells"));
    const std::string shard = std::to_string(part) + "/" + std::to_string(parts);
    const auto done = run_tuina(with(words, {"--shard", shard, "--out", files.back()}));
    REQUIRE_MESSAGE(done.exit_code == 0, done.err);
  }
  return files;
}

/// Tables without what only says how long computing took.
std::string without_times(const std::string& json) {
  std::istringstream lines(json);
  std::string kept, line;
  while (std::getline(lines, line)) {
    if (line.find("plan_ms") == std::string::npos) kept += line + "\n";
  }
  return kept;
}

}  // namespace

TEST_CASE("shards in any order, and one of them twice, give the tables of one run") {
  const Folder folder;
  std::vector<std::string> files = shards_in(folder, 3);
  files.push_back(files.front());
  const auto whole = run_tuina(with(campaign, {"--json"}));
  REQUIRE(whole.exit_code == 0);
  const auto merged = run_tuina(with(with({"evaluate", "merge"}, files), {"--json"}));
  CHECK_MESSAGE(merged.exit_code == 0, merged.err);
  CHECK(merged.out == whole.out);
  // What was done twice is named; a shard may have no cell at all.
  if (read_file(files.front()).value().find("\n{") != std::string::npos)
    CHECK(merged.err.find("done more than once, counted once: N0 ") != std::string::npos);
}

TEST_CASE("walls and robots are cells, too") {
  for (const std::vector<std::string>& words :
       {std::vector<std::string>{"evaluate", "scanner", "--only", "walls", "--calibration", "drawn",
                                 "--scanners", "1"},
        {"evaluate", "robots", "--robots", "thesis", "--programmes", "relax"}}) {
    const Folder folder;
    const std::vector<std::string> files = shards_in(folder, 2, words);
    const auto whole = run_tuina(with(words, {"--json", "--quiet"}));
    REQUIRE_MESSAGE(whole.exit_code == 0, whole.err);
    const auto merged = run_tuina(with(with({"evaluate", "merge"}, files), {"--json", "--quiet"}));
    CHECK_MESSAGE(merged.exit_code == 0, merged.err);
    CHECK(without_times(merged.out) == without_times(whole.out));
    const auto lost = run_tuina({"evaluate", "merge", files.front()});
    CHECK(lost.exit_code == 2);
    CHECK(lost.err.find("are in none of the files") != std::string::npos);
  }
}

TEST_CASE("a cell that was lost is named, and its shard goes on where it ended") {
  const Folder folder;
  const std::string file = shards_in(folder, 1).front();
  const std::string all = read_file(file).value();
  // A run that was killed while it wrote the last cell.
  const std::string cut = folder.with("1.cells", all.substr(0, all.size() - 40));
  const auto merged = run_tuina({"evaluate", "merge", cut});
  CHECK(merged.exit_code == 2);
  CHECK(merged.out.empty());
  CHECK(merged.err.find("1 of 3 cells are in none of the files: N0 ") != std::string::npos);

  const auto again = run_tuina(with(campaign, {"--shard", "1/1", "--out", cut, "--json"}));
  CHECK(again.exit_code == 0);
  CHECK(read_file(cut).value() == all);
  CHECK(run_tuina({"evaluate", "merge", cut}).exit_code == 0);
}

TEST_CASE("what does not belong together is not joined") {
  const Folder folder;
  const std::string file = shards_in(folder, 1).front();
  const auto refused = [&](const std::string& other, const char* says) {
    const auto outcome = run_tuina({"evaluate", "merge", file, other});
    CHECK(outcome.exit_code == 2);
    CHECK_MESSAGE(outcome.err.find(says) != std::string::npos, outcome.err);
  };
  auto other = campaign;
  std::replace(other.begin(), other.end(), std::string("2"), std::string("3"));
  const std::string of_three = folder / "three.cells";
  REQUIRE(run_tuina(with(other, {"--shard", "1/1", "--out", of_three})).exit_code == 0);
  refused(of_three, "three.cells:1: holds cells of another command line");
  refused(folder.with("foreign.cells", "hello\n"), "foreign.cells:1: is no file of");
  const std::string good = read_file(file).value();
  refused(folder.with("odd.cells", good + "{\"cell\": 3}\n"), "odd.cells:5: is no cell");
  refused(folder / "missing.cells", "missing.cells");
  for (const char* shard : {"0/3", "4/3", "a/b", "1", "1/0", "-1/2"})
    CHECK(run_tuina(with(campaign, {"--shard", shard, "--out", folder / "x"})).exit_code == 1);
  CHECK(run_tuina(with(campaign, {"--shard", "1/2"})).exit_code == 1);
}
