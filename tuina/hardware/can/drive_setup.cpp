// SPDX-License-Identifier: Apache-2.0
#include "tuina/hardware/can/drive_setup.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <initializer_list>
#include <vector>

#include "tuina/hardware/udp_socket.hpp"

namespace tuina::hardware {
namespace {

using canopen::Object;
using namespace std::chrono_literals;

constexpr auto answer_patience = 200ms;
constexpr int sdo_tries = 3;
constexpr std::uint32_t cia402_profile = 402;

tl::unexpected<Error> bus_fails(const CanBus& bus) {
  return fail(Fault::device, "the bus {} {}", bus.name(), bus.fault());
}

/// The answer to a question, whatever else is on the bus.
Result<canopen::Answer> answer_to(CanBus& bus, std::uint8_t node, const Object& object,
                                  const can_frame& question) {
  for (int i = 0; i < sdo_tries; ++i) {
    bus.send(question);
    const auto deadline = std::chrono::steady_clock::now() + answer_patience;
    while (std::chrono::steady_clock::now() < deadline && bus.fault() == nullptr) {
      const int socket = bus.socket();
      wait_for_datagram({&socket, 1}, deadline);
      const auto frame = bus.receive();
      if (!frame || canopen::address_of(*frame).node != node) continue;
      const auto answer = canopen::answer_of(*frame);
      if (answer && answer->index == object.index && answer->sub == object.sub) return *answer;
    }
    if (bus.fault() != nullptr) return bus_fails(bus);
  }
  return fail(Fault::device, "node {} at {} does not answer", node, bus.name());
}

/// In millinewtonmetres by the standard; EPOS4 has micronewtonmetres.
bool is_rated(std::uint32_t told, double rated_torque_nm) {
  constexpr double tolerance = 0.01;
  const auto near = [&](double nm) {
    return std::abs(nm - rated_torque_nm) <= tolerance * rated_torque_nm;
  };
  return near(1e-3 * told) || near(1e-6 * told);
}

struct Entry {
  Object object;
  std::uint32_t value = 0;
};

/// One PDO: silent first, then what is in it, then valid again. It goes with every SYNC.
void add_pdo(std::vector<Entry>& entries, std::uint16_t parameters, std::uint32_t identifier,
             std::initializer_list<std::uint32_t> content) {
  constexpr std::uint32_t invalid = 1U << 31U;
  const auto mapping = static_cast<std::uint16_t>(parameters + 0x200);
  entries.push_back({{parameters, 1}, identifier | invalid});
  entries.push_back({{parameters, 2, 1}, 1});
  entries.push_back({{mapping, 0, 1}, 0});
  std::uint8_t sub = 0;
  for (const std::uint32_t what : content) entries.push_back({{mapping, ++sub}, what});
  entries.push_back({{mapping, 0, 1}, sub});
  entries.push_back({{parameters, 1}, identifier});
}

std::vector<Entry> entries_of(const DriveDevice& device, const DriveLimits& limits) {
  namespace object = cia402::object;
  const double permille = 1e3 * limits.max_torque_nm / std::abs(device.rated_torque_at_joint_nm());
  const double following = limits.max_following_rad * std::abs(device.counts_per_rad());
  constexpr std::uint32_t ramp_then_off = 2, do_quick_stop = 3, milli = 0xFD;
  const auto identifier = [&](canopen::Kind kind) {
    return static_cast<std::uint32_t>(kind) | device.node;
  };
  std::vector<Entry> entries = {
      {object::control_word, cia402::control::disable},
      {object::mode, static_cast<std::uint32_t>(cia402::Mode::position)},
      {object::max_torque, static_cast<std::uint32_t>(std::lround(permille))},
      {object::max_following, static_cast<std::uint32_t>(std::lround(following))},
      {object::cycle_time, 1},
      {object::cycle_power, milli},
      {object::quick_stop_way, ramp_then_off},
      {object::host_lost, do_quick_stop},
      {object::host_heartbeat,
       std::uint32_t{canopen::host_node} << 16U | cia402::max_host_silence_ms},
      {object::own_heartbeat, cia402::ms_a_drive_heartbeat},
  };
  // Index, sub-index and bits of what is in each PDO; a drive never answers a remote request.
  constexpr std::uint32_t no_remote = 1U << 30U;
  add_pdo(entries, 0x1400, identifier(canopen::Kind::ordered), {0x60400010, 0x60710010});
  add_pdo(entries, 0x1401, identifier(canopen::Kind::placed), {0x607A0020});
  add_pdo(entries, 0x1800, no_remote | identifier(canopen::Kind::told),
          {0x60410010, 0x60640020, 0x60770010});
  return entries;
}

/// PDOs that a maker has left on would take bits that were not counted.
Result<void> silence_others(CanBus& bus, std::uint8_t node) {
  constexpr std::uint32_t invalid = 1U << 31U;
  for (std::uint16_t index = 0x1801; index <= 0x1803; ++index) {
    const Object identifier{index, 1};
    const auto answer = answer_to(bus, node, identifier, canopen::ask(node, identifier));
    if (!answer) return tl::unexpected(answer.error());
    const bool speaks =
        answer->kind == canopen::Answer::Kind::read && (answer->value & invalid) == 0;
    if (!speaks) continue;
    if (auto done = write_object(bus, node, identifier, answer->value | invalid); !done)
      return done;
  }
  return {};
}

Result<void> reset_fault(CanBus& bus, std::uint8_t node) {
  namespace object = cia402::object;
  for (const std::uint16_t word : {cia402::control::reset, cia402::control::disable})
    if (auto done = write_object(bus, node, object::control_word, word); !done) return done;
  const auto status = read_object(bus, node, object::status_word);
  if (!status) return tl::unexpected(status.error());
  if (cia402::state_of(static_cast<std::uint16_t>(*status)) != cia402::State::fault) return {};
  const auto code = read_object(bus, node, object::error_code);
  if (!code) return tl::unexpected(code.error());
  return fail(Fault::device, "node {} at {} stays in fault 0x{:04X}: {}", node, bus.name(), *code,
              canopen::meaning_of_emergency(static_cast<std::uint16_t>(*code)));
}

}  // namespace

Result<std::uint32_t> read_object(CanBus& bus, std::uint8_t node, const Object& object) {
  const auto answer = answer_to(bus, node, object, canopen::ask(node, object));
  if (!answer) return tl::unexpected(answer.error());
  if (answer->kind == canopen::Answer::Kind::read) return answer->value;
  return fail(Fault::device, "node {} at {} does not tell 0x{:04X}: {} (0x{:08X})", node,
              bus.name(), object.index, canopen::meaning_of_refusal(answer->value), answer->value);
}

Result<void> write_object(CanBus& bus, std::uint8_t node, const Object& object,
                          std::uint32_t value) {
  const auto answer = answer_to(bus, node, object, canopen::write(node, object, value));
  if (!answer) return tl::unexpected(answer.error());
  if (answer->kind == canopen::Answer::Kind::written) return {};
  return fail(Fault::device, "node {} at {} refuses {} for 0x{:04X}:{}: {} (0x{:08X})", node,
              bus.name(), value, object.index, object.sub,
              canopen::meaning_of_refusal(answer->value), answer->value);
}

Result<FoundDrive> find_drive(CanBus& bus, const DriveDevice& device) {
  namespace object = cia402::object;
  constexpr std::array asked = {object::device_type, object::vendor,       object::product,
                                object::serial,      object::rated_torque, object::status_word,
                                object::counts};
  std::array<std::uint32_t, asked.size()> told = {};
  for (std::size_t i = 0; i < asked.size(); ++i) {
    const auto value = read_object(bus, device.node, asked[i]);
    if (!value) return tl::unexpected(value.error());
    told[i] = *value;
    if (i == 0 && (told[0] & 0xFFFFU) != cia402_profile)
      return fail(Fault::device,
                  "node {} at {} is no drive of CiA 402: its device type is 0x{:08X}", device.node,
                  bus.name(), told[0]);
  }
  if (!is_rated(told[4], device.rated_torque_nm))
    return fail(Fault::device,
                "node {} at {} says {} for its rated torque 0x6076, which is not the {} Nm of the "
                "file; mend the one that is wrong",
                device.node, bus.name(), told[4], device.rated_torque_nm);
  const auto counts = static_cast<std::int32_t>(told[6]);
  return FoundDrive{.vendor = told[1],
                    .product = told[2],
                    .serial = told[3],
                    .state = cia402::state_of(static_cast<std::uint16_t>(told[5])),
                    .joint_rad = (counts - device.zero_count) / device.counts_per_rad()};
}

Result<void> set_up_drive(CanBus& bus, const DriveDevice& device, const DriveLimits& limits) {
  bus.send(canopen::network(canopen::Network::prepare, device.node));
  const auto found = find_drive(bus, device);
  if (!found) return tl::unexpected(found.error());
  if (found->state == cia402::State::fault)
    if (auto done = reset_fault(bus, device.node); !done) return done;
  for (const Entry& entry : entries_of(device, limits))
    if (auto done = write_object(bus, device.node, entry.object, entry.value); !done) return done;
  return silence_others(bus, device.node);
}

}  // namespace tuina::hardware
