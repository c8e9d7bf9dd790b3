// SPDX-License-Identifier: Apache-2.0
// PLY by G. Turk, 1994: a text header, then the elements as text or binary.
#include <algorithm>
#include <limits>
#include <map>

#include "tuina/core/io/surface_parts.hpp"
#include "tuina/core/io/text_lines.hpp"

namespace tuina::surface_parts {
namespace {

enum class Format : std::uint8_t { ascii, little_endian, big_endian };

struct Property {
  std::string name;
  NumberType type = NumberType::f32;
  std::optional<NumberType> count_type;  ///< type of the count, for lists
};

struct Element {
  std::string name;
  std::uint64_t count = 0;
  std::vector<Property> properties;
};

struct PlyHeader {
  Format format = Format::ascii;
  std::vector<Element> elements;
};

std::optional<NumberType> type_named(std::string_view word) {
  using enum NumberType;
  static const std::map<std::string_view, NumberType> types = {
      {"char", i8},   {"int8", i8},     {"uchar", u8},   {"uint8", u8},
      {"short", i16}, {"int16", i16},   {"ushort", u16}, {"uint16", u16},
      {"int", i32},   {"int32", i32},   {"uint", u32},   {"uint32", u32},
      {"float", f32}, {"float32", f32}, {"double", f64}, {"float64", f64}};
  const auto found = types.find(word);
  return found == types.end() ? std::nullopt : std::optional(found->second);
}

/// Parses a `property` line after its first word.
std::optional<Property> parse_property(std::string_view line) {
  Property property;
  std::string_view word = take_word(line);
  if (word == "list") {
    property.count_type = type_named(take_word(line));
    if (!property.count_type || is_floating(*property.count_type)) return std::nullopt;
    word = take_word(line);
  }
  const auto type = type_named(word);
  property.name = take_word(line);
  if (!type || property.name.empty() || !only_white_space(line)) return std::nullopt;
  property.type = *type;
  return property;
}

/// Fault of a header line; empty when it is right.
std::string read_header_line(std::string_view line, PlyHeader& header, bool& has_format) {
  const std::string_view all = line;
  const std::string_view word = take_word(line);
  if (word == "comment" || word == "obj_info") return {};
  if (word == "format") {
    const std::string_view format = take_word(line);
    const bool right_version = take_word(line) == "1.0" && only_white_space(line);
    if (format == "ascii")
      header.format = Format::ascii;
    else if (format == "binary_little_endian")
      header.format = Format::little_endian;
    else if (format == "binary_big_endian")
      header.format = Format::big_endian;
    else
      has_format = true;
    if (has_format || !right_version || !header.elements.empty()) {
      return fmt::format(
          "{}; one `format ascii|binary_little_endian|binary_big_endian 1.0` is needed",
          in_quotes(all));
    }
    has_format = true;
    return {};
  }
  if (!has_format) return fmt::format("{} where the `format` line is needed", in_quotes(all));
  if (word == "element") {
    Element element;
    element.name = take_word(line);
    const auto count = to_number<std::uint64_t>(take_word(line));
    if (element.name.empty() || !count || !only_white_space(line)) {
      return fmt::format("{}; `element NAME COUNT` is needed", in_quotes(all));
    }
    for (const Element& other : header.elements) {
      if (other.name == element.name)
        return fmt::format("element {} stands twice", in_quotes(element.name));
    }
    element.count = *count;
    header.elements.push_back(std::move(element));
    return {};
  }
  if (word == "property") {
    auto property = parse_property(line);
    if (!property || header.elements.empty()) {
      return fmt::format("{}; `property [list INTEGER_TYPE] TYPE NAME` below an element is needed",
                         in_quotes(all));
    }
    auto& properties = header.elements.back().properties;
    for (const Property& other : properties) {
      if (other.name == property->name)
        return fmt::format("property {} stands twice", in_quotes(other.name));
    }
    properties.push_back(std::move(*property));
    return {};
  }
  return fmt::format("{}; format, comment, element, property or end_header is needed",
                     in_quotes(all));
}

/// Reads the values after the header one by one, ascii or binary.
class Body {
 public:
  Body(TextLines lines, Format format, std::string_view name)
      : lines_(lines),
        format_(format),
        name_(name),
        data_(lines.rest()),
        data_begin_(lines.byte()) {}

