// SPDX-License-Identifier: Apache-2.0
#include "tuina/body/learn/registered_backs.hpp"

#include "tuina/body/fit_shape.hpp"
#include "tuina/core/io/scratch_folder.hpp"

namespace tuina::body {
namespace {

std::streamsize bytes_of(const Places& places) {
  return static_cast<std::streamsize>(sizeof(double)) * places.size();
}

constexpr std::streamsize frame_bytes = 16 * sizeof(double);

}  // namespace

Registered registered(const Template& standard, const Example& example,
                      const std::vector<std::string>& names) {
  // Labelled people who lie have their head where the couch frame says (docs/bodies.md).
  return {correspond(standard, example, names), couch_from_person(example.back).front()};
}

RegisteredBacks::RegisteredBacks(std::fstream file, Eigen::Index points)
    : file_(std::move(file)), points_(points) {}

Result<RegisteredBacks> RegisteredBacks::make(Eigen::Index points) {
  const auto folder = ScratchFolder::make();
  if (!folder) return tl::unexpected(folder.error());
  const auto path = folder->path() / "backs";
  std::fstream file(path, std::ios::in | std::ios::out | std::ios::binary | std::ios::trunc);
  if (!file) return fail(Fault::file, "{}: cannot be written", path.string());
  return RegisteredBacks(std::move(file), points);
}

Result<void> RegisteredBacks::add(const Registered& back) {
  file_.seekp(0, std::ios::end);
  file_.write(reinterpret_cast<const char*>(back.shape_in_couch.data()),
              bytes_of(back.shape_in_couch));
  file_.write(reinterpret_cast<const char*>(back.couch_from_person.matrix().data()), frame_bytes);
  file_.flush();
  ++count_;
  if (file_) return {};
  return fail(Fault::file,
              "the file of registered backs among the system's temporary ones (TMPDIR) takes no "
              "more after {}; each needs {} kB",
              count_ - 1, (bytes_of(back.shape_in_couch) + frame_bytes) / 1000);
}

Result<void> RegisteredBacks::read(std::size_t number, Registered& back) {
  back.shape_in_couch.resize(3, points_);
  const std::streamsize each = bytes_of(back.shape_in_couch) + frame_bytes;
  file_.seekg(static_cast<std::streamoff>(number) * each);
  file_.read(reinterpret_cast<char*>(back.shape_in_couch.data()), bytes_of(back.shape_in_couch));
  file_.read(reinterpret_cast<char*>(back.couch_from_person.matrix().data()), frame_bytes);
  if (file_) return {};
  return fail(Fault::file, "the file of registered backs cannot be read at number {} of {}", number,
              count_);
}

Backs RegisteredBacks::chosen(const std::function<bool(std::size_t)>& wanted) {
  Backs backs;
  for (std::size_t i = 0; i < count_; ++i) backs.count += wanted(i) ? 1 : 0;
  backs.visit = [this, wanted](const std::function<void(const Registered&)>& each) -> Result<void> {
    Registered back;
    for (std::size_t i = 0; i < count_; ++i) {
      if (!wanted(i)) continue;
      if (auto read_one = read(i, back); !read_one) return read_one;
      each(back);
    }
    return {};
  };
  return backs;
}

}  // namespace tuina::body
