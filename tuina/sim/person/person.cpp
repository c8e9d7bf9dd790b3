// SPDX-License-Identifier: Apache-2.0
#include "tuina/sim/person/person.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "tuina/core/io/file.hpp"
#include "tuina/core/io/json_fault.hpp"
#include "tuina/core/io/surface_file.hpp"
#include "tuina/core/io/text_lines.hpp"
#include "tuina/sim/person/phantom.hpp"

namespace tuina::sim {
namespace {

using Json = nlohmann::ordered_json;

Vector3 vector_in(const Json& numbers, const std::string& what) {
  Vector3 vector = Vector3::Constant(std::nan(""));
  if (numbers.is_array() && numbers.size() == 3) {
    for (std::size_t k = 0; k < 3; ++k)
      if (numbers[k].is_number()) vector[static_cast<Eigen::Index>(k)] = numbers[k].get<double>();
  }
  if (!vector.allFinite()) throw std::invalid_argument(what + " is not three finite numbers");
  return vector;
}

Json json_of(const Vector3& vector) {
  const auto rounded = [](double x) { return std::round(x * 1e5) / 1e5; };
  return {rounded(vector.x()), rounded(vector.y()), rounded(vector.z())};
}

void add_acupoints(const Json& table, std::vector<Acupoint>& acupoints) {
  for (const auto& [name, entry] : table.items()) {
    acupoints.push_back(
        {.name = name,
         .at_in_couch = vector_in(entry.at("position"), name + ".position"),
         .normal_in_couch = vector_in(entry.at("normal"), name + ".normal").normalized()});
  }
}

template <typename Name>
Name named(const Json& text, std::initializer_list<Name> choices) {
  for (const Name choice : choices) {
    if (text.get<std::string>() == name_of(choice)) return choice;
  }
  throw std::invalid_argument(in_quotes(text.get<std::string>()) + " is not known");
}

/// Throws exceptions of nlohmann::json and std::invalid_argument; `load_person` converts them to an
/// Error.
void read_truth(const Json& truth, Person& person) {
  person.position = named(truth.at("position"), {BodyPosture::sitting, BodyPosture::prone});
  person.body_type =
      named(truth.at("body_type"), {BodyType::slim, BodyType::medium, BodyType::hefty});
  person.woman = truth.value("sex", "male") == "female";
  person.height_m = truth.value("height_m", 0.0);
  person.bmi = truth.value("bmi", 0.0);
  person.three_cun_m = truth.value("three_cun_m", 0.0);
  for (const auto& [name, at] : truth.at("landmarks").items()) {
    person.landmarks.push_back({.name = name, .at_in_couch = vector_in(at, name)});
  }
  add_acupoints(truth.at("acupoints"), person.acupoints);
  if (truth.contains("more_acupoints")) add_acupoints(truth["more_acupoints"], person.acupoints);

  // The order of Table 5-1 of the thesis, independent of the file.
  for (std::size_t i = 0; i < seven_acupoints.size(); ++i) {
    const auto begin = person.acupoints.begin() + static_cast<std::ptrdiff_t>(i);
    const auto found = std::find_if(begin, person.acupoints.end(), [&](const Acupoint& a) {
      return a.name == seven_acupoints[i];
    });
    if (found == person.acupoints.end()) {
      throw std::invalid_argument(std::string("the acupoint ") + seven_acupoints[i] +
                                  " is missing");
    }
    std::rotate(begin, found, found + 1);
  }
}

}  // namespace

Result<Person> load_person(const std::filesystem::path& ply) {
  auto surface = read_surface(ply);
  if (!surface) return tl::unexpected(surface.error());
  if (surface->triangles.empty()) {
    return fail(Fault::bad_input,
                "{}: a person needs a surface of triangles, this file has only points or triangles "
                "between fewer than half of them",
                ply.string());
  }
  const auto truth_path = std::filesystem::path(ply).replace_extension(".json");
  const auto text = read_file(truth_path, std::size_t{16} << 20);
  if (!text) {
    return fail(text.error().fault, "{} is no labelled body: {} (its acupoints) cannot be read",
                ply.string(), truth_path.string());
  }
  Person person;
  person.name = ply.stem().string();
  try {
    read_truth(Json::parse(*text), person);
  } catch (const std::exception& fault) {
    return tl::unexpected(json_fault(fault, *text, truth_path.string(), "the labels of a body"));
  }
  person.skin_in_couch = {.vertices = std::move(surface->cloud.points),
                          .triangles = std::move(surface->triangles)};
  return person;
}

Result<void> write_person(const Person& person, const std::filesystem::path& folder) {
  Json truth;
  truth["id"] = person.name;
  truth["sex"] = person.woman ? "female" : "male";
  truth["height_m"] = person.height_m;
  truth["bmi"] = person.bmi;
  truth["body_type"] = name_of(person.body_type);
  truth["position"] = name_of(person.position);
  truth["units"] = "m";
  truth["vertices"] = person.skin_in_couch.vertices.size();
  truth["triangles"] = person.skin_in_couch.triangles.size();
  truth["three_cun_m"] = person.three_cun_m;
  for (const Landmark& landmark : person.landmarks) {
    truth["landmarks"][landmark.name] = json_of(landmark.at_in_couch);
  }
  for (std::size_t i = 0; i < person.acupoints.size(); ++i) {
    const Acupoint& point = person.acupoints[i];
    truth[i < seven_acupoints.size() ? "acupoints" : "more_acupoints"][point.name] = {
        {"position", json_of(point.at_in_couch)}, {"normal", json_of(point.normal_in_couch)}};
  }
  auto surface = write_file(folder / (person.name + ".ply"), to_ply(person.skin_in_couch));
  if (!surface) return surface;
  return write_file(folder / (person.name + ".json"), truth.dump(1) + "\n");
}

Result<Person> parse_person(std::string_view words, std::optional<BodyPosture> position,
                            std::uint64_t seed) {
  constexpr std::string_view phantom = "phantom";
  if (words.substr(0, words.find(':')) == phantom) {
    for (const BodyType type : {BodyType::slim, BodyType::medium, BodyType::hefty}) {
      if (words == fmt::format("phantom:{}", name_of(type))) {
        return make_phantom(draw_phantom(type, seed), position.value_or(BodyPosture::sitting));
      }
    }
    return fail(
        Fault::usage,
        "--person {} is not known: phantom:slim, phantom:medium, phantom:hefty or a .ply file",
        words);
  }
  auto person = load_person(std::filesystem::path(words));
  if (person && position && *position != person->position) {
    return fail(Fault::usage, "--position {} contradicts {}, a person who is {}",
                name_of(*position), words, name_of(person->position));
  }
  return person;
}

}  // namespace tuina::sim