  [[nodiscard]] bool start_row() {
    if (format_ != Format::ascii) return true;
    const auto line = lines_.next();
    if (line) line_ = *line;
    return line.has_value() || wrong("the file ends here, more rows are due");
  }
  [[nodiscard]] bool take(NumberType type, double& value) {
    if (format_ == Format::ascii) {
      const std::string_view word = take_word(line_);
      const auto number = from_word(word, type);
      if (number) value = *number;
      return number.has_value() ||
             wrong(word.empty() ? "too few values in this row"
                                : in_quotes(word) + " is not a number of the declared type");
    }
    const std::size_t size = size_of(type);
    if (data_.size() - at_ < size) return wrong("the file ends within a row");
    value = from_bytes(data_.data() + at_, type, format_ == Format::big_endian);
    at_ += size;
    return true;
  }
  [[nodiscard]] bool end_row() {
    return format_ != Format::ascii || only_white_space(line_) ||
           wrong("too many values in this row: " + in_quotes(line_));
  }
  [[nodiscard]] bool end() {
    const bool over = only_white_space(rest());
    return over || wrong(fmt::format("{} bytes follow the last row", rest().size()));
  }
  [[nodiscard]] std::string_view rest() const {
    return format_ == Format::ascii ? lines_.rest() : data_.substr(at_);
  }
  /// Records the fault and its place for `problem`; always false.
  bool wrong(const std::string& what) {
    problem_ = format_ == Format::ascii
                   ? fmt::format("{}:{}: {}", name_, lines_.number(), what)
                   : fmt::format("{}: byte {}: {}", name_, data_begin_ + at_, what);
    return false;
  }
  [[nodiscard]] const std::string& problem() const { return problem_; }

