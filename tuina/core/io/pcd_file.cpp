// SPDX-License-Identifier: Apache-2.0
// PCD 0.7, the format of the Point Cloud Library: a header of text lines, then rows as text, rows
// of binary numbers, or columns compressed with LZF.
#include <algorithm>
#include <limits>

#include "tuina/core/io/surface_parts.hpp"
#include "tuina/core/io/text_lines.hpp"

namespace tuina::surface_parts {
namespace {

struct Field {
  std::string name;
  std::uint64_t size = 0;
  char kind = 'F';
  std::uint64_t count = 1;
  NumberType type = NumberType::f32;
};

struct PcdHeader {
  std::vector<Field> fields;
  std::optional<std::uint64_t> width, height, points;
  std::string data;
  std::vector<std::string> seen;
};

std::optional<NumberType> type_of(char kind, std::uint64_t size) {
  using enum NumberType;
  if (kind == 'F')
    return size == 4 ? std::optional(f32) : size == 8 ? std::optional(f64) : std::nullopt;
  if (kind != 'I' && kind != 'U') return std::nullopt;
  const bool sign = kind == 'I';
  switch (size) {
    case 1:
      return sign ? i8 : u8;
    case 2:
      return sign ? i16 : u16;
    case 4:
      return sign ? i32 : u32;
    case 8:
      return sign ? i64 : u64;
    default:
      return std::nullopt;
  }
}

std::vector<std::string_view> words_of(std::string_view line) {
  std::vector<std::string_view> words;
  for (auto word = take_word(line); !word.empty(); word = take_word(line)) words.push_back(word);
  return words;
}

/// Fault of a header line; empty when it is right.
std::string read_header_line(std::string_view line, PcdHeader& header) {
  auto words = words_of(line);
  if (words.empty()) return "a blank line in the header";
  const std::string key(words.front());
  words.erase(words.begin());
  if (std::find(header.seen.begin(), header.seen.end(), key) != header.seen.end())
    return key + " stands twice";
  header.seen.push_back(key);

  if (key == "FIELDS") {
    for (const auto word : words) header.fields.push_back({.name = std::string(word)});
    return words.empty() ? "FIELDS names no field" : "";
  }
  if (key == "SIZE" || key == "TYPE" || key == "COUNT") {
    if (header.fields.empty() || words.size() != header.fields.size()) {
      return fmt::format("{} has {} values for {} fields", key, words.size(), header.fields.size());
    }
    for (std::size_t k = 0; k < words.size(); ++k) {
      Field& field = header.fields[k];
      if (key == "TYPE") {
        if (words[k].size() != 1)
          return fmt::format("TYPE {}; F, I or U is needed", in_quotes(words[k]));
        field.kind = words[k].front();
        continue;
      }
      const auto number = to_number<std::uint64_t>(words[k]);
      if (!number || *number == 0 || *number > 65536)
        return fmt::format("{} {}; a count is needed", key, in_quotes(words[k]));
      (key == "SIZE" ? field.size : field.count) = *number;
    }
    return {};
  }
  if (key == "VERSION") {
    const bool known = words.size() == 1 && (words[0] == "0.7" || words[0] == ".7");
    return known ? "" : fmt::format("{}; `VERSION 0.7` is needed", in_quotes(line));
  }
  if (key == "VIEWPOINT") {
    const bool right =
        words.size() == 7 && std::all_of(words.begin(), words.end(), [](std::string_view word) {
          return to_number<double>(word).has_value();
        });
    return right ? "" : "VIEWPOINT needs seven numbers";
  }
  if (key == "WIDTH" || key == "HEIGHT" || key == "POINTS") {
    const auto number = words.size() == 1 ? to_number<std::uint64_t>(words[0]) : std::nullopt;
    if (!number || *number > std::numeric_limits<int>::max())
      return fmt::format("{}; a count is needed", in_quotes(line));
    (key == "WIDTH" ? header.width : key == "HEIGHT" ? header.height : header.points) = *number;
    return {};
  }
  if (key == "DATA") {
    header.data = words.size() == 1 ? std::string(words[0]) : "";
    const bool known =
        header.data == "ascii" || header.data == "binary" || header.data == "binary_compressed";
    return known ? ""
                 : fmt::format("{}; `DATA ascii|binary|binary_compressed` is needed",
                               in_quotes(line));
  }
  return fmt::format("{} is no word of a PCD header", in_quotes(key));
}

/// Fault of the header as a whole, or empty; fills in the types and the number of points.
std::string complete(PcdHeader& header) {
  for (const char* key : {"FIELDS", "SIZE", "TYPE", "WIDTH", "HEIGHT"}) {
    if (std::find(header.seen.begin(), header.seen.end(), key) == header.seen.end()) {
      return fmt::format("the header has no {}", key);
    }
  }
  for (Field& field : header.fields) {
    // PCL pads its records with fields named `_` of any size.
    const bool padding = field.name == "_" && header.data != "ascii";
    const auto type = padding ? NumberType::u8 : type_of(field.kind, field.size);
    if (!type)
      return fmt::format("field {} has TYPE {} and SIZE {}", in_quotes(field.name),
                         in_quotes({&field.kind, 1}), field.size);
    field.type = *type;
    if (padding) field.count *= field.size, field.size = 1;
    const auto twins = std::count_if(header.fields.begin(), header.fields.end(),
                                     [&](const Field& other) { return other.name == field.name; });
    if (twins > 1 && field.name != "_")
      return fmt::format("field {} stands twice", in_quotes(field.name));
  }
  for (const char* axis : {"x", "y", "z"}) {
    const auto found =
        std::find_if(header.fields.begin(), header.fields.end(), [&](const Field& field) {
          return field.name == axis && field.count == 1 && is_floating(field.type);
        });
    if (found == header.fields.end()) return fmt::format("a field {} of TYPE F is needed", axis);
  }
  if (!header.points) header.points = *header.width * *header.height;
  if (*header.points != *header.width * *header.height) {
    return fmt::format("POINTS {} is not WIDTH {} times HEIGHT {}", *header.points, *header.width,
                       *header.height);
  }
  return *header.points == 0 ? "holds no point" : "";
}

/// LZF as M. Lehmann's liblzf writes it: literal runs and references at most 8 kB back. False
/// unless the output has exactly the announced size.
bool decompress(std::string_view from, std::string& to) {
  std::size_t in = 0;
  std::size_t out = 0;
  while (in < from.size()) {
    const auto control = static_cast<unsigned char>(from[in++]);
    if (control < 32) {
      const std::size_t length = std::size_t{control} + 1;
      if (length > from.size() - in || length > to.size() - out) return false;
      std::copy_n(from.data() + in, length, to.data() + out);
      in += length;
      out += length;
      continue;
    }
    std::size_t length = control >> 5;
    if (length == 7) {
      if (in >= from.size()) return false;
      length += static_cast<unsigned char>(from[in++]);
    }
    length += 2;
    if (in >= from.size()) return false;
    const std::size_t back =
        (std::size_t{control} % 32) * 256 + static_cast<unsigned char>(from[in++]) + 1;
    if (back > out || length > to.size() - out) return false;
    // Source and target of a reference may overlap, so bytes are copied one by one.
    for (std::size_t k = 0; k < length; ++k, ++out) to[out] = to[out - back];
  }
  return out == to.size();
}

std::uint32_t little_endian(std::string_view bytes) {
  return static_cast<std::uint32_t>(from_bytes(bytes.data(), NumberType::u32, false));
}

PointGatherer gatherer_for(const PcdHeader& header) {
  std::array<bool, PointGatherer::slots + 1> present = {};
  for (const Field& field : header.fields) {
    if (field.count == 1)
      present[static_cast<std::size_t>(PointGatherer::slot_of(field.name))] = true;
  }
  return PointGatherer(present, *header.points);
}

std::size_t slot_of(const Field& field) {
  return static_cast<std::size_t>(field.count == 1 ? PointGatherer::slot_of(field.name)
                                                   : PointGatherer::Slot::none);
}

constexpr const char* too_far = "a coordinate beyond 1000 km; coordinates are metres";

Result<SurfaceFile> read_ascii(TextLines lines, const PcdHeader& header, std::string_view name) {
  std::uint64_t row_words = 0;
  for (const Field& field : header.fields) row_words += field.count;
  const std::uint64_t row_bytes = 2 * std::max<std::uint64_t>(row_words, 1);  // at the least
  if (*header.points > (lines.rest().size() + 1) / row_bytes) {
    return fail(Fault::bad_input, "{}: the header claims {} points, {} bytes follow it", name,
                *header.points, lines.rest().size());
  }
  PointGatherer points = gatherer_for(header);
  PointGatherer::Values values = {};
  for (std::uint64_t row = 0; row < *header.points; ++row) {
    auto line = lines.next();
    if (!line) {
      return fail(Fault::bad_input, "{}:{}: the file ends after {} of {} points", name,
                  lines.number(), row, *header.points);
    }
    for (const Field& field : header.fields) {
      for (std::uint64_t k = 0; k < field.count; ++k) {
        const std::string_view word = take_word(*line);
        const auto number = from_word(word, field.type);
        if (!number) {
          return fail(Fault::bad_input, "{}:{}: {} is {}, a number of its declared type is needed",
                      name, lines.number(), in_quotes(field.name), in_quotes(word));
        }
        values[slot_of(field)] = *number;
      }
    }
    if (!only_white_space(*line)) {
      return fail(Fault::bad_input, "{}:{}: too many values in this row: {}", name, lines.number(),
                  in_quotes(*line));
    }
    if (!points.add(values))
      return fail(Fault::bad_input, "{}:{}: {}", name, lines.number(), too_far);
  }
  if (!only_white_space(lines.rest())) {
    return fail(Fault::bad_input, "{}:{}: {} bytes follow the last point", name, lines.number() + 1,
                lines.rest().size());
  }
  return points.take();
}

/// Rows of numbers, or, if compressed, column after column.
Result<SurfaceFile> read_binary(TextLines lines, const PcdHeader& header, std::string_view name) {
  std::uint64_t row_bytes = 0;
  for (const Field& field : header.fields) row_bytes += field.size * field.count;
  // Larger than any file, and small enough that the product cannot overflow.
  constexpr std::uint64_t most = std::uint64_t{1} << 40;
  const std::uint64_t needed =
      row_bytes > most / *header.points ? most : row_bytes * *header.points;
  std::string_view data = lines.rest();
  std::size_t begin = lines.byte();
  std::string unpacked_data;
  std::string_view columns;
  const bool compressed = header.data == "binary_compressed";
  if (compressed) {
    const std::uint64_t packed = data.size() < 8 ? 0 : little_endian(data);
    const std::uint64_t unpacked = data.size() < 8 ? 0 : little_endian(data.substr(4));
    // Three bytes of LZF expand to at most 264.
    if (data.size() < 8 || packed > data.size() - 8 || unpacked != needed ||
        unpacked / 88 > packed) {
      return fail(Fault::bad_input,
                  "{}: byte {}: {} points of {} bytes cannot come from {} compressed bytes said to "
                  "make {}; {} follow",
                  name, begin, *header.points, row_bytes, packed, unpacked, data.size());
    }
    unpacked_data.resize(unpacked);
    if (!decompress(data.substr(8, packed), unpacked_data)) {
      return fail(Fault::bad_input, "{}: byte {}: the compressed data are damaged", name,
                  begin + 8);
    }
    columns = unpacked_data;
    begin += 8 + packed;
    data.remove_prefix(8 + packed);
  } else {
    if (needed > data.size()) {
      return fail(Fault::bad_input,
                  "{}: byte {}: the header claims {} points of {} bytes, {} bytes follow", name,
                  begin, *header.points, row_bytes, data.size());
    }
    columns = data.substr(0, needed);
    begin += needed;
    data.remove_prefix(needed);
  }
  if (!only_white_space(data)) {
    return fail(Fault::bad_input, "{}: byte {}: {} bytes follow the last point", name, begin,
                data.size());
  }
  PointGatherer points = gatherer_for(header);
  PointGatherer::Values values = {};
  for (std::uint64_t row = 0; row < *header.points; ++row) {
    std::uint64_t offset = 0;  // offset of the field: within a row, or of its column
    for (const Field& field : header.fields) {
      const std::uint64_t bytes = field.size * field.count;
      const std::uint64_t at = compressed ? offset + row * bytes : row * row_bytes + offset;
      values[slot_of(field)] = from_bytes(columns.data() + at, field.type, false);
      offset += compressed ? bytes * *header.points : bytes;
    }
    if (!points.add(values)) return fail(Fault::bad_input, "{}: point {}: {}", name, row, too_far);
  }
  return points.take();
}

}  // namespace

Result<SurfaceFile> parse_pcd(std::string_view content, std::string_view name) {
  TextLines lines(content);
  PcdHeader header;
  while (header.data.empty()) {
    const auto line = lines.next();
    if (!line) return fail(Fault::bad_input, "{}:{}: the header has no DATA", name, lines.number());
    if (line->starts_with('#')) continue;
    const std::string problem = read_header_line(*line, header);
    if (!problem.empty()) return fail(Fault::bad_input, "{}:{}: {}", name, lines.number(), problem);
  }
  const std::string problem = complete(header);
  if (!problem.empty()) return fail(Fault::bad_input, "{}: {}", name, problem);
  return header.data == "ascii" ? read_ascii(lines, header, name)
                                : read_binary(lines, header, name);
}

}  // namespace tuina::surface_parts
