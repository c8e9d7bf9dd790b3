// SPDX-License-Identifier: Apache-2.0
#include "tuina/core/io/toml_reader.hpp"

#include <doctest/doctest.h>

#include "tuina/core/io/text_lines.hpp"

using namespace tuina;

namespace {

/// What a file is refused with.
std::string fault_of(std::string_view text, const std::function<void(const TomlTable&)>& read,
                     Fault fault = Fault::config) {
  const auto done = read_toml(text, "my.toml", fault, read);
  REQUIRE_FALSE(done.has_value());
  CHECK(done.error().fault == fault);
  return done.error().message;
}

void nothing(const TomlTable&) {}

}  // namespace

TEST_CASE("what is right is read, and what is absent stays absent") {
  const auto read = read_toml(
      "n = 2\nx = 2.5\nyes = true\nname = \"anna\"\nside = \"left\"\nat = [1, 2.0, -3]\n"
      "[arm]\nreach_m = 0.9\n[[part]]\nk = 1\n[[part]]\nk = 2\n",
      "my.toml", Fault::config, [](const TomlTable& root) {
        CHECK(root.whole("n", 1, 3) == 2);
        CHECK(root.number("n", 1, 3) == 2.0);
        CHECK(root.number("x", 2.5, 2.5) == 2.5);
        CHECK(root.flag("yes") == true);
        CHECK(root.text("name") == "anna");
        CHECK(root.word("side", {"both", "left"}) == 1U);
        CHECK(root.numbers("at", 3, 3.0) == std::vector<double>{1.0, 2.0, -3.0});
        REQUIRE(root.table("arm").has_value());
        CHECK(root.table("arm")->number("reach_m", 0, 1) == 0.9);
        REQUIRE(root.tables("part").size() == 2);
        CHECK(root.tables("part")[1].whole("k", 0, 9) == 2);
        for (const char* absent : {"", "none"}) {
          CHECK_FALSE(root.has(absent));
          CHECK_FALSE(root.number(absent, 0, 1).has_value());
          CHECK_FALSE(root.text(absent).has_value());
          CHECK_FALSE(root.table(absent).has_value());
          CHECK_FALSE(root.list(absent).has_value());
          CHECK(root.tables(absent).empty());
        }
      });
  CHECK_MESSAGE(read.has_value(), read.error().message);
}

TEST_CASE("everything that is wrong is said at once, each with its line and what would be right") {
  const std::string message =
      fault_of("n = 2.5\nx = nan\nyes = 1\nname = 3\nside = \"lfet\"\nat = [1, inf, 3]\narm = 1\n",
               [](const TomlTable& root) {
                 CHECK_FALSE(root.whole("n", 1, 3).has_value());
                 CHECK_FALSE(root.number("x", 0, 9, "a length in metres").has_value());
                 CHECK_FALSE(root.flag("yes").has_value());
                 CHECK_FALSE(root.text("name").has_value());
                 CHECK_FALSE(root.word("side", {"left", "right"}).has_value());
                 CHECK_FALSE(root.numbers("at", 3, 9.0).has_value());
                 CHECK_FALSE(root.table("arm").has_value());
               });
  CHECK(message ==
        "my.toml:1: n = 2.5 is not a whole number from 1 to 3\n"
        "my.toml:2: x = nan is not a number from 0 to 9: a length in metres\n"
        "my.toml:3: yes = 1 is not true or false\n"
        "my.toml:4: name = 3 is not a text in quotes\n"
        "my.toml:5: side = \"lfet\" is unknown; is `left` meant?\n"
        "my.toml:6: at is not 3 numbers from -9 to 9\n"
        "my.toml:7: arm = 1 is not a table, [arm]");
}

TEST_CASE("a key that nobody knows and one that is missing are named with their table") {
  const std::string message =
      fault_of("[arm]\nraech_m = 0.9\nlength_m = 1.0\n", [](const TomlTable& root) {
        root.table("arm")->only({"length_m"}, {"reach_m", "mass_kg"});
        root.only({}, {}, "a robot");
      });
  CHECK(message ==
        "my.toml:1: arm.reach_m, arm.mass_kg are missing\n"
        "my.toml:2: `arm.raech_m` is unknown; is `reach_m` meant?\n"
        "my.toml:1: a robot has no `arm`; none is known");
}

TEST_CASE("a long value is shown by its beginning, a long list of keys by the first") {
  CHECK(fault_of("name = \"" + std::string(5000, 'x') + "\"\n", [](const TomlTable& root) {
          (void)root.flag("name");
        }).size() < 100);
  TomlTable::Words needed;
  for (int i = 0; i < 200; ++i) needed.push_back("key" + std::to_string(i));
  const std::string missing = fault_of("", [&](const TomlTable& root) { root.only({}, needed); });
  CHECK(missing.size() < 200);
  CHECK(missing.ends_with(" more are missing"));
}

TEST_CASE("an entry of a list is refused at its own line") {
  CHECK(fault_of("at = [\n[1, 2],\n[1, \"2\"],\n]\n", [](const TomlTable& root) {
          const auto entries = root.list("at").value();
          REQUIRE(entries.size() == 2);
          CHECK(entries[0].numbers(2).has_value());
          CHECK_FALSE(entries[1].numbers(2).has_value());
          root.reject(entries[1], "two numbers are needed");
        }) == "my.toml:3: two numbers are needed");
}

TEST_CASE("a text comes back from TOML as it went in, whatever letters it has") {
  for (const std::string text :
       {"anna", "my \"best\" arm", "C:\\arms\\left.toml", "two\nlines", "\x7f\x01\t", "推拿", ""}) {
    CAPTURE(text);
    std::optional<std::string> back;
    const auto read = read_toml("name = " + toml_string(text), "my.toml", Fault::config,
                                [&](const TomlTable& root) { back = root.text("name"); });
    CHECK(read.has_value());
    CHECK(back == text);
  }
}

TEST_CASE("what is no TOML is refused with its line, and what was typed without one") {
  const std::string right = " is not TOML; `key = value`, `[section]` or `# comment` is needed";
  CHECK(fault_of("a = 1\nb = [\n", nothing).starts_with("my.toml:"));
  CHECK(fault_of("a = 1\nb = [\n", nothing).ends_with(right));
  CHECK(fault_of("a = 1\n\nb == 2\n", nothing) == "my.toml:3: `b == 2`" + right);
  CHECK(fault_of("a = = 1", nothing, Fault::usage) == "my.toml: `a = = 1`" + right);
  CHECK(fault_of("a = 1\na = 2\n", nothing) == "my.toml:2: this key or section stands there twice");
  CHECK(fault_of("[a]\nb = 1\n[a]\n", nothing) ==
        "my.toml:3: this key or section stands there twice");
  CHECK(fault_of(
            "a = 5", [](const TomlTable& root) { (void)root.number("a", 0, 1); }, Fault::usage) ==
        "my.toml: a = 5 is not a number from 0 to 1");
}
