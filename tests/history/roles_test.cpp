// SPDX-License-Identifier: Apache-2.0
// Who may see what on a server where each has an account.
#include <doctest/doctest.h>

#include "tests/history/server.hpp"
#include "tests/history/some_visit.hpp"
#include "tests/reason.hpp"
#include "tuina/history/fleet.hpp"
#include "tuina/history/history.hpp"

using namespace tuina;
using namespace tuina::history;

namespace {

const std::string day = "2026-01-01T09:00:00Z";

/// The same database for another account.
std::string as(const std::string& account, const std::string& address) {
  const std::string owner = "user=tuina";
  return address.substr(0, address.find(owner)) + "user=" + account;
}

/// An account of a practice, made by whoever runs its server. Accounts belong to all databases.
void make_account(Database& owner, const std::string& name, const std::string& role) {
  REQUIRE(owner.run("DROP ROLE IF EXISTS " + name));
  REQUIRE(owner.run("CREATE ROLE " + name + " LOGIN IN ROLE " + role));
}

}  // namespace

TEST_CASE("a therapist sees own people, a technician robots and nobody's health") {
  const auto address = test::empty_database();
  if (!address) return;
  auto owner = History::open(*address);
  REQUIRE_MESSAGE(owner, test::reason(owner));
  make_account(owner->database(), "carla", "tuina_therapist");
  make_account(owner->database(), "dario", "tuina_therapist");
  make_account(owner->database(), "toni", "tuina_technician");

  auto carla = History::open(as("carla", *address));
  auto dario = History::open(as("dario", *address));
  REQUIRE_MESSAGE(carla, test::reason(carla));
  REQUIRE_MESSAGE(dario, test::reason(dario));
  REQUIRE(carla->add(test::visit_at("a", day, 2.5)));  // anna
  Visit berta = test::visit_at("b", day, 2.5);
  berta.who = "berta";
  REQUIRE(dario->add(berta));
  REQUIRE(carla->add_note("anna", {day, "sleeps well"}));
  REQUIRE(enter(carla->database(), Machine{.name = "room-1", .seen = day, .doing = "massage"}));
  REQUIRE(enter(carla->database(), MachineSession{.id = "a", .machine = "room-1", .began = day}));

  SUBCASE("of therapists") {
    REQUIRE(carla->people()->size() == 1);
    CHECK(carla->people()->front().name == "anna");
    CHECK(carla->visits_of("anna")->front().tissue.size() == 1);
    CHECK(carla->visits_of("berta")->empty());
    CHECK(dario->visits_of("anna")->empty());
    CHECK(dario->notes_of("anna")->empty());
    CHECK_FALSE(dario->add_note("anna", {day, "?"}));
    // Neither by the name of somebody else's person nor by the id of their session.
    CHECK_FALSE(dario->add(test::visit_at("c", day, 2.5)));
    Visit stolen = berta;
    stolen.id = "a";
    CHECK_FALSE(dario->add(stolen));
    CHECK(dario->forget("anna", day));  // of whom nothing is known there
    CHECK(owner->people()->size() == 2);
    CHECK(owner->visits_of("anna")->size() == 1);
    REQUIRE(carla->forget("anna", day));
    CHECK(owner->people()->size() == 1);
  }
  SUBCASE("of technicians") {
    auto toni = History::open(as("toni", *address));
    REQUIRE_MESSAGE(toni, test::reason(toni));
    const auto fleet = fleet_of(toni->database());
    REQUIRE_MESSAGE(fleet, test::reason(fleet));
    REQUIRE(fleet->size() == 1);
    CHECK(fleet->front().sessions.size() == 1);
    for (const char* table : {"person", "session", "acupoint", "tissue", "note", "forgotten"}) {
      const auto refused = toni->database().query(std::string("SELECT * FROM ") + table, {});
      REQUIRE_FALSE(refused);
      CHECK(refused.error().message.find("permission denied") != std::string::npos);
    }
    CHECK_FALSE(toni->people());
    CHECK_FALSE(toni->add(berta));
    CHECK_FALSE(enter(toni->database(), Machine{.name = "room-1", .seen = day, .doing = "?"}));
  }
}
