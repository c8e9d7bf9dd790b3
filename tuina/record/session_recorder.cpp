// SPDX-License-Identifier: Apache-2.0
#include "tuina/record/session_recorder.hpp"

namespace tuina::record {
namespace {

namespace mcap = telemetry::mcap;

// With what a relay still holds, a crash then costs no more than a second.
constexpr std::uint64_t max_chunk_ns = 900'000'000;

/// What rosbag2 offers to subscribers: a latched topic goes to those that come later, too. The
/// numbers are those of rmw/types.h.
std::string qos(bool latched) {
  if (!latched) return "";
  return "- history: 1\n  depth: 1\n  reliability: 1\n  durability: 1\n"
         "  deadline:\n    sec: 0\n    nsec: 0\n  lifespan:\n    sec: 0\n    nsec: 0\n"
         "  liveliness: 0\n  liveliness_lease_duration:\n    sec: 0\n    nsec: 0\n"
         "  avoid_ros_namespace_conventions: false";
}

bool is_compressed(const std::string& name) {
  for (const char* ending : {".csv", ".json", ".ply", ".svg", ".html"})
    if (name.ends_with(ending)) return true;
  return false;
}

const char* media_type_of(const std::string& name) {
  constexpr std::pair<const char*, const char*> types[] = {{".zst", "application/zstd"},
                                                           {".html", "text/html"},
                                                           {".toml", "application/toml"},
                                                           {".urdf", "application/xml"}};
  for (const auto& [ending, type] : types)
    if (name.ends_with(ending)) return type;
  return "application/octet-stream";
}

}  // namespace

Result<std::unique_ptr<SessionRecorder>> SessionRecorder::begin(const std::filesystem::path& file,
                                                                const SessionStart& start,
                                                                const Attachments& attached) {
  auto opened = FileWriter::open(file);
  if (!opened) return tl::unexpected(opened.error());
  return std::unique_ptr<SessionRecorder>(new SessionRecorder(std::move(*opened), start, attached));
}

SessionRecorder::SessionRecorder(FileWriter file, const SessionStart& start,
                                 const Attachments& attached)
    : file_(std::move(file)),
      writer_([this](std::string_view bytes) { return file_.append(bytes); },
              {.library = "tuina " + start.version, .max_chunk_ns = max_chunk_ns}),
      channels_(*this, start) {
  keep(writer_.add_metadata(
      {.name = "tuina",
       .metadata = {
           {"version", start.version},
           {"seed", fmt::format("{}", start.seed)},
           {"clock", "time of the session, zero at the first millisecond of the robot"}}}));
  for (const auto& [name, content] : attached) attach(name, content);
}

void SessionRecorder::keep(Result<void> done) {
  if (state_ && !done) state_ = std::move(done);
}

std::uint16_t SessionRecorder::add_channel(const ChannelDescription& description) {
  std::map<std::string, std::string> metadata;
  if (description.encoding == "cdr") metadata["offered_qos_profiles"] = qos(description.latched);
  return writer_.add_channel(description.topic, description.encoding, description.schema,
                             std::move(metadata));
}

void SessionRecorder::write(std::uint16_t channel, std::uint64_t time_ns,
                            std::string_view message) {
  keep(writer_.write(channel, time_ns, message));
}

void SessionRecorder::on_map(const body::Mapping& map) {
  const bool known = !channels_.urdf().empty();
  channels_.on_map(map);
  if (!known) attach("robot.urdf", channels_.urdf());
}

void SessionRecorder::attach(const std::string& name, std::string_view content) {
  mcap::Compressor compressor(mcap::texts);
  const bool compressed = is_compressed(name);
  const std::string called = compressed ? name + ".zst" : name;
  keep(writer_.attach({.log_time_ns = to_ns(channels_.time_s()),
                       .name = called,
                       .media_type = media_type_of(called),
                       .data = {compressed ? compressor.compress(content) : content}}));
}

Result<void> SessionRecorder::finish(std::uint64_t last_tick,
                                     std::span<const std::filesystem::path> attached) {
  constexpr std::size_t max_bytes = std::size_t{1} << 30;
  channels_.tell_gap(last_tick + 1);
  for (const std::filesystem::path& path : attached) {
    std::error_code none;
    if (!std::filesystem::exists(path, none)) continue;
    const auto content = read_file(path, max_bytes);
    if (content) {
      attach(path.filename().string(), *content);
    } else {
      keep(tl::unexpected(content.error()));
    }
  }
  keep(writer_.finish());
  if (state_) return file_.finish();
  file_.leave_part();
  return state_;
}

}  // namespace tuina::record
