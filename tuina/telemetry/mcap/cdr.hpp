// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

/// Messages as ROS 2 sends them: plain CDR, little-endian ([xtypes] 7.4, encoding version 1),
/// behind the four bytes that say so. A number stands at a multiple of its size after these.
namespace tuina::telemetry::ros {

static_assert(std::endian::native == std::endian::little);

template <typename T>
concept Number = std::is_arithmetic_v<T>;
/// The four bytes before every message.
inline constexpr std::string_view cdr_head("\0\1\0\0", 4);

/// Bytes that are left free so that a number of `size` bytes stands at a multiple of its size.
[[nodiscard]] constexpr std::size_t cdr_padding(std::size_t at, std::size_t size) {
  return (size - (at - cdr_head.size()) % size) % size;
}

/// Visits the fields of a message and writes them.
class CdrWriter {
 public:
  /// `out` is begun anew.
  explicit CdrWriter(std::string& out) : out_(out) { out_.assign(cdr_head); }
  /// Writes one field.
  template <typename T>
  void operator()(const char* /*name*/, const T& value) {
    put(value);
  }

 private:
  template <typename T>
  void put(const T& value) {
    T::fields(*this, value);
  }
  template <Number T>
  void put(const T& value) {
    append(&value, 1);
  }
  void put(std::byte value) { put(std::to_integer<std::uint8_t>(value)); }
  void put(const std::string& text) {
    put(static_cast<std::uint32_t>(text.size() + 1));
    out_.append(text.c_str(), text.size() + 1);
  }
  template <typename T>
  void put(const std::vector<T>& items) {
    put(static_cast<std::uint32_t>(items.size()));
    if constexpr (Number<T>) {
      if (!items.empty()) append(items.data(), items.size());
    } else {
      for (const T& item : items) put(item);
    }
  }
  template <Number T>
  void append(const T* first, std::size_t count) {
    out_.append(cdr_padding(out_.size(), sizeof(T)), '\0');
    out_.append(reinterpret_cast<const char*>(first), count * sizeof(T));
  }
  std::string& out_;
};

/// Visits the fields of a message and reads them; after one that does not fit, none is.
class CdrReader {
 public:
  /// The bytes of one message, which must outlive it.
  explicit CdrReader(std::string_view bytes)
      : bytes_(bytes), at_(cdr_head.size()), fits_(bytes.starts_with(cdr_head)) {}
  /// Reads one field.
  template <typename T>
  void operator()(const char* /*name*/, T& value) {
    take(value);
  }
  /// The message fits, and nothing but padding is left over.
  [[nodiscard]] bool whole() const { return fits_ && bytes_.size() - at_ < sizeof(double); }

 private:
  template <typename T>
  void take(T& value) {
    T::fields(*this, value);
  }
  template <Number T>
  void take(T& value) {
    copy(&value, 1);
  }
  void take(bool& value) {
    std::uint8_t byte = 0;
    take(byte);
    value = byte != 0;
  }
  void take(std::byte& value) {
    std::uint8_t byte = 0;
    take(byte);
    value = std::byte{byte};
  }
  void take(std::string& text) {
    const std::size_t size = count(1);
    fits_ = fits_ && size > 0 && bytes_[at_ + size - 1] == '\0';
    if (!fits_) return;
    text = bytes_.substr(at_, size - 1);
    at_ += size;
  }
  template <typename T>
  void take(std::vector<T>& items) {
    // Everything that is no number takes four bytes at least, so that a false count takes no
    // memory.
    constexpr std::size_t min_bytes = Number<T> ? sizeof(T) : sizeof(std::uint32_t);
    items.resize(count(min_bytes));
    if constexpr (Number<T>) {
      if (!items.empty()) copy(items.data(), items.size());
    } else {
      for (T& item : items) take(item);
    }
  }
  /// How many items of at least so many bytes follow; none where they would not fit.
  std::size_t count(std::size_t min_bytes) {
    std::uint32_t items = 0;
    take(items);
    fits_ = fits_ && items <= (bytes_.size() - at_) / min_bytes;
    return fits_ ? items : 0;
  }
  template <Number T>
  void copy(T* first, std::size_t items) {
    const std::size_t begin = at_ + cdr_padding(at_, sizeof(T));
    fits_ = fits_ && begin <= bytes_.size() && items * sizeof(T) <= bytes_.size() - begin;
    if (!fits_) return;
    std::memcpy(first, bytes_.data() + begin, items * sizeof(T));
    at_ = begin + items * sizeof(T);
  }

  std::string_view bytes_;
  std::size_t at_;
  bool fits_;
};

/// The bytes of a message, into memory that is used again.
template <typename Message>
void to_cdr(const Message& message, std::string& out) {
  CdrWriter writer(out);
  Message::fields(writer, message);
}

/// Nothing where the bytes are not those of such a message.
template <typename Message>
[[nodiscard]] std::optional<Message> from_cdr(std::string_view bytes) {
  Message message;
  CdrReader reader(bytes);
  Message::fields(reader, message);
  return reader.whole() ? std::optional(std::move(message)) : std::nullopt;
}

}  // namespace tuina::telemetry::ros
