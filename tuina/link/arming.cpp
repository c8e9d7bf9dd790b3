// SPDX-License-Identifier: Apache-2.0
#include "tuina/link/arming.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <cstring>
#include <type_traits>

#include "tuina/core/io/file.hpp"
#include "tuina/link/wire.hpp"

namespace tuina::link {
namespace {

constexpr std::array<char, 8> magic = {'t', 'u', 'i', 'n', 'a', 'a', 'r', 'm'};
constexpr std::size_t head_bytes = magic.size() + sizeof(wire::layout);
constexpr std::uint32_t max_items = 1'000'000;  // of a list: cells of a back, most of all

/// Appends what it is shown to a text of bytes.
class Writer {
 public:
  template <typename Number>
  requires std::is_arithmetic_v<Number> || std::is_enum_v<Number>
  void item(const Number& number) {
    bytes.append(reinterpret_cast<const char*>(&number), sizeof number);
  }
  template <typename Vector, typename Each>
  void list(const Vector& items, const Each& each) {
    item(static_cast<std::uint32_t>(items.size()));
    for (const auto& one : items) each(one);
  }
  std::string bytes;
};

/// Takes the same out again; after the first thing that is not there all else is left as it is.
class Reader {
 public:
  explicit Reader(const std::string& bytes) : bytes_(bytes) {}
  template <typename Number>
  requires std::is_arithmetic_v<Number> || std::is_enum_v<Number>
  void item(Number& number) {
    ok = ok && bytes_.size() - at_ >= sizeof number;
    if (!ok) return;
    if constexpr (std::is_same_v<Number, bool>) {
      const char byte = bytes_[at_];  // in a bool, any but these two is undefined behaviour
      sound = sound && (byte == 0 || byte == 1);
      number = byte == 1;
    } else {
      std::memcpy(&number, bytes_.data() + at_, sizeof number);
    }
    if constexpr (std::is_floating_point_v<Number>) sound = sound && !std::isnan(number);
    at_ += sizeof number;
  }
  template <typename Vector, typename Each>
  void list(Vector& items, const Each& each) {
    std::uint32_t count = 0;
    item(count);
    ok = ok && count <= max_items && count <= bytes_.size() - at_;
    if (!ok) return;
    items.resize(count);
    for (auto& one : items) each(one);
  }
  [[nodiscard]] bool whole() const { return ok && at_ == bytes_.size(); }
  bool ok = true;
  bool sound = true;  ///< so far each number is one, and each yes or no is either

