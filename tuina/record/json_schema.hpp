// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tuina/record/json_fields.hpp"

namespace tuina::record {

/// Visits a list of fields (json_fields.hpp) and makes the JSON Schema of what `JsonWriter` writes.
class SchemaWriter {
 public:
  /// Keeps the order in which the fields are named.
  using Json = nlohmann::ordered_json;

  /// @{
  /// What `JsonWriter` does with a field, as its type.
  template <typename T>
  void operator()(const char* key, const T&, Unit = {}) {
    properties_[key] = type_of(T());
  }
  template <typename T>
  void maybe(const char* key, const T& value, Unit = {}) {
    (*this)(key, value);
  }
  template <typename Fields>
  void object(const char* key, const Fields& fields) {
    SchemaWriter inside;
    fields(inside);
    properties_[key] = inside.schema();
  }
  /// @}
  /// The schema of the object visited.
  [[nodiscard]] Json schema() const { return {{"type", "object"}, {"properties", properties_}}; }

 private:
  [[nodiscard]] static Json type(const char* name) { return {{"type", name}}; }
  [[nodiscard]] static Json type_of(double) { return type("number"); }
  [[nodiscard]] static Json type_of(bool) { return type("boolean"); }
  [[nodiscard]] static Json type_of(const std::string&) { return type("string"); }
  template <std::integral T>
  [[nodiscard]] static Json type_of(T) {
    return type("integer");
  }
  template <Enumeration E>
  [[nodiscard]] static Json type_of(E) {
    return type("string");
  }
  template <Enumeration E>
  [[nodiscard]] static Json type_of(std::optional<E>) {
    return type("string");
  }
  [[nodiscard]] static Json type_of(std::optional<double>) {
    return {{"type", {"number", "null"}}};
  }
  template <typename T>
  [[nodiscard]] static Json type_of(const std::vector<T>&) {
    return {{"type", "array"}, {"items", type_of(T())}};
  }

  Json properties_ = Json::object();
};

}  // namespace tuina::record
