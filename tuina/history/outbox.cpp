// SPDX-License-Identifier: Apache-2.0
#include "tuina/history/outbox.hpp"

#include "tuina/history/fleet.hpp"

namespace tuina::history {
namespace {

Result<void> send(History& server, const Visit& visit) {
  if (visit.ended) return server.add(visit);
  return server.begin({.who = visit.who, .id = visit.id, .began = visit.began}, visit.folder);
}

/// A session that has ended since it was read stays: it goes next time.
Result<void> take_out(Database& outbox, const char* table, const std::string& id, bool ended) {
  const Value sent[] = {id, std::int64_t{ended}};
  return outbox.run(fmt::format("DELETE FROM {} WHERE id = $1 AND ended = $2", table), sent);
}

/// True when it has gone; a server that is lost ends the delivery.
Result<bool> went(const Result<void>& sent, const std::string& what, Delivered& delivered) {
  if (sent) {
    ++delivered.sessions;
    return true;
  }
  if (sent.error().fault == Fault::device) return tl::unexpected(sent.error());
  delivered.refused.push_back(fmt::format("{}: {}", what, sent.error().message));
  return false;
}

Result<void> deliver_people(History& outbox, History& server, Delivered& delivered) {
  const auto people = outbox.people();
  if (!people) return tl::unexpected(people.error());
  for (const Person& person : *people) {
    const auto visits = outbox.visits_of(person.name);
    if (!visits) return tl::unexpected(visits.error());
    for (const Visit& visit : *visits) {
      const auto gone = went(send(server, visit), visit.id, delivered);
      if (!gone) return tl::unexpected(gone.error());
      if (!*gone) continue;
      auto out = take_out(outbox.database(), "session", visit.id, visit.ended);
      if (!out) return out;
    }
  }
  return outbox.database().run(
      "DELETE FROM person WHERE NOT EXISTS (SELECT 1 FROM session WHERE who = name)");
}

Result<void> deliver_machines(History& outbox, History& server, Delivered& delivered) {
  const auto machines = fleet_of(outbox.database());
  if (!machines) return tl::unexpected(machines.error());
  for (const MachineHistory& one : *machines) {
    auto told = enter(server.database(), one.machine);
    if (!told && told.error().fault == Fault::device) return told;
    if (!told) delivered.refused.push_back(one.machine.name + ": " + told.error().message);
    for (const MachineSession& session : one.sessions) {
      const auto gone = went(enter(server.database(), session), session.id, delivered);
      if (!gone) return tl::unexpected(gone.error());
      if (!*gone) continue;
      auto out = take_out(outbox.database(), "machine_session", session.id, session.ended);
      if (!out) return out;
    }
  }
  return {};
}

}  // namespace

Result<Delivered> deliver(History& outbox, History& server) {
  Delivered delivered;
  if (const auto done = deliver_people(outbox, server, delivered); !done)
    return tl::unexpected(done.error());
  if (const auto done = deliver_machines(outbox, server, delivered); !done)
    return tl::unexpected(done.error());
  return delivered;
}

Result<std::size_t> waiting(History& outbox) {
  const auto rows = outbox.database().query(
      "SELECT (SELECT COUNT(*) FROM session) + (SELECT COUNT(*) FROM machine_session)", {});
  if (!rows) return tl::unexpected(rows.error());
  return static_cast<std::size_t>(as_whole(rows->front().front()));
}

}  // namespace tuina::history
