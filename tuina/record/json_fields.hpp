// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include <cmath>
#include <concepts>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "tuina/body/acupoints.hpp"
#include "tuina/core/acupoint.hpp"
#include "tuina/core/arm.hpp"
#include "tuina/core/result.hpp"
#include "tuina/core/technique.hpp"
#include "tuina/massage/zones.hpp"
#include "tuina/session/live_command.hpp"

/// A field of a JSON file is named once, in a list that takes a visitor and what holds the fields:
///   constexpr auto stop_fields = [](auto& visit, auto& stop) {
///     visit("time_s", stop.time_s);
///     visit("cause", stop.cause);
///   };
/// `to_json(stop, stop_fields)` writes it, `parse_json<Stop>(text, ..., stop_fields)` reads it.
namespace tuina::record {

/// How a file states a number that is SI inside, and to what it rounds; step zero rounds nothing.
struct Unit {
  double in_file = 1.0;  ///< one SI unit, as the file states it
  double in_si = 1.0;    ///< one unit of the file, as it is inside
  double step = 0.0;     ///< in units of the file
};
inline constexpr Unit mm{1e3, 1e-3}, per_mm{1e-3, 1e3}, percent{100.0, 0.01};

/// How many enumerators count from zero, each with a `name_of`; zero of those that are not read.
template <typename Enum>
inline constexpr std::size_t count_of = 0;
template <>
inline constexpr std::size_t count_of<Arm> = both_arms.size();
template <>
inline constexpr std::size_t count_of<BodyPosture> = 2;
template <>
inline constexpr std::size_t count_of<body::Method> = 2;
template <>
inline constexpr std::size_t count_of<Technique> = all_techniques.size();
template <>
inline constexpr std::size_t count_of<massage::Zone> = massage::zone_rules.size();
template <>
inline constexpr std::size_t count_of<session::LiveCommand> = session::live_command_names.size();

template <typename T>
concept Enumeration = std::is_enum_v<T>;
inline constexpr const char* no_enumerator = "auto";  ///< an optional enumerator that is not there

/// Writes one object, field by field.
class JsonWriter {
 public:
  using Json = nlohmann::ordered_json;  ///< keeps the order in which the fields are named

  /// @{
  /// What every visitor of fields has; `JsonReader` says what each is for.
  template <typename T>
  void operator()(const char* key, const T& value, Unit unit = {}) {
    json[key] = json_of(value, unit);
  }
  template <typename T>
  void maybe(const char* key, const T& value, Unit unit = {}) {
    json[key] = json_of(value, unit);
  }
  template <typename T>
  void told(const char* key, const T& value, Unit unit = {}) {
    json[key] = json_of(value, unit);
  }
  template <typename T, typename Fields>
  void if_known(const char* /*key*/, const std::optional<T>& value, const Fields& fields) {
    if (value) fields(*this, *value);
  }
  template <typename Fields>
  void object(const char* key, const Fields& fields) {
    JsonWriter inside;
    fields(inside);
    json[key] = std::move(inside.json);
  }
  template <typename T, typename Fields>
  void list(const char* key, const std::vector<T>& items, const Fields& fields) {
    Json all = Json::array();
    for (const T& item : items) {
      JsonWriter inside;
      fields(inside, item);
      all.push_back(std::move(inside.json));
    }
    json[key] = std::move(all);
  }
  /// Items as keys of an object, by their names.
  template <typename T, typename Fields>
  void named(const char* key, const std::vector<T>& items, const Fields& fields) {
    object(key, [&](JsonWriter& inside) {
      for (const T& item : items) fields(inside, item.name.c_str(), item);
    });
  }
  [[nodiscard]] static bool has(const char* /*key*/) { return true; }
  /// @}

  Json json = Json::object();