 private:
  TextLines lines_;
  Format format_;
  std::string_view name_;
  std::string_view data_;
  std::size_t data_begin_;
  std::size_t at_ = 0;
  std::string_view line_;
  std::string problem_;
};

/// Minimum size of a row; a list may be empty.
std::uint64_t min_row_bytes(const Element& element, Format format) {
  std::uint64_t bytes = 0;
  for (const Property& property : element.properties) {
    bytes += format == Format::ascii ? 2 : size_of(property.count_type.value_or(property.type));
  }
  return bytes;
}

/// Checks counts against the size of the data, and that x, y and z are there.
Result<void> check_header(const PlyHeader& header, std::string_view name, std::size_t data_bytes) {
  const Element* vertices = nullptr;
  // The last line of an ascii file may lack its newline.
  std::uint64_t left = data_bytes + (header.format == Format::ascii ? 1 : 0);
  for (const Element& element : header.elements) {
    const std::uint64_t least = min_row_bytes(element, header.format);
    if (least == 0)
      return fail(Fault::bad_input, "{}: element {} has no property", name,
                  in_quotes(element.name));
    if (element.count > left / least || element.count > std::numeric_limits<int>::max()) {
      return fail(
          Fault::bad_input,
          "{}: the header claims {} rows of {}, at least {} bytes each; {} bytes are left for them",
          name, element.count, in_quotes(element.name), least, left);
    }
    left -= element.count * least;
    if (element.name == "vertex") vertices = &element;
  }
  if (vertices == nullptr || vertices->count == 0)
    return fail(Fault::bad_input, "{}: holds no vertex", name);
  for (const char* axis : {"x", "y", "z"}) {
    bool found = false;
    for (const Property& property : vertices->properties) {
      found =
          found || (property.name == axis && !property.count_type && is_floating(property.type));
    }
    if (!found)
      return fail(Fault::bad_input, "{}: the vertices need `property float {}`, or double", name,
                  axis);
  }
  return {};
}

/// Takes a value, or a list and all that is in it.
bool skip(Body& body, const Property& property) {
  double value = 0.0;
  if (!body.take(property.count_type.value_or(property.type), value)) return false;
  if (!property.count_type) return true;
  if (value < 0.0) return body.wrong("a list of negative length");
  for (auto left = static_cast<std::uint64_t>(value); left > 0; --left) {
    if (!body.take(property.type, value)) return false;
  }
  return true;
}

bool read_vertices(Body& body, const Element& element, PointGatherer& points) {
  std::vector<std::size_t> slots;
  for (const Property& property : element.properties) {
    slots.push_back(static_cast<std::size_t>(PointGatherer::slot_of(property.name)));
  }
  PointGatherer::Values values = {};
  for (std::uint64_t row = 0; row < element.count; ++row) {
    if (!body.start_row()) return false;
    for (std::size_t k = 0; k < slots.size(); ++k) {
      const Property& property = element.properties[k];
      const bool taken =
          property.count_type ? skip(body, property) : body.take(property.type, values[slots[k]]);
      if (!taken) return false;
    }
    if (!body.end_row()) return false;
    if (!points.add(values))
      return body.wrong("a coordinate beyond 1000 km; coordinates are metres");
  }
  return true;
}

/// Splits polygons into fans of triangles, exact for convex polygons.
bool read_faces(Body& body, const Element& element, std::uint64_t vertices,
                std::vector<std::array<int, 3>>& triangles) {
  for (std::uint64_t row = 0; row < element.count; ++row) {
    if (!body.start_row()) return false;
    for (const Property& property : element.properties) {
      const bool corners = property.name == "vertex_indices" || property.name == "vertex_index";
      if (!corners || !property.count_type) {
        if (!skip(body, property)) return false;
        continue;
      }
      double value = 0.0;
      if (!body.take(*property.count_type, value)) return false;
      if (value < 3.0) return body.wrong(fmt::format("a face of {} corners", value));
      const auto count = static_cast<std::uint64_t>(value);
      std::array<int, 3> triangle = {};
      for (std::uint64_t k = 0; k < count; ++k) {
        if (!body.take(property.type, value)) return false;
        if (!(value >= 0.0 && value < static_cast<double>(vertices)) ||
            is_floating(property.type)) {
          return body.wrong(fmt::format("vertex {} does not exist; there are {}", value, vertices));
        }
        triangle[std::min<std::size_t>(k, 2)] = static_cast<int>(value);
        if (k < 2) continue;
        triangles.push_back(triangle);
        triangle[1] = triangle[2];
      }
    }
    if (!body.end_row()) return false;
  }
  return true;
}

bool read_others(Body& body, const Element& element) {
  for (std::uint64_t row = 0; row < element.count; ++row) {
    const auto taken = [&](const Property& property) { return skip(body, property); };
    if (!body.start_row() || !std::ranges::all_of(element.properties, taken) || !body.end_row())
      return false;
  }
  return true;
}

}  // namespace

Result<SurfaceFile> parse_ply(std::string_view content, std::string_view name) {
  TextLines lines(content);
  PlyHeader header;
  bool has_format = false;
  auto line = lines.next();
  if (!line || *line != "ply")
    return fail(Fault::bad_input, "{}:1: a PLY file begins with a line `ply`", name);
  while (true) {
    line = lines.next();
    if (!line)
      return fail(Fault::bad_input, "{}:{}: the header has no end_header", name, lines.number());
    if (*line == "end_header") break;
    const std::string problem = read_header_line(*line, header, has_format);
    if (!problem.empty()) return fail(Fault::bad_input, "{}:{}: {}", name, lines.number(), problem);
  }
  if (const auto sound = check_header(header, name, lines.rest().size()); !sound)
    return tl::unexpected(sound.error());

  Body body(lines, header.format, name);
  std::array<bool, PointGatherer::slots + 1> present = {};
  std::uint64_t vertices = 0;
  for (const Element& element : header.elements) {
    if (element.name != "vertex") continue;
    vertices = element.count;
    for (const Property& property : element.properties) {
      if (!property.count_type)
        present[static_cast<std::size_t>(PointGatherer::slot_of(property.name))] = true;
    }
  }
  PointGatherer points(present, vertices);
  std::vector<std::array<int, 3>> triangles;
  bool good = true;
  for (const Element& element : header.elements) {
    if (element.name == "vertex")
      good = read_vertices(body, element, points);
    else if (element.name == "face")
      good = read_faces(body, element, vertices, triangles);
    else
      good = read_others(body, element);
    if (!good) break;
  }
  if (!good || !body.end()) return tl::unexpected(Error{Fault::bad_input, body.problem()});
  for (const auto& triangle : triangles) points.add_triangle(triangle);
  return points.take();
}

}  // namespace tuina::surface_parts
