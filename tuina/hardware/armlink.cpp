// SPDX-License-Identifier: Apache-2.0
#include "tuina/hardware/armlink.hpp"

#include <zlib.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

namespace tuina::hardware::armlink {
namespace {

constexpr std::string_view magic = "TARM";
constexpr std::size_t version_at = 4, kind_at = 5, size_at = 6, body_at = 16, crc_size = 4;

std::uint32_t crc_of(Bytes bytes) noexcept {
  return static_cast<std::uint32_t>(
      crc32_z(0, reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size()));
}

template <typename T>
T little_endian(Bytes bytes, std::size_t at) noexcept {
  T value = 0;
  for (std::size_t i = sizeof(T); i-- > 0;)
    value = static_cast<T>(value << 8U) | static_cast<T>(bytes[at + i]);
  return value;
}

constexpr std::size_t size_of(Kind kind) noexcept {
  constexpr std::array sizes = {ask_size, hello_size, command_size, state_size};
  return sizes[static_cast<std::size_t>(kind) - 1];
}

/// Puts one field behind the other; the sizes of the kinds stand in docs/armlink.md.
template <std::size_t size>
class Writer {
 public:
  Writer(Kind kind, std::uint32_t session, std::uint32_t sequence) noexcept {
    for (const char letter : magic) put(static_cast<std::uint8_t>(letter));
    put(protocol_version), put(static_cast<std::uint8_t>(kind)),
        put(static_cast<std::uint16_t>(size));
    put(session), put(sequence);
  }
  template <std::unsigned_integral T>
  void put(T value) noexcept {
    for (std::size_t i = 0; i < sizeof(T); ++i)
      bytes_[at_++] = static_cast<std::byte>(value >> (8U * i));
  }
  void put(double value) noexcept { put(std::bit_cast<std::uint64_t>(value)); }
  void put(const JointVector& joints) noexcept {
    for (Eigen::Index i = 0; i < max_joints; ++i) put(i < joints.size() ? joints[i] : 0.0);
  }
  void put(const Vector3& vector) noexcept {
    for (const double value : vector) put(value);
  }
  [[nodiscard]] std::array<std::byte, size> finish() noexcept {
    put(crc_of(Bytes(bytes_).first(at_)));
    return bytes_;
  }

 private:
  std::array<std::byte, size> bytes_ = {};
  std::size_t at_ = 0;
};

/// Takes one field after the other, and remembers whether all of them could be.
class Reader {
 public:
  explicit Reader(Bytes bytes) noexcept : bytes_(bytes) {}
  template <std::unsigned_integral T>
  T take() noexcept {
    const T value = little_endian<T>(bytes_, at_);
    at_ += sizeof(T);
    return value;
  }
  double number() noexcept {
    const auto value = std::bit_cast<double>(take<std::uint64_t>());
    sound_ = sound_ && std::isfinite(value);
    return value;
  }
  JointVector joints(std::uint8_t count) noexcept {
    JointVector vector(std::min<int>(count, max_joints));
    for (Eigen::Index i = 0; i < max_joints; ++i) {
      const bool used = i < vector.size();
      if (used) vector[i] = number();
      if (!used) demand(take<std::uint64_t>() == 0);
    }
    return vector;
  }
  Vector3 vector() noexcept {
    const double x = number(), y = number(), z = number();
    return {x, y, z};
  }
  std::uint8_t count() noexcept {
    const auto joints = take<std::uint8_t>();
    demand(joints >= 1 && joints <= max_joints);
    return joints;
  }
  Mode mode() noexcept {
    const auto mode = static_cast<Mode>(take<std::uint8_t>());
    demand(mode == Mode::idle || mode == Mode::torque || mode == Mode::ready);
    return mode;
  }
  void demand(bool holds) noexcept { sound_ = sound_ && holds; }
  [[nodiscard]] bool sound() const noexcept { return sound_; }

