// SPDX-License-Identifier: Apache-2.0
// Reads an MCAP file with the readers of others, twice: by its index and from front to back, all
// checksums compared. Prints what it has read as JSON. Exit code 77: the readers are not installed.
import { createRequire } from "node:module";
import fs from "node:fs";

const require = createRequire(process.env.TUINA_READERS ? process.env.TUINA_READERS + "/" : import.meta.url);
let mcap, fzstd, rosmsg, serialization, common;
try {
  mcap = require("@mcap/core");
  fzstd = require("fzstd");
  rosmsg = require("@foxglove/rosmsg");
  serialization = require("@foxglove/rosmsg2-serialization");
  common = require("@foxglove/rosmsg-msgs-common").ros2humble;
} catch (error) {
  console.log(error.message.split("\n")[0]);
  process.exit(77);
}

const bytes = fs.readFileSync(process.argv[2]);
const readable = {
  size: async () => BigInt(bytes.length),
  read: async (offset, length) => new Uint8Array(bytes.subarray(Number(offset), Number(offset + length))),
};
const decompressHandlers = { zstd: (frame, size) => fzstd.decompress(frame, new Uint8Array(Number(size))) };
const text = (data) => new TextDecoder().decode(data);

// Fields of a message, those of the messages in it beside them; constants and comments do not count.
const shape = (one) =>
  one.definitions.filter((field) => !field.isConstant).map((field) => `${field.type}${field.isArray ? "[]" : ""} ${field.name}`).join("\n");
const plain = (name) => name.replace("/msg/", "/");
function compareWithCommon(name, definitions) {
  for (const one of definitions) {
    const called = plain(one.name ?? name);
    const known = Object.values(common).find((other) => plain(other.name ?? "") === called);
    const wanted = known && shape(known).replaceAll("/msg/", "/");
    if (wanted !== shape(one).replaceAll("/msg/", "/")) throw new Error(`${called} is not as ROS 2 defines it:\n${shape(one)}\nwanted:\n${wanted}`);
  }
}

const out = { topics: {}, definitions: 0, attachments: [], streamed: 0 };
const decoders = new Map();
function decoded(channel, schema, data) {
  if (channel.messageEncoding === "json") return JSON.parse(text(data));
  if (!decoders.has(channel.id)) {
    const definitions = rosmsg.parse(text(schema.data), { ros2: true });
    compareWithCommon(schema.name, definitions);
    out.definitions += definitions.length;
    decoders.set(channel.id, new serialization.MessageReader(definitions));
  }
  return decoders.get(channel.id).readMessage(data);
}

const indexed = await mcap.McapIndexedReader.Initialize({ readable, decompressHandlers });
for await (const message of indexed.readMessages({ validateCrcs: true })) {
  const channel = indexed.channelsById.get(message.channelId);
  const schema = indexed.schemasById.get(channel.schemaId);
  const topic = (out.topics[channel.topic] ??= { schema: schema.name, messages: 0 });
  topic.messages++;
  topic.last = decoded(channel, schema, message.data);
}
for await (const one of indexed.readAttachments()) out.attachments.push({ name: one.name, bytes: one.data.length });
let second = 0;
for await (const message of indexed.readMessages({ startTime: 2_000_000_000n, endTime: 2_999_999_999n, topics: ["/joint_states"] })) second += message ? 1 : 0;
out.within_a_second = second;

const stream = new mcap.McapStreamReader({ decompressHandlers, validateCrcs: true });
stream.append(bytes);
for (let record; (record = stream.nextRecord()); ) out.streamed += record.type === "Message" ? 1 : 0;
if (!stream.done()) throw new Error("the file does not end as it should");

const lists = (_, value) => (typeof value === "bigint" ? Number(value) : ArrayBuffer.isView(value) ? Array.from(value).slice(0, 64) : value);
console.log(JSON.stringify(out, lists));