 private:
  const std::string& bytes_;
  std::size_t at_ = 0;
};

template <typename Archive, typename Matrix>
void visit_matrix(Archive& archive, Matrix& matrix) {
  for (Eigen::Index i = 0; i < matrix.size(); ++i) archive.item(matrix.data()[i]);
}

template <typename Archive, typename Pose>
void visit_pose(Archive& archive, Pose& pose) {
  visit_matrix(archive, pose.matrix());
}

template <typename Archive, typename ArmLink>
void visit_link(Archive& archive, ArmLink& link) {
  archive.list(link.name, [&](auto& letter) { archive.item(letter); });
  for (auto* number :
       {&link.offset_rad, &link.d_m, &link.a_m, &link.alpha_rad, &link.mass_kg,
        &link.rotor_inertia_kg_m2, &link.coulomb_nm, &link.viscous_nm_s_per_rad, &link.min_rad,
        &link.max_rad, &link.torque_limit_nm, &link.speed_limit_rad_per_s, &link.radius_m})
    archive.item(*number);
  for (auto* three : {&link.com_in_joint, &link.inertia_kg_m2, &link.inertia_products_kg_m2})
    for (auto& number : *three) archive.item(number);
}

/// The one list of what is in the file, in its order.
template <typename Archive, typename Told>
void visit(Archive& archive, Told& told) {
  archive.item(told.arm.joints);
  for (auto& link : told.arm.links) visit_link(archive, link);
  archive.item(told.arm.tool_radius_m);
  archive.item(told.arm.tool_mass_kg);
  visit_matrix(archive, told.arm.end_from_tool_turn);
  visit_pose(archive, told.mount.base_from_couch);
  for (auto& pose : told.mount.base_from_shoulder.of) visit_pose(archive, pose);
  visit_matrix(archive, told.mount.rail_axis_in_base);
  archive.list(told.options.obstacles, [&](auto& box) {
    archive.item(box.kind);
    visit_pose(archive, box.base_from_box);
    visit_matrix(archive, box.edges_m);
    archive.item(box.rides);
  });
  archive.item(told.options.max_set_force_n);
  archive.item(told.options.bench);
  archive.item(told.options.leased);
  auto& field = told.options.field;
  for (auto* place : {&field.corner_in_base, &field.along_in_base, &field.up_in_base})
    visit_matrix(archive, *place);
  archive.item(field.cell_m);
  archive.item(field.columns);
  archive.item(field.rows);
  archive.list(field.cells, [&](auto& cell) {
    archive.item(cell.zone);
    visit_matrix(archive, cell.normal_in_base);
  });
}

/// What is impossible in an arming, or null.
const char* impossible(const Arming& told) {
  const safety::ZoneField& field = told.options.field;
  if (told.arm.joints < 1 || told.arm.joints > max_joints) return "the number of joints";
  if (!told.arm.torque_limits_nm().allFinite() || told.arm.torque_limits_nm().minCoeff() <= 0.0)
    return "a torque limit";
  if (!(told.arm.tool_radius_m > 0.0) || !(told.arm.tool_mass_kg >= 0.0)) return "the tool";
  for (const Transform& pose : told.mount.base_from_shoulder.of)
    if (!pose.matrix().allFinite()) return "the place of a shoulder";
  if (!told.mount.base_from_couch.matrix().allFinite()) return "the place of the couch";
  if (!safety::is_unit(told.mount.rail_axis_in_base)) return "the axis of the linear base";
  for (const robot::Obstacle& box : told.options.obstacles) {
    // A box somewhere unknown is near to nothing, so the arms would not keep away from it.
    const bool there = box.base_from_box.matrix().allFinite() && box.edges_m.allFinite() &&
                       box.edges_m.minCoeff() >= 0.0;
    if (!there || static_cast<std::size_t>(box.kind) >= robot::both_surroundings.size())
      return "an obstacle";
  }
  const auto cells = static_cast<std::int64_t>(field.columns) * field.rows;
  if (field.columns < 0 || field.rows < 0 || cells != static_cast<std::int64_t>(field.cells.size()))
    return "the size of the back's grid";
  if (!(field.cell_m > 0.0) || !field.corner_in_base.allFinite()) return "the back's grid";
  for (const Vector3& axis : {field.along_in_base, field.up_in_base})
    if (!safety::is_unit(axis)) return "an axis of the back's grid";
  for (const safety::ZoneField::Cell& cell : field.cells) {
    if (static_cast<std::size_t>(cell.zone) >= safety::zones) return "a zone of the back";
    if (!safety::is_unit(cell.normal_in_base.cast<double>())) return "a normal of the back";
  }
  return nullptr;
}

std::string bytes_of(const Arming& arming) {
  Writer writer;
  writer.bytes.assign(magic.begin(), magic.end());
  writer.item(wire::layout);
  visit(writer, arming);
  return writer.bytes;
}

std::uint32_t crc_of(const std::string& bytes) {
  return wire::crc_of(reinterpret_cast<const std::byte*>(bytes.data()), bytes.size());
}

}  // namespace

Result<void> write_arming(const std::string& file, const Arming& arming) {
  Writer writer;
  writer.bytes = bytes_of(arming);
  writer.item(crc_of(writer.bytes));
  return write_file(file, writer.bytes, Readers::owner);
}

Result<Arming> parse_arming(const std::string& bytes, const std::string& name) {
  const bool ours = bytes.size() > head_bytes + sizeof(std::uint32_t) &&
                    std::memcmp(bytes.data(), magic.data(), magic.size()) == 0;
  if (!ours) return fail(Fault::bad_input, "{}: is no arming file of tuina", name);
  std::uint64_t layout = 0;
  std::memcpy(&layout, bytes.data() + magic.size(), sizeof layout);
  if (layout != wire::layout)
    return fail(Fault::bad_input, "{}: is of another version of tuina; arm once more", name);
  const std::size_t end = bytes.size() - sizeof(std::uint32_t);
  std::uint32_t crc = 0;
  std::memcpy(&crc, bytes.data() + end, sizeof crc);
  if (crc != crc_of(bytes.substr(0, end)))
    return fail(Fault::bad_input, "{}: is cut or spoilt: its check sum does not fit", name);
  const std::string body = bytes.substr(head_bytes, end - head_bytes);
  Reader reader(body);
  Arming arming;
  visit(reader, arming);
  if (!reader.whole()) return fail(Fault::bad_input, "{}: ends where it should not", name);
  if (const char* what = reader.sound ? impossible(arming) : "a number")
    return fail(Fault::bad_input, "{}: {} in it is impossible", name, what);
  return arming;
}

Result<Arming> read_arming(const std::string& file) {
  const auto bytes = read_file(file);
  if (!bytes) return tl::unexpected(bytes.error());
  return parse_arming(*bytes, file);
}

std::string describe(const Arming& arming) {
  return fmt::format(
      "{} joints an arm, {} obstacles, {} places of a back{}, at most {:.0f} N, {:08x}",
      arming.arm.joints, arming.options.obstacles.size(), arming.options.field.cells.size(),
      arming.options.bench ? " (a laboratory's bench: no person)" : "",
      std::min(arming.options.max_set_force_n, safety::ceiling_of(safety::Zone::muscle).set_n),
      crc_of(bytes_of(arming)));
}

}  // namespace tuina::link