 private:
  Bytes bytes_;
  std::size_t at_ = body_at;
  bool sound_ = true;
};

/// A struct with the numbers of the header, once the datagram is whole and of this kind.
template <typename T>
Decoded<T> begin(Bytes datagram, Kind wanted) noexcept {
  const Decoded<Kind> kind = kind_of(datagram);
  if (!kind) return tl::unexpected(kind.error());
  if (*kind != wanted) return tl::unexpected(Spoilt::kind);
  T begun;
  begun.session = little_endian<std::uint32_t>(datagram, 8);
  begun.sequence = little_endian<std::uint32_t>(datagram, 12);
  return begun;
}

template <typename T>
Decoded<T> finish(const T& read, const Reader& from) noexcept {
  if (!from.sound()) return tl::unexpected(Spoilt::value);
  return read;
}

}  // namespace

std::string_view Hello::called() const noexcept {
  return {name.data(),
          static_cast<std::size_t>(std::find(name.begin(), name.end(), '\0') - name.begin())};
}

Decoded<Kind> kind_of(Bytes datagram) noexcept {
  if (datagram.size() < ask_size || std::memcmp(datagram.data(), magic.data(), magic.size()) != 0)
    return tl::unexpected(Spoilt::foreign);
  if (datagram[version_at] != std::byte{protocol_version}) return tl::unexpected(Spoilt::version);
  const auto kind = static_cast<std::uint8_t>(datagram[kind_at]);
  if (kind < 1 || kind > 4) return tl::unexpected(Spoilt::kind);
  const std::size_t size = size_of(static_cast<Kind>(kind));
  if (datagram.size() != size || little_endian<std::uint16_t>(datagram, size_at) != size)
    return tl::unexpected(Spoilt::size);
  const std::size_t crc_at = size - crc_size;
  if (little_endian<std::uint32_t>(datagram, crc_at) != crc_of(datagram.first(crc_at)))
    return tl::unexpected(Spoilt::checksum);
  return static_cast<Kind>(kind);
}

Decoded<Ask> decode_ask(Bytes datagram) noexcept {
  return begin<Ask>(datagram, Kind::ask);
}

Decoded<Hello> decode_hello(Bytes datagram) noexcept {
  Decoded<Hello> hello = begin<Hello>(datagram, Kind::hello);
  if (!hello) return hello;
  Reader reader(datagram);
  const std::uint8_t joints = reader.count();
  hello->modes = reader.take<std::uint8_t>();
  hello->flags = reader.take<std::uint16_t>();
  hello->cycle_us = reader.take<std::uint32_t>();
  bool ended = false;
  for (char& letter : hello->name) {
    letter = static_cast<char>(reader.take<std::uint8_t>());
    reader.demand(letter == '\0' || (!ended && letter >= ' ' && letter <= '~'));
    ended = letter == '\0';
  }
  reader.demand(ended);
  for (JointVector* limit :
       {&hello->max_torque_nm, &hello->max_speed_rad_per_s, &hello->min_rad, &hello->max_rad})
    *limit = reader.joints(joints);
  hello->min_rail_m = reader.number();
  hello->max_rail_m = reader.number();
  return finish(*hello, reader);
}

Decoded<Command> decode_command(Bytes datagram) noexcept {
  Decoded<Command> command = begin<Command>(datagram, Kind::command);
  if (!command) return command;
  Reader reader(datagram);
  command->answers = reader.take<std::uint32_t>();
  command->mode = reader.mode();
  const std::uint8_t joints = reader.count();
  const auto brake = reader.take<std::uint8_t>();
  reader.demand(brake <= 1);
  command->brake = brake == 1;
  reader.demand(reader.take<std::uint8_t>() == 0);
  command->rail_m = reader.number();
  command->values = reader.joints(joints);
  return finish(*command, reader);
}

Decoded<State> decode_state(Bytes datagram) noexcept {
  Decoded<State> state = begin<State>(datagram, Kind::state);
  if (!state) return state;
  Reader reader(datagram);
  state->answers = reader.take<std::uint32_t>();
  state->mode = reader.mode();
  const std::uint8_t joints = reader.count();
  state->status = reader.take<std::uint16_t>();
  state->time_s = reader.number();
  state->wrench_time_s = reader.number();
  state->rail_m = reader.number();
  state->q_rad = reader.joints(joints);
  state->dq_rad_per_s = reader.joints(joints);
  state->tau_nm = reader.joints(joints);
  state->wrench_in_tool.force_n = reader.vector();
  state->wrench_in_tool.torque_nm = reader.vector();
  return finish(*state, reader);
}

std::array<std::byte, ask_size> encode(const Ask& ask) noexcept {
  return Writer<ask_size>(Kind::ask, ask.session, ask.sequence).finish();
}

std::array<std::byte, hello_size> encode(const Hello& hello) noexcept {
  Writer<hello_size> writer(Kind::hello, hello.session, hello.sequence);
  writer.put(static_cast<std::uint8_t>(hello.max_torque_nm.size()));
  writer.put(hello.modes), writer.put(hello.flags), writer.put(hello.cycle_us);
  for (const char letter : hello.name) writer.put(static_cast<std::uint8_t>(letter));
  writer.put(hello.max_torque_nm), writer.put(hello.max_speed_rad_per_s);
  writer.put(hello.min_rad), writer.put(hello.max_rad);
  writer.put(hello.min_rail_m), writer.put(hello.max_rail_m);
  return writer.finish();
}

std::array<std::byte, command_size> encode(const Command& command) noexcept {
  Writer<command_size> writer(Kind::command, command.session, command.sequence);
  writer.put(command.answers), writer.put(static_cast<std::uint8_t>(command.mode));
  writer.put(static_cast<std::uint8_t>(command.values.size()));
  writer.put(static_cast<std::uint8_t>(command.brake)), writer.put(std::uint8_t{0});
  writer.put(command.rail_m), writer.put(command.values);
  return writer.finish();
}

std::array<std::byte, state_size> encode(const State& state) noexcept {
  Writer<state_size> writer(Kind::state, state.session, state.sequence);
  writer.put(state.answers), writer.put(static_cast<std::uint8_t>(state.mode));
  writer.put(static_cast<std::uint8_t>(state.q_rad.size())), writer.put(state.status);
  writer.put(state.time_s), writer.put(state.wrench_time_s), writer.put(state.rail_m);
  writer.put(state.q_rad), writer.put(state.dq_rad_per_s), writer.put(state.tau_nm);
  writer.put(state.wrench_in_tool.force_n), writer.put(state.wrench_in_tool.torque_nm);
  return writer.finish();
}

}  // namespace tuina::hardware::armlink