 private:
  template <typename T>
  [[nodiscard]] static Json json_of(const T& value, Unit) {
    return value;
  }
  // A number that is not finite becomes null.
  [[nodiscard]] static Json json_of(double value, Unit unit) {
    const double stated = value * unit.in_file;
    return unit.step > 0.0 ? std::round(stated / unit.step) * unit.step : stated;
  }
  [[nodiscard]] static Json json_of(const Vector3& v, Unit unit) {
    return {json_of(v.x(), unit), json_of(v.y(), unit), json_of(v.z(), unit)};
  }
  [[nodiscard]] static Json json_of(const std::vector<Vector3>& places, Unit unit) {
    Json all = Json::array();
    for (const Vector3& place : places) all.push_back(json_of(place, unit));
    return all;
  }
  [[nodiscard]] static Json json_of(const Transform& to_from, Unit unit) {
    Json rotation = Json::array();
    for (int row = 0; row < 3; ++row)
      rotation.push_back(json_of(Vector3(to_from.linear().row(row)), unit));
    return {{"rotation", rotation}, {"translation_m", json_of(to_from.translation(), unit)}};
  }
  [[nodiscard]] static Json json_of(const std::optional<double>& value, Unit unit) {
    return value ? json_of(*value, unit) : Json();
  }
  [[nodiscard]] static Json json_of(const std::optional<std::string>& value, Unit) {
    return value ? Json(*value) : Json();
  }
  template <Enumeration E>
  [[nodiscard]] static Json json_of(const E& value, Unit) {
    return name_of(value);
  }
  template <Enumeration E>
  [[nodiscard]] static Json json_of(const std::optional<E>& value, Unit) {
    return value ? name_of(*value) : no_enumerator;
  }
};

/// Reads one object; the first fault is kept, with the path of its field, and ends the reading.
class JsonReader {
 public:
  using Json = nlohmann::json;  ///< what is read

  /// `path` names the object in what is wrong; object and fault must outlive it.
  JsonReader(const Json& object, std::string path, std::string& fault)
      : object_(object), path_(std::move(path)), fault_(fault) {}

  /// A value; a key that is not there, or a value of another type, is a fault.
  template <typename T>
  void operator()(const char* key, T& value, Unit unit = {}) {
    if (const Json* node = find(key)) take(*node, path_of(key), value, unit);
  }
  /// Null, or a key that is not there, leaves the value as it is.
  template <typename T>
  void maybe(const char* key, T& value, Unit unit = {}) {
    if (has(key) && !object_[key].is_null()) (*this)(key, value, unit);
  }
  /// What follows from other fields is written for whoever reads the file, and not read.
  template <typename T>
  void told(const char* /*key*/, const T& /*value*/, Unit = {}) {}
  /// Fields of something that is there if the key is.
  template <typename T, typename Fields>
  void if_known(const char* key, std::optional<T>& value, const Fields& fields) {
    if (has(key)) fields(*this, value.emplace());
  }
  /// An object within this one.
  template <typename Fields>
  void object(const char* key, const Fields& fields) {
    const Json* node = find(key);
    if (node == nullptr || !holds(node->is_object(), *node, path_of(key), "an object")) return;
    JsonReader inside(*node, path_of(key), fault_);
    fields(inside);
  }
  /// Items that an earlier list has begun are gone on with, one by one.
  template <typename T, typename Fields>
  void list(const char* key, std::vector<T>& items, const Fields& fields) {
    const Json* node = find(key);
    if (node == nullptr || !holds(node->is_array(), *node, path_of(key), "a list")) return;
    if (items.empty()) items.resize(node->size());
    if (items.size() != node->size() && fault_.empty()) {
      fault_ =
          fmt::format("{} has {} entries, {} are needed", path_of(key), node->size(), items.size());
    }
    for (std::size_t i = 0; i < items.size() && fault_.empty(); ++i) {
      const std::string path = fmt::format("{}[{}]", path_of(key), i);
      if (!holds((*node)[i].is_object(), (*node)[i], path, "an object")) return;
      JsonReader inside((*node)[i], path, fault_);
      fields(inside, items[i]);
    }
  }
  /// An object with one object for each name; items begin with their key as name.
  template <typename T, typename Fields>
  void named(const char* key, std::vector<T>& items, const Fields& fields) {
    object(key, [&](JsonReader& inside) {
      for (const auto& entry : inside.object_.items()) {
        items.emplace_back().name = entry.key();
        fields(inside, entry.key().c_str(), items.back());
      }
    });
  }
  /// Whether a key is there.
  [[nodiscard]] bool has(const char* key) const { return object_.contains(key); }

