// SPDX-License-Identifier: Apache-2.0
#include <doctest/doctest.h>

#include <nlohmann/json.hpp>

#include "tests/whole/command.hpp"
#include "tuina/core/io/file.hpp"

using tuina::test::Folder;
using tuina::test::run_tuina;

TEST_CASE("the documented command makes the shipped atlas again, byte for byte") {
  const Folder folder;
  const auto learned = run_tuina({"atlas", "learn", "--phantoms", "40", "--seed", "1", "--scan",
                                  "ideal", "--out", folder / "atlas.tuina", "--json", "--quiet"});
  REQUIRE_MESSAGE(learned.exit_code == 0, learned.err);
  CHECK(nlohmann::json::parse(learned.out)["leave_one_out_mm"] < 6.0);
  const std::string shipped = tuina::read_file(TUINA_SOURCE_DIR "/models/atlas.tuina").value();
  const bool same = tuina::read_file(folder / "atlas.tuina").value() == shipped;
  CHECK(same);
  CHECK(shipped.size() < 1'000'000);
}
