// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bit>
#include <concepts>
#include <cstring>
#include <optional>
#include <string>
#include <string_view>

#include "tuina/telemetry/mcap/records.hpp"

/// Records as bytes and back, [mcap] "Serialization": numbers little-endian, texts and maps behind
/// their length.
namespace tuina::telemetry::mcap {

static_assert(std::endian::native == std::endian::little);

/// Opcode and length stand before the content of a record.
inline constexpr std::size_t record_head_bytes = 9;

/// Visits the fields of a record and writes them.
class FieldWriter {
 public:
  /// Adds to the end of `out`.
  explicit FieldWriter(std::string& out) : out_(out) {}
  /// @{
  /// Writes one field: a number, a text behind its length, bytes behind theirs.
  template <std::unsigned_integral T>
  void operator()(T value) {
    out_.append(reinterpret_cast<const char*>(&value), sizeof value);
  }
  void operator()(std::string_view text) {
    (*this)(static_cast<std::uint32_t>(text.size()));
    out_.append(text);
  }
  void operator()(const LongBytes& data) {
    (*this)(static_cast<std::uint64_t>(data.bytes.size()));
    out_.append(data.bytes);
  }
  /// @}
  /// Maps and lists of pairs.
  template <typename Pairs>
  requires requires(const Pairs& pairs) { pairs.begin()->second; }
  void operator()(const Pairs& pairs) {
    const std::size_t at = out_.size();
    (*this)(std::uint32_t{0});
    for (const auto& [first, second] : pairs) {
      (*this)(first);
      (*this)(second);
    }
    const auto length = static_cast<std::uint32_t>(out_.size() - at - sizeof(std::uint32_t));
    std::memcpy(out_.data() + at, &length, sizeof length);
  }

 private:
  std::string& out_;
};

/// Takes fields from the front of some bytes; after a field that does not fit, none is.
class FieldReader {
 public:
  /// The bytes must outlive it.
  explicit FieldReader(std::string_view bytes) : rest_(bytes) {}
  /// @{
  /// Reads one field; it stays as it was where it does not fit.
  template <std::unsigned_integral T>
  void operator()(T& value) {
    const std::string_view bytes = take(sizeof value);
    if (fits_) std::memcpy(&value, bytes.data(), sizeof value);
  }
  void operator()(std::string& text) { text = take(length<std::uint32_t>()); }
  void operator()(LongBytes& data) { data.bytes = take(length<std::uint64_t>()); }
  template <typename Key, typename Value>
  void operator()(std::map<Key, Value>& map) {
    each_pair<Key, Value>([&](Key& key, Value& value) { map[std::move(key)] = std::move(value); });
  }
  template <typename First, typename Second>
  void operator()(std::vector<std::pair<First, Second>>& pairs) {
    each_pair<First, Second>([&](First& one, Second& two) { pairs.emplace_back(one, two); });
  }
  /// @}
  /// Whether every field has fitted so far.
  [[nodiscard]] bool fits() const { return fits_; }
  [[nodiscard]] std::string_view rest() const { return rest_; }  ///< bytes that no field has taken

 private:
  template <typename Length>
  std::uint64_t length() {
    Length value = 0;
    (*this)(value);
    return value;
  }
  std::string_view take(std::uint64_t size) {
    fits_ = fits_ && size <= rest_.size();
    if (!fits_) return {};
    const std::string_view taken = rest_.substr(0, size);
    rest_.remove_prefix(size);
    return taken;
  }
  template <typename First, typename Second, typename Keep>
  void each_pair(const Keep& keep) {
    FieldReader inside(take(length<std::uint32_t>()));
    while (inside.fits_ && !inside.rest_.empty()) {
      First first = {};
      Second second = {};
      inside(first);
      inside(second);
      if (inside.fits_) keep(first, second);
    }
    fits_ = fits_ && inside.fits_;
  }

  std::string_view rest_;
  bool fits_ = true;
};

/// Appends a record, head and content.
template <typename Record>
void append_record(std::string& out, const Record& record) {
  out.push_back(static_cast<char>(Record::opcode));
  const std::size_t at = out.size();
  FieldWriter writer(out);
  writer(std::uint64_t{0});
  Record::fields(writer, record);
  const std::uint64_t length = out.size() - at - sizeof(std::uint64_t);
  std::memcpy(out.data() + at, &length, sizeof length);
}

/// A record from its content; nothing where a field does not fit or bytes are left over.
template <typename Record>
[[nodiscard]] std::optional<Record> parse_record(std::string_view content) {
  Record record;
  FieldReader reader(content);
  Record::fields(reader, record);
  return reader.fits() && reader.rest().empty() ? std::optional(std::move(record)) : std::nullopt;
}

}  // namespace tuina::telemetry::mcap