 private:
  [[nodiscard]] std::string path_of(const char* key) const;
  /// The value of a key; without one, nothing and a fault.
  [[nodiscard]] const Json* find(const char* key);
  /// True when what was wanted is there; else the fault says what stands there instead.
  bool holds(bool right, const Json& node, const std::string& path, std::string_view wanted);

  void take(const Json& node, const std::string& path, double& value, Unit unit);
  void take(const Json& node, const std::string& path, bool& value, Unit unit);
  void take(const Json& node, const std::string& path, std::string& value, Unit unit);
  void take(const Json& node, const std::string& path, Vector3& value, Unit unit);
  void take(const Json& node, const std::string& path, Transform& value, Unit unit);
  template <std::integral T>
  void take(const Json& node, const std::string& path, T& value, Unit) {
    const bool fits = node.is_number_unsigned()
                          ? std::in_range<T>(node.get<std::uint64_t>())
                          : node.is_number_integer() && std::in_range<T>(node.get<std::int64_t>());
    if (holds(fits, node, path, "a whole number")) value = node.get<T>();
  }
  template <Enumeration E>
  void take(const Json& node, const std::string& path, E& value, Unit) {
    static_assert(count_of<E> > 0);
    std::string names;
    for (std::size_t i = 0; i < count_of<E>; ++i) {
      const auto one = static_cast<E>(i);
      if (node == name_of(one)) {
        value = one;
        return;
      }
      names += fmt::format("{}\"{}\"",
                           i == 0                ? ""
                           : i + 1 < count_of<E> ? ", "
                                                 : " or ",
                           name_of(one));
    }
    holds(false, node, path, names);
  }
  template <typename T>
  void take(const Json& node, const std::string& path, std::optional<T>& value, Unit unit) {
    const bool none = Enumeration<T> ? node == no_enumerator : node.is_null();
    if (none) {
      value.reset();
    } else {
      take(node, path, value.emplace(), unit);
    }
  }
  template <typename T>
  void take(const Json& node, const std::string& path, std::vector<T>& values, Unit unit) {
    if (!holds(node.is_array(), node, path, "a list")) return;
    values.resize(node.size());
    for (std::size_t i = 0; i < values.size(); ++i)
      take(node[i], fmt::format("{}[{}]", path, i), values[i], unit);
  }

  const Json& object_;
  std::string path_;
  std::string& fault_;
};

/// Text as JSON. `what` ends the sentence "FILE: is no ...".
[[nodiscard]] Result<nlohmann::json> parse_json(std::string_view text, std::string_view file,
                                                std::string_view what);

/// The JSON object of a struct by its list of fields.
template <typename T, typename Fields>
[[nodiscard]] nlohmann::ordered_json to_json(const T& from, const Fields& fields) {
  JsonWriter writer;
  fields(writer, from);
  return std::move(writer.json);
}

/// Reads a struct by its list of fields. Fails with file, path of the field and value.
template <typename T, typename Fields>
[[nodiscard]] Result<T> parse_json(std::string_view text, std::string_view file,
                                   std::string_view what, const Fields& fields) {
  const auto root = parse_json(text, file, what);
  if (!root) return tl::unexpected(root.error());
  T read;
  std::string fault;
  JsonReader reader(*root, "", fault);
  fields(reader, read);
  if (!fault.empty()) return fail(Fault::bad_input, "{}: is no {}: {}", file, what, fault);
  return read;
}

}  // namespace tuina::record
