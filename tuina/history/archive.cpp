// SPDX-License-Identifier: Apache-2.0
#include "tuina/history/archive.hpp"

#include <archive.h>
#include <archive_entry.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <fstream>
#include <memory>
#include <optional>
#include <utility>

#include "tuina/core/io/file.hpp"

namespace tuina::history {
namespace {

namespace fs = std::filesystem;

/// A ZIP file that comes into being, a file at a time.
class Zip {
 public:
  static Result<Zip> open(const fs::path& path) {
    auto file = FileWriter::open(path, Readers::owner);
    if (!file) return tl::unexpected(file.error());
    Zip zip(std::move(*file));
    archive* one = zip.archive_.get();
    const bool begun = one != nullptr && archive_write_set_format_zip(one) == ARCHIVE_OK &&
                       archive_write_set_options(one, "zip:hdrcharset=UTF-8") == ARCHIVE_OK &&
                       archive_write_set_bytes_in_last_block(one, 1) == ARCHIVE_OK &&
                       archive_write_open2(one, zip.sink_.get(), nullptr, &Zip::write, nullptr,
                                           nullptr) == ARCHIVE_OK;
    if (!begun) return tl::unexpected(zip.fault("begun"));
    return zip;
  }

  Result<void> add(const std::string& name, const std::string& content) {
    if (auto begun = begin(name, content.size(), std::nullopt); !begun) return begun;
    return append(name, content.data(), content.size());
  }

  Result<void> add_file(const std::string& name, const fs::path& from) {
    std::error_code none;
    const std::uintmax_t bytes = fs::file_size(from, none);
    std::ifstream in(from, std::ios::binary);
    if (none || !in) return fail(Fault::file, "{}: cannot be read", from.string());
    if (auto begun = begin(name, bytes, fs::last_write_time(from, none)); !begun) return begun;
    std::vector<char> part(std::size_t{1} << 18);
    std::uintmax_t left = bytes;
    while (left > 0) {
      const auto wanted = std::min<std::uintmax_t>(left, part.size());
      in.read(part.data(), static_cast<std::streamsize>(wanted));
      const auto got = static_cast<std::size_t>(in.gcount());
      if (got == 0)
        return fail(Fault::file, "{}: ended {} bytes early while it was read", from.string(), left);
      if (auto put = append(name, part.data(), got); !put) return put;
      left -= got;
    }
    return {};
  }

  Result<void> finish() {
    if (archive_write_close(archive_.get()) != ARCHIVE_OK) return tl::unexpected(fault("finished"));
    return sink_->file.finish();
  }

 private:
  struct Sink {
    FileWriter file;
    std::optional<Error> error = {};
  };
  struct Free {
    void operator()(archive* one) const { archive_write_free(one); }
  };
  explicit Zip(FileWriter file)
      : sink_(std::make_unique<Sink>(Sink{std::move(file)})), archive_(archive_write_new()) {}

  static la_ssize_t write(archive*, void* to, const void* bytes, std::size_t count) {
    auto& sink = *static_cast<Sink*>(to);
    const auto put = sink.file.append({static_cast<const char*>(bytes), count});
    if (put) return static_cast<la_ssize_t>(count);
    sink.error = put.error();
    return -1;
  }

  Result<void> begin(const std::string& name, std::uintmax_t bytes,
                     std::optional<fs::file_time_type> changed) {
    const std::unique_ptr<archive_entry, void (*)(archive_entry*)> entry(archive_entry_new(),
                                                                         &archive_entry_free);
    archive_entry_set_pathname_utf8(entry.get(), name.c_str());
    archive_entry_set_filetype(entry.get(), AE_IFREG);
    archive_entry_set_perm(entry.get(), 0600);
    archive_entry_set_size(entry.get(), static_cast<la_int64_t>(bytes));
    if (changed) {
      const auto when = std::chrono::file_clock::to_sys(*changed);
      archive_entry_set_mtime(entry.get(), std::chrono::system_clock::to_time_t(when), 0);
    }
    if (archive_write_header(archive_.get(), entry.get()) != ARCHIVE_OK)
      return tl::unexpected(fault(name));
    return {};
  }

