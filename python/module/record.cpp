// SPDX-License-Identifier: Apache-2.0
#include "python/module/ros_values.hpp"
#include "tuina/record/session_folder.hpp"

namespace tuina::python {
namespace {

namespace mcap = telemetry::mcap;

/// The file of a session's record; a channel is read when it is asked for.
struct Record {
  std::string path;
  record::RecordFile file;
};

/// The messages of one channel.
struct Messages {
  std::string schema, encoding;
  std::vector<double> time_s;
  std::vector<std::string> data;
};

Messages read_channel(const Record& record, const std::string& topic) {
  std::optional<std::uint16_t> wanted;
  Messages found;
  for (const auto& [id, channel] : record.file.contents.channels) {
    if (channel.topic != topic) continue;
    wanted = id;
    found.encoding = channel.message_encoding;
    const auto schema = record.file.contents.schemas.find(channel.schema_id);
    if (schema != record.file.contents.schemas.end()) found.schema = schema->second.name;
  }
  if (!wanted) {
    std::string topics;
    for (const auto& [id, channel] : record.file.contents.channels)
      topics += (topics.empty() ? "" : ", ") + channel.topic;
    throw Refused{{Fault::not_found,
                   fmt::format("{}: has no channel {}; it has {}", record.path, topic, topics)}};
  }
  without_gil([&] {
    (void)value_of(
        mcap::read(record.file.bytes, [&](const mcap::Contents&, const mcap::Message& message) {
          if (message.channel_id != *wanted) return;
          found.time_s.push_back(1e-9 * static_cast<double>(message.log_time_ns));
          found.data.emplace_back(message.data);
        }));
  });
  return found;
}

py::object channel(const Record& record, const std::string& topic) {
  const Messages messages = read_channel(record, topic);
  py::object values;
  if (messages.encoding == "json") {
    const py::object loads = py::module_::import("json").attr("loads");
    py::list all;
    for (std::size_t i = 0; i < messages.data.size(); ++i) {
      py::object event = loads(messages.data[i]);
      if (py::isinstance<py::dict>(event) && !event.contains("time_s"))
        event["time_s"] = messages.time_s[i];
      all.append(event);
    }
    return all;
  }
  const auto bad = columns_of(messages.schema, messages.time_s, messages.data, values);
  if (!bad) return values;
  throw Refused{
      {Fault::bad_input, fmt::format("{}: {}: the message at {:.3f} s is not what the channel says",
                                     record.path, topic, messages.time_s[*bad])}};
}

py::bytes attachment(const Record& record, const std::string& name) {
  for (const std::string& kept : {name, name + ".zst"}) {
    if (const auto* found = record.file.contents.attachment(kept))
      return py::bytes(value_of(record::content_of(*found, record.path)));
  }
  throw Refused{{Fault::not_found, fmt::format("{}: has no attachment {}", record.path, name)}};
}

}  // namespace

void add_record(py::module_& module) {
  py::class_<Record>(module, "Record", "The record of a session, an MCAP file (docs/record.md).")
      .def_property_readonly(
          "topics",
          [](const Record& self) {
            py::dict counts;
            const auto& contents = self.file.contents;
            for (const auto& [id, channel] : contents.channels) {
              const auto count = contents.channel_messages.find(id);
              counts[py::str(channel.topic)] =
                  count == contents.channel_messages.end() ? 0 : count->second;
            }
            return counts;
          },
          "Number of messages by topic.")
      .def_property_readonly(
          "attachments",
          [](const Record& self) {
            std::vector<std::string> names;
            for (const auto& one : self.file.contents.attachments) names.push_back(one.name);
            return names;
          },
          "Names of the attached files.")
      .def_property_readonly(
          "lost", [](const Record& self) { return self.file.contents.lost; },
          "A sentence for each thing that is damaged or missing; empty where the file is whole.")
      .def("attachment", &attachment, py::arg("name"),
           "The content of an attached file, unpacked where .zst stands behind its name.")
      .def("__getitem__", &channel, py::arg("topic"),
           "The messages of a channel. Joints, tools, poses and forces: a dict of arrays with one "
           "row for each message. Events and what viewers draw: a list of dicts. Clouds: a list of "
           "dicts with N x 3 `points`, m. `time_s` is the time of the session.");
  module.def(
      "read_record",
      [](const std::string& path) {
        return without_gil([&] { return Record{path, value_of(record::read_record_file(path))}; });
      },
      py::arg("path"),
      "Opens a session.mcap, also one that is cut off or damaged: what is lost stands in `lost`. "
      "Fails where there is no such file or it does not begin as an MCAP file.");
}

}  // namespace tuina::python
