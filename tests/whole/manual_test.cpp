// SPDX-License-Identifier: Apache-2.0
#include <doctest/doctest.h>

#include <cstdlib>

#include "tests/whole/command.hpp"

namespace tuina {

using test::run_tuina;

TEST_CASE("bash completes verbs, verbs of a group and options") {
  const test::Folder folder;
  const auto script = run_tuina({"completion", "bash"});
  REQUIRE(script.exit_code == 0);
  const std::string asks = folder.with("asks.bash", script.out + R"bash(
ask() { COMP_WORDS=("$@"); COMP_CWORD=$(($# - 1)); COMPREPLY=(); _tuina; echo "${COMPREPLY[*]}"; }
[ "$(ask tuina mas)" = massage ] || exit 2
[ "$(ask tuina tissue '')" = "fit estimate --help" ] || exit 3
[ "$(ask tuina massage --person x --posi)" = --position ] || exit 4
[ "$(ask tuina atlas learn --pri)" = --prior ] || exit 5
)bash");
  CHECK(std::system(("bash " + asks).c_str()) == 0);
  CHECK(run_tuina({"completion", "zsh"}).out.starts_with("#compdef tuina\n"));
  CHECK(run_tuina({"completion", "fish"}).out.find("complete -c tuina -n") == 0);
  CHECK(run_tuina({"completion", "tcsh"}).exit_code == 1);
}

TEST_CASE("the manual has every verb that --help has, and no order to roff but its own") {
  const auto page = run_tuina({"manual"});
  REQUIRE(page.exit_code == 0);
  for (const char* verb : {"massage", "tissue fit", "history show", "atlas learn", "guard"})
    CHECK(page.out.find(std::string("\n.SS tuina ") + verb + "\n") != std::string::npos);
  std::size_t at = 0;
  while ((at = page.out.find("\n.", at)) != std::string::npos) {
    const std::string order = page.out.substr(at + 2, 2);
    CHECK_MESSAGE((order == "SH" || order == "SS" || order == "nf" || order == "fi" ||
                   order == "B " || order == "I "),
                  order);
    ++at;
  }
}

}  // namespace tuina