  Result<void> append(const std::string& name, const char* bytes, std::size_t count) {
    if (archive_write_data(archive_.get(), bytes, count) != static_cast<la_ssize_t>(count))
      return tl::unexpected(fault(name));
    return {};
  }

  [[nodiscard]] Error fault(const std::string& what) const {
    if (sink_->error) return *sink_->error;
    const char* words = archive_ ? archive_error_string(archive_.get()) : "no memory";
    return {Fault::file, fmt::format("the archive could not be written: {}: {}", what,
                                     words != nullptr ? words : "no reason is given")};
  }

  std::unique_ptr<Sink> sink_;  // the archive writes into it until its end
  std::unique_ptr<archive, Free> archive_;
};

/// Files in and below a folder, in the order of their names.
Result<std::vector<fs::path>> files_in(const fs::path& folder) {
  std::error_code fault;
  std::vector<fs::path> files;
  fs::recursive_directory_iterator entries(folder, fault);
  for (; !fault && entries != fs::recursive_directory_iterator(); entries.increment(fault)) {
    // What a link leads to is no part of the session.
    if (entries->symlink_status(fault).type() == fs::file_type::regular)
      files.push_back(entries->path());
  }
  if (fault) return fail(Fault::file, "{}: {}", folder.string(), fault.message());
  std::ranges::sort(files);
  return files;
}

bool lies_in(const fs::path& file, const fs::path& folder) {
  std::error_code fault;
  const fs::path inner = fs::weakly_canonical(file, fault), outer = fs::weakly_canonical(folder);
  return std::mismatch(outer.begin(), outer.end(), inner.begin(), inner.end()).first == outer.end();
}

constexpr const char* readme = R"(All that is kept of {}, as of {}

history.json   every session and every note of the index, as one JSON object
tissue.csv     what was felt at each place in each session; opens in any spreadsheet, and its first
               row says what the columns are and in which units
sessions/      the folder of each session as it was written. Begin with its report.html, which opens
               in any browser. session.json has all numbers, trace.csv the forces over time,
               scan.ply the measured surface of the back, session.mcap every millisecond.

Lengths are in metres, forces in newton and times in UTC where no unit is said.

Sessions:
)";

}  // namespace

Result<Archived> write_archive(const PersonHistory& person, const std::string& at,
                               const fs::path& file) {
  for (const Visit& visit : person.visits) {
    if (lies_in(file, visit.folder)) {
      return fail(Fault::usage, "{}: lies in the folder of a session, {}; elsewhere is right",
                  file.string(), visit.folder);
    }
  }
  auto zip = Zip::open(file);
  if (!zip) return tl::unexpected(zip.error());
  Archived archived;
  std::string sessions;
  for (std::size_t i = 0; i < person.visits.size(); ++i) {
    const Visit& visit = person.visits[i];
    const auto name = fmt::format("sessions/{:03}_{}", i + 1, visit.began.substr(0, 10));
    if (const auto there = still_in_its_folder(visit); !there) {
      const auto why = fmt::format("the session of {} is without its folder: {}", visit.began,
                                   there.error().message);
      archived.missing.push_back(why);
      sessions += fmt::format("  not here: {}\n", why);
      continue;
    }
    const auto files = files_in(visit.folder);
    if (!files) return tl::unexpected(files.error());
    for (const fs::path& one : *files) {
      const auto inside = one.lexically_relative(visit.folder).generic_string();
      if (auto added = zip->add_file(fmt::format("{}/{}", name, inside), one); !added)
        return tl::unexpected(added.error());
    }
    ++archived.sessions;
    archived.files += static_cast<std::int64_t>(files->size());
    sessions += fmt::format("  {}: {}, {}, {}, {} files\n", name, visit.began, visit.position,
                            visit.programme, files->size());
  }
  const std::array<std::pair<const char*, std::string>, 3> own = {
      {{"README.txt", fmt::format(fmt::runtime(readme), person.who, at) + sessions},
       {"history.json", to_json(person) + "\n"},
       {"tissue.csv", to_csv(person)}}};
  for (const auto& [name, content] : own) {
    if (auto added = zip->add(name, content); !added) return tl::unexpected(added.error());
    ++archived.files;
  }
  if (auto done = zip->finish(); !done) return tl::unexpected(done.error());
  return archived;
}

}  // namespace tuina::history
