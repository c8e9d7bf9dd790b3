// SPDX-License-Identifier: Apache-2.0
#include "tuina/hardware/device_file.hpp"

#include "tuina/core/io/file.hpp"
#include "tuina/core/io/toml_reader.hpp"

namespace tuina::hardware {

Result<DeviceFile> parse_device_file(std::string_view text, std::string_view name) {
  DeviceFile file;
  const auto read = read_toml(text, name, Fault::config, [&](const TomlTable& root) {
    root.only({}, {"arm"});
    const auto arms = root.table("arm");
    if (arms) arms->only({}, {"left", "right"});
    for (const Arm arm : both_arms) {
      const auto section = arms ? arms->table(name_of(arm)) : std::nullopt;
      if (!section) continue;
      section->only({}, {"kind", "address"});
      (void)section->word("kind", {"armlink"});
      file.arms[arm].address = section->text("address").value_or("");
      const auto address = parse_udp_address(file.arms[arm].address);
      if (!address && section->has("address"))
        section->wrong("address", "is no IPv4 address and port, such as \"192.168.3.10:7001\"");
      file.arms[arm].udp = address.value_or(UdpAddress{});
      const bool both_known = address && arm == Arm::right && file.arms[Arm::left].udp.of.sin_port;
      if (both_known && *address == file.arms[Arm::left].udp)
        section->wrong("address", "is that of the left arm; each arm has an address of its own");
    }
  });
  if (!read) return tl::unexpected(read.error());
  return file;
}

Result<DeviceFile> read_device_file(const std::filesystem::path& file) {
  constexpr std::size_t max_bytes = 1 << 20;
  const auto text = read_file(file, max_bytes);
  if (!text) return tl::unexpected(text.error());
  return parse_device_file(*text, file.string());
}

}  // namespace tuina::hardware
