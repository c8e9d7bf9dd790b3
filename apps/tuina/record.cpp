// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>

#include "apps/tuina/verbs.hpp"
#include "tuina/record/event_fields.hpp"
#include "tuina/record/record_tables.hpp"
#include "tuina/record/session_folder.hpp"
#include "tuina/telemetry/table.hpp"

namespace tuina::app {
namespace {

using nlohmann::ordered_json;

/// What is seen of a record while its messages go by.
struct Seen {
  struct Span {
    double begin_s = 0.0, end_s = 0.0;
  };
  std::map<std::uint16_t, Span> channels;
  std::uint64_t missing_ms = 0;

  void take(const telemetry::mcap::Contents& file, const telemetry::mcap::Message& message) {
    const double time_s = 1e-9 * static_cast<double>(message.log_time_ns);
    Span& span = channels.try_emplace(message.channel_id, Span{time_s, time_s}).first->second;
    span.begin_s = std::min(span.begin_s, time_s);
    span.end_s = std::max(span.end_s, time_s);
    if (file.channels.at(message.channel_id).topic != record::GapEvent::topic) return;
    const auto gap = nlohmann::json::parse(message.data, nullptr, false);
    if (gap.is_object()) missing_ms += gap.value("missing_ms", std::uint64_t{0});
  }
};

ordered_json json_of(const telemetry::mcap::Contents& file, const Seen& seen) {
  ordered_json channels = ordered_json::array();
  for (const auto& [id, channel] : file.channels) {
    const auto schema = file.schemas.find(channel.schema_id);
    const auto count = file.channel_messages.find(id);
    const auto span = seen.channels.find(id);
    const bool any = span != seen.channels.end();
    channels.push_back({{"topic", channel.topic},
                        {"schema", schema == file.schemas.end() ? "" : schema->second.name},
                        {"encoding", channel.message_encoding},
                        {"messages", count == file.channel_messages.end() ? 0 : count->second},
                        {"begin_s", any ? ordered_json(span->second.begin_s) : ordered_json()},
                        {"end_s", any ? ordered_json(span->second.end_s) : ordered_json()}});
  }
  ordered_json attachments = ordered_json::array(), metadata = ordered_json::object();
  for (const auto& one : file.attachments)
    attachments.push_back(
        {{"name", one.name}, {"media_type", one.media_type}, {"bytes", one.data.bytes.size()}});
  for (const auto& one : file.metadata) metadata[one.name] = one.metadata;
  const double begin_s = 1e-9 * static_cast<double>(file.begin_ns);
  const double end_s = 1e-9 * static_cast<double>(file.end_ns);
  return {{"profile", file.header.profile},
          {"library", file.header.library},
          {"whole", file.lost.empty()},
          {"begin_s", begin_s},
          {"end_s", end_s},
          {"duration_s", end_s - begin_s},
          {"chunks", file.chunks},
          {"messages", file.messages},
          {"missing_ms", seen.missing_ms},
          {"channels", std::move(channels)},
          {"attachments", std::move(attachments)},
          {"metadata", std::move(metadata)},
          {"lost", file.lost}};
}

std::string text_of(const ordered_json& json, const std::string& file, std::size_t bytes) {
  telemetry::Table table{.columns = telemetry::named_columns({"topic", "messages", "schema"})};
  for (const ordered_json& one : json["channels"])
    table.add({one["topic"].get<std::string>(), std::to_string(one["messages"].get<std::size_t>()),
               one["schema"].get<std::string>()});
  std::string text =
      fmt::format("{}: {:.1f} s, {} messages in {} chunks, {:.1f} MB, by {}\n{}", file,
                  json["duration_s"].get<double>(), json["messages"].get<std::size_t>(),
                  json["chunks"].get<std::size_t>(), 1e-6 * static_cast<double>(bytes),
                  json["library"].get<std::string>(), to_text(table));
  for (const ordered_json& one : json["attachments"])
    text += fmt::format("\nattached: {}, {} bytes", one["name"].get<std::string>(),
                        one["bytes"].get<std::size_t>());
  if (const auto missing = json["missing_ms"].get<std::uint64_t>(); missing > 0)
    text += fmt::format("\n{} ms were not recorded", missing);
  for (const ordered_json& one : json["lost"]) text += "\nlost: " + one.get<std::string>();
  return text;
}

/// What a record holds, and what is lost of it.
class RecordShow final : public Verb {
 public:
  [[nodiscard]] const char* name() const override { return "record show"; }
  [[nodiscard]] const char* summary() const override {
    return "what an MCAP file holds: channels, counts, duration, attachments, what is lost";
  }
  [[nodiscard]] const char* example() const override {
    return "tuina record show my-report/session.mcap";
  }
  void describe(Options& options) override {
    options.add("file", file_, "an MCAP file, also one that is cut off or damaged").required();
  }
  [[nodiscard]] Result<Answer> run(const CommonOptions&) override {
    Seen seen;
    const auto record = record::read_record_file(
        file_, [&](const telemetry::mcap::Contents& file, const telemetry::mcap::Message& message) {
          seen.take(file, message);
        });
    if (!record) return tl::unexpected(record.error());
    ordered_json json = {{"file", file_}, {"bytes", record->bytes.size()}};
    json.update(json_of(record->contents, seen));
    return Answer{.json = json.dump(2, ' ', false, ordered_json::error_handler_t::replace),
                  .text = text_of(json, file_, record->bytes.size())};
  }

 private:
  std::string file_;
};

/// The channels of a record as tables.
class ExportCsv final : public Verb {
 public:
  [[nodiscard]] const char* name() const override { return "export csv"; }
  [[nodiscard]] const char* summary() const override {
    return "the channels of session.mcap as CSV files: joints, tools, events";
  }
  [[nodiscard]] const char* example() const override {
    return "tuina export csv my-report/session.mcap --out tables";
  }
  void describe(Options& options) override {
    options.add("file", file_, "the session.mcap of `tuina massage --out`").required();
    options.add("--out", out_, "folder for the files; it is made").required();
  }
  [[nodiscard]] Result<Answer> run(const CommonOptions&) override {
    std::error_code fault;
    const bool fresh = std::filesystem::create_directory(out_, fault);
    if (!std::filesystem::is_directory(out_))
      return fail(Fault::file, "--out {}: the folder cannot be made: {}", out_, fault.message());
    const auto tables = record::write_tables(file_, out_);
    if (!tables) {
      if (fresh) std::filesystem::remove(out_, fault);
      return tl::unexpected(tables.error());
    }
    ordered_json files = ordered_json::array();
    std::string text;
    for (const auto& [name, rows] : tables->made) {
      files.push_back({{"file", name}, {"rows", rows}});
      text += fmt::format("{}: {} rows\n", (std::filesystem::path(out_) / name).string(), rows);
    }
    text += fmt::format("no tables: {}", fmt::join(tables->left_out, ", "));
    for (const std::string& one : tables->lost) text += "\nlost: " + one;
    const ordered_json json = {
        {"files", files}, {"left_out", tables->left_out}, {"lost", tables->lost}};
    return Answer{.json = json.dump(2, ' ', false, ordered_json::error_handler_t::replace),
                  .text = text};
  }

 private:
  std::string file_, out_;
};

}  // namespace

std::unique_ptr<Verb> make_record_show() {
  return std::make_unique<RecordShow>();
}

std::unique_ptr<Verb> make_export_csv() {
  return std::make_unique<ExportCsv>();
}

}  // namespace tuina::app
