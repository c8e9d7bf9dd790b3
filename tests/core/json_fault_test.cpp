// SPDX-License-Identifier: Apache-2.0
#include "tuina/core/io/json_fault.hpp"

#include <doctest/doctest.h>

#include <nlohmann/json.hpp>
#include <string>

using namespace tuina;
using nlohmann::json;

namespace {

/// What reading a number under the key `a` of a text is refused with.
std::string fault_of(std::string_view text) {
  try {
    const json root = json::parse(text);
    static_cast<void>(root.at("a").get<double>());
  } catch (const std::exception& fault) {
    return json_fault(fault, text, "x.json", "a record").message;
  }
  return "";
}

}  // namespace

TEST_CASE("JSON that is empty, cut, wrong or of another content is refused in words for people") {
  CHECK(fault_of("{\"a\": 1}").empty());
  CHECK(fault_of("") == "x.json: is empty; JSON with a record is needed");
  CHECK(fault_of(" \n") == "x.json: is empty; JSON with a record is needed");
  CHECK(fault_of("{\n\"a\": 1") == "x.json:2: the JSON ends too early");
  CHECK(fault_of("{\"a\": \"wor") == "x.json:1: the JSON ends too early");
  CHECK(fault_of("{\"a\": 1,\n}\n") ==
        "x.json:2: not JSON from `}` on; a comma, bracket or quote is missing or too many");
  CHECK(fault_of("{\"a\": nan}").starts_with("x.json:1: not JSON from "));
  CHECK(fault_of("{\"a\": 1} more").starts_with("x.json:1: not JSON from "));
  CHECK(fault_of("{\"b\": 1}") == "x.json: is not a record: `a` is missing");
  CHECK(fault_of("{\"a\": \"1\"}") ==
        "x.json: is not a record: a string stands where a number is needed");
  CHECK(fault_of("{\"a\": []}") ==
        "x.json: is not a record: an array stands where a number is needed");
  CHECK(fault_of("{\"a\": 1e999}").find("a number is too large") != std::string::npos);
  CHECK(fault_of("[1]").find("an object with keys is needed") != std::string::npos);
}

TEST_CASE("the words of the library never reach a message") {
  for (const char* text : {"", "{", "[", "{\"a\"", "{\"a\": tru}", "\x01", "\xff\xfe", "null", "3",
                           "{\"a\": {}}", "{\"a\": 1e999}", "{\"a\": \"\\ud800\"}"}) {
    const std::string message = fault_of(text);
    CAPTURE(message);
    CHECK_FALSE(message.empty());
    for (const char* innards : {"json.exception", "parse error", "syntax", "type_error", "at()"})
      CHECK(message.find(innards) == std::string::npos);
  }
}
