// SPDX-License-Identifier: Apache-2.0
#include "tuina/session/config.hpp"

#include <doctest/doctest.h>

#include "tuina/core/io/file.hpp"
#include "tuina/session/realism.hpp"

using namespace tuina;
using namespace tuina::session;

TEST_CASE("the configuration printed is the configuration read") {
  Config config;
  config.scan.method = "likelihood";
  config.simulation.breathing_mm = 4.25;
  const auto again = parse_config(to_toml(config), "again.toml");
  REQUIRE(again.has_value());
  CHECK(to_toml(*again) == to_toml(config));
}

TEST_CASE("config/default.toml says what the defaults are") {
  CHECK(read_file(TUINA_SOURCE_DIR "/config/default.toml").value() == to_toml(Config{}));
}

TEST_CASE("realism sets every effect, and what is named besides differs from it") {
  const auto usual =
      parse_config("[simulation]\ntorso_mass_kg = 9\nrealism = 'usual'\n", "my.toml");
  REQUIRE(usual.has_value());
  Config hard;
  REQUIRE(apply_setting(hard, "simulation.realism=hard").has_value());
  REQUIRE(apply_setting(hard, "simulation.torso_mass_kg=9").has_value());
  for (const SimulatedEffect& effect : simulated_effects()) {
    CAPTURE(effect.key);
    CHECK_FALSE(effect.source.empty());
    for (const double value : {effect.ideal, effect.usual, effect.hard}) {
      CHECK(value >= effect.min);
      CHECK(value <= effect.max);
    }
    if (effect.key == "simulation.torso_mass_kg") continue;
    CHECK(usual->simulation.*effect.value == effect.usual);
    CHECK(hard.simulation.*effect.value == effect.hard);
  }
  CHECK(usual->simulation.torso_mass_kg == 9.0);
  CHECK(hard.simulation.torso_mass_kg == 9.0);
  CHECK(to_toml(parse_config(to_toml(hard), "again.toml").value()) == to_toml(hard));
  REQUIRE(apply_setting(hard, "simulation.realism=ideal").has_value());
  for (const SimulatedEffect& effect : simulated_effects())
    CHECK(hard.simulation.*effect.value == effect.ideal);
  REQUIRE(apply_setting(hard, "simulation.realism=usual").has_value());
  CHECK(to_toml(hard) == to_toml(Config{}));
  const auto wrong = parse_config("[simulation]\nrealism = 'real'\n", "my.toml");
  REQUIRE_FALSE(wrong.has_value());
  CHECK(wrong.error().message.find("my.toml:2: simulation.realism") != std::string::npos);
}

TEST_CASE("all faults of a file are reported at once, with line, value and what would be right") {
  const auto config = parse_config(
      "[scan]\nsweep_s = 'x'\nmetod = 1\n[safety]\nforce_ceiling_n = 95\n[nonsense]\na = 1\n",
      "my.toml");
  REQUIRE_FALSE(config.has_value());
  CHECK(config.error().fault == Fault::config);
  const std::string& message = config.error().message;
  CAPTURE(message);
  CHECK(message.find("my.toml:2: scan.sweep_s = 'x' is not a number") != std::string::npos);
  CHECK(message.find("my.toml:3: scan.metod = 1 is unknown; is `scan.method` meant?") !=
        std::string::npos);
  CHECK(message.find("my.toml:5: safety.force_ceiling_n = 95 is not a number from 5 to 45") !=
        std::string::npos);
  CHECK(message.find("nonsense.a") != std::string::npos);
}

TEST_CASE("a setting of the command line changes one key, and a wrong one changes nothing") {
  Config config;
  REQUIRE(apply_setting(config, "scan.method=likelihood").has_value());
  CHECK(config.scan.method == "likelihood");
  for (const char* wrong :
       {"scan.method=best", "scan.sweep_s=nan", "scan.sweep_s=1e9", "scan.swep_s=4", "scan", "=",
        "scan.sweep_s=", "massage.steer=1", "a.b=[", "scan.sweep_s=4\nmethod=3"}) {
    CAPTURE(wrong);
    const std::string before = to_toml(config);
    const auto applied = apply_setting(config, wrong);
    REQUIRE_FALSE(applied.has_value());
    CHECK(applied.error().fault == Fault::usage);
    CHECK(to_toml(config) == before);
  }
}
