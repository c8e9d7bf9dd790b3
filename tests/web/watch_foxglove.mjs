// SPDX-License-Identifier: Apache-2.0
// A client of the Foxglove protocol by others, which subscribes to every channel. Its arguments are address and
// subprotocol; lines of its input are `call SERVICE` and, at the end, `compare FILE` with the record of the session.
// Each is answered by a line of JSON. Exit code 77: the client is not installed.
import { createRequire } from "node:module";
import fs from "node:fs";
import readline from "node:readline";

const require = createRequire(process.env.TUINA_READERS + "/");
let foxglove, WebSocket, mcap, fzstd, rosmsg, serialization;
try {
  foxglove = require("@foxglove/ws-protocol");
  WebSocket = require("ws");
  mcap = require("@mcap/core");
  fzstd = require("fzstd");
  rosmsg = require("@foxglove/rosmsg");
  serialization = require("@foxglove/rosmsg2-serialization");
} catch (error) {
  console.log(JSON.stringify({ missing: error.message.split("\n")[0] }));
  process.exit(77);
}

const kept = 4000;  // messages of a topic
const [address, subprotocol] = process.argv.slice(2);
const socket = new WebSocket(address, subprotocol.split(","));
const client = new foxglove.FoxgloveClient({ ws: socket });
const topics = {}, bySubscription = new Map(), services = new Map(), calls = new Map();
let info, faults = [], times = 0;

function decoderOf(channel) {
  if (channel.encoding === "json") return (data) => JSON.parse(new TextDecoder().decode(data));
  const reader = new serialization.MessageReader(rosmsg.parse(channel.schema, { ros2: true }));
  return (data) => reader.readMessage(data);
}

client.on("serverInfo", (message) => (info = message));
client.on("error", (error) => faults.push(String(error)));
client.on("status", (message) => faults.push(message.message));
client.on("time", () => ++times);
client.on("advertise", (channels) => {
  for (const channel of channels) {
    const topic = (topics[channel.topic] = { encoding: channel.encoding, received: 0, kept: [], decode: decoderOf(channel) });
    bySubscription.set(client.subscribe(channel.id), topic);
  }
});
client.on("advertiseServices", (all) => all.forEach((one) => services.set(one.name, one.id)));
client.on("message", ({ subscriptionId, timestamp, data }) => {
  const topic = bySubscription.get(subscriptionId);
  topic.received++;
  topic.kept.push({ time: timestamp, bytes: Buffer.from(data.buffer.slice(data.byteOffset, data.byteOffset + data.byteLength)) });
  if (topic.kept.length > kept) topic.kept.shift();
});
const answered = (message, outcome) => calls.get(message.callId)?.(outcome);
client.on("serviceCallResponse", (message) => answered(message, JSON.parse(new TextDecoder().decode(message.data)).outcome));
client.on("serviceCallFailure", (message) => answered(message, message.message));

let lastCall = 0;
function call(name) {
  return new Promise((resolve) => {
    calls.set(++lastCall, resolve);
    client.sendServiceCallRequest({ serviceId: services.get(name), callId: lastCall, encoding: "json", data: new TextEncoder().encode("{}") });
  });
}

// Poses are shown at other milliseconds when some were left out; /tools has them all.
function samePose(pose, tools, at) {
  const recorded = tools?.transforms[at], { position: p, orientation: q } = pose.pose;
  if (!recorded) return false;
  const { translation: t, rotation: r } = recorded;
  return [p.x - t.x, p.y - t.y, p.z - t.z, q.x - r.x, q.y - r.y, q.z - r.z, q.w - r.w].every((off) => off === 0);
}

async function compare(file) {
  const bytes = fs.readFileSync(file);
  const readable = { size: async () => BigInt(bytes.length), read: async (at, size) => new Uint8Array(bytes.subarray(Number(at), Number(at + size))) };
  const decompressHandlers = { zstd: (frame, size) => fzstd.decompress(frame, new Uint8Array(Number(size))) };
  const reader = await mcap.McapIndexedReader.Initialize({ readable, decompressHandlers });
  const recorded = new Map(), channels = new Set();
  for await (const message of reader.readMessages()) {
    const { topic } = reader.channelsById.get(message.channelId), key = `${topic}@${message.logTime}`;
    channels.add(topic);
    recorded.set(key, [...(recorded.get(key) ?? []), Buffer.from(message.data)]);
  }
  const out = { info, times, faults, subprotocol: socket.protocol, missing: [...channels].filter((one) => !topics[one]), topics: {} };
  for (const [name, topic] of Object.entries(topics)) {
    const said = (out.topics[name] = { received: topic.received, decoded: 0, same: 0, elsewhen: 0, different: 0 });
    const side = ["/left/pose", "/right/pose"].indexOf(name);
    for (const one of topic.kept) {
      const decoded = topic.decode(one.bytes);
      said.decoded += decoded !== undefined ? 1 : 0;
      const there = recorded.get(`${name}@${one.time}`);
      if (there) said[there.some((other) => other.equals(one.bytes)) ? "same" : "different"]++;
      else if (side >= 0) said[samePose(decoded, topics["/tools"].decode(recorded.get(`/tools@${one.time}`)[0]), side) ? "same" : "different"]++;
      else said.elsewhen++;
    }
  }
  return out;
}

for await (const line of readline.createInterface({ input: process.stdin })) {
  const [word, what] = line.split(" ");
  const answer = word === "call" ? { outcome: await call(what) } : word === "compare" ? await compare(what)
    : { topics: Object.fromEntries(Object.entries(topics).map(([name, topic]) => [name, topic.received])), services: [...services.keys()] };
  console.log(JSON.stringify(answer));
}
process.exit(0);
