// SPDX-License-Identifier: Apache-2.0
#include <doctest/doctest.h>
#include <unistd.h>

#include <filesystem>

#include "tests/folder.hpp"
#include "tests/history/some_visit.hpp"
#include "tests/reason.hpp"
#include "tuina/history/history.hpp"

using namespace tuina;
using namespace tuina::history;

namespace {

void keep_a_visit(const std::string& address) {
  auto history = History::open(address);
  REQUIRE(history);
  REQUIRE(history->add(test::visit_at("a", "2026-01-02T10:00:00Z", 1.0)));
}

}  // namespace

TEST_CASE("who may only read a history reads it, and is told that it cannot be written") {
  const test::Folder folder;
  const std::string address = folder / "ward #1 100%.sqlite";
  keep_a_visit(address);
  namespace fs = std::filesystem;
  using fs::perms;
  constexpr perms all_read = perms::owner_read | perms::group_read | perms::others_read;
  fs::permissions(address, all_read);
  fs::permissions(folder.path(),
                  all_read | perms::owner_exec | perms::group_exec | perms::others_exec);
  const bool mighty = ::geteuid() == 0;  // who may do everything becomes nobody
  constexpr ::uid_t nobody = 65534;
  if (mighty) REQUIRE(::seteuid(nobody) == 0);
  {
    auto history = History::open(address);
    const auto visits = history ? history->visits_of("anna")
                                : Result<std::vector<Visit>>(tl::unexpected(history.error()));
    const auto refused =
        history ? history->add(test::visit_at("b", "2026-01-03T10:00:00Z", 1.0)) : Result<void>();
    if (mighty) REQUIRE(::seteuid(0) == 0);
    REQUIRE_MESSAGE(visits, test::reason(visits));
    CHECK(visits->size() == 1);
    REQUIRE_FALSE(refused);
    CHECK(refused.error().message.find("readonly") != std::string::npos);
  }
  fs::permissions(folder.path(), perms::owner_all);
}

TEST_CASE("a history that was cut is refused with the way to another one") {
  const test::Folder folder;
  const std::string address = folder / "history.sqlite";
  keep_a_visit(address);
  std::filesystem::resize_file(address, std::filesystem::file_size(address) / 3);
  auto cut = History::open(address);
  const std::string said = cut ? test::reason(cut->visits_of("anna")) : test::reason(cut);
  CHECK_MESSAGE(said.find("tuina history rebuild") != std::string::npos, said);
}
