// SPDX-License-Identifier: Apache-2.0
#include "tuina/sim/person/person.hpp"

#include <doctest/doctest.h>

#include "tests/folder.hpp"
#include "tests/reason.hpp"
#include "tuina/core/io/file.hpp"
#include "tuina/sim/person/phantom.hpp"

using namespace tuina;
using namespace tuina::sim;
using tuina::test::Folder;

TEST_CASE("a phantom that is written as a labelled body is read back as the same person") {
  const Folder folder;
  for (const BodyPosture position : {BodyPosture::sitting, BodyPosture::prone}) {
    const Person person = make_phantom(draw_phantom(BodyType::medium, 3), position);
    REQUIRE(write_person(person, folder.path()).has_value());
    const auto read = load_person(folder.path() / (person.name + ".ply"));
    REQUIRE_MESSAGE(read.has_value(), test::reason(read));
    CHECK(read->position == position);
    CHECK(read->body_type == BodyType::medium);
    CHECK(read->woman == person.woman);
    CHECK(read->skin_in_couch.triangles == person.skin_in_couch.triangles);
    REQUIRE(read->acupoints.size() == 27);
    REQUIRE(read->landmarks.size() == person.landmarks.size());
    for (std::size_t i = 0; i < 27; ++i) {
      CHECK(read->acupoints[i].name == person.acupoints[i].name);
      CHECK((read->acupoints[i].at_in_couch - person.acupoints[i].at_in_couch).norm() < 2e-5);
      CHECK(read->acupoints[i].normal_in_couch.dot(person.acupoints[i].normal_in_couch) > 0.9999);
    }
  }
}

TEST_CASE("a surface without its truth beside it is refused with the name of the missing file") {
  const Folder folder;
  const Person person = make_phantom(draw_phantom(BodyType::slim, 1), BodyPosture::sitting);
  REQUIRE(write_person(person, folder.path()).has_value());
  std::filesystem::remove(folder.path() / (person.name + ".json"));
  const auto read = load_person(folder.path() / (person.name + ".ply"));
  REQUIRE_FALSE(read.has_value());
  CHECK(read.error().fault == Fault::file);
  CHECK(read.error().message.find(person.name + ".json") != std::string::npos);
}

TEST_CASE("a truth that is no truth is refused with its file and the cause") {
  const Folder folder;
  const Person person = make_phantom(draw_phantom(BodyType::slim, 1), BodyPosture::sitting);
  REQUIRE(write_person(person, folder.path()).has_value());
  const auto json = folder.path() / (person.name + ".json");
  const std::string good = read_file(json).value();
  const auto replaced = [&](const std::string& from, const std::string& to) {
    std::string text = good;
    text.replace(text.find(from), from.size(), to);
    return text;
  };
  for (const auto& [text, cause] :
       {std::pair<std::string, std::string>{"{", "ends too early"},
        {replaced("GV4", "GV5"), "GV4"},
        {replaced("\"sitting\"", "\"standing\""), "standing"},
        {replaced("\"landmarks\"", "\"marks\""), "landmarks"},
        {replaced("\"C7\": [", "\"C7\": [0.0,"), "three finite numbers"}}) {
    REQUIRE(write_file(json, text).has_value());
    const auto read = load_person(folder.path() / (person.name + ".ply"));
    REQUIRE_FALSE(read.has_value());
    CHECK(read.error().fault == Fault::bad_input);
    CHECK_MESSAGE(read.error().message.find(cause) != std::string::npos, read.error().message);
    CHECK(read.error().message.find(json.string()) != std::string::npos);
  }
}

TEST_CASE("the words after --person mean a phantom or a file, and nothing else") {
  CHECK(parse_person("phantom:hefty", {}, 5)->body_type == BodyType::hefty);
  CHECK(parse_person("phantom:hefty", {}, 5)->position == BodyPosture::sitting);
  CHECK(parse_person("phantom:slim", BodyPosture::prone, 5)->position == BodyPosture::prone);
  for (const char* words : {"phantom", "phantom:", "phantom:fat", "phantom:medium "}) {
    const auto person = parse_person(words, {}, 5);
    REQUIRE_FALSE(person.has_value());
    CHECK(person.error().fault == Fault::usage);
    CHECK(person.error().message.find("phantom:medium") != std::string::npos);
  }
  CHECK(parse_person("/nowhere/body.ply", {}, 5).error().fault == Fault::file);
}

TEST_CASE("a position that contradicts the file is refused, the file's own is accepted") {
  const Folder folder;
  const Person person = make_phantom(draw_phantom(BodyType::slim, 1), BodyPosture::prone);
  REQUIRE(write_person(person, folder.path()).has_value());
  const std::string ply = folder.path() / (person.name + ".ply");
  CHECK(parse_person(ply, BodyPosture::prone, 1).has_value());
  CHECK(parse_person(ply, {}, 1)->position == BodyPosture::prone);
  const auto refused = parse_person(ply, BodyPosture::sitting, 1);
  REQUIRE_FALSE(refused.has_value());
  CHECK(refused.error().fault == Fault::usage);
}
