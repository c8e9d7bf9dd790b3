// SPDX-License-Identifier: Apache-2.0
// Has urdf-loader, a reader by others, stand the robot that is attached to a record, and turns its joints as the record
// says. Prints as JSON what it is made of and how far each tool is from where the record has it. Exit code 77: the
// reader is not installed.
import fs from "node:fs";

let dom, mcap, fzstd, rosmsg, serialization, three, URDFLoader;
try {
  dom = await import("linkedom");
  mcap = await import("@mcap/core");
  fzstd = await import("fzstd");
  rosmsg = await import("@foxglove/rosmsg");
  serialization = await import("@foxglove/rosmsg2-serialization");
  three = await import("three");
  URDFLoader = (await import("urdf-loader")).default;
} catch (error) {
  console.log(error.message.split("\n")[0]);
  process.exit(77);
}
// The loader was written for browsers. It is given text, so what it compares with may be anything.
Object.assign(globalThis, { DOMParser: dom.DOMParser, Document: class {}, Element: class {} });

const stream = new mcap.McapStreamReader({
  decompressHandlers: { zstd: (frame, size) => fzstd.decompress(frame, new Uint8Array(Number(size))) },
});
stream.append(fs.readFileSync(process.argv[2]));
const channels = new Map(), schemas = new Map(), poses = {}, joints = new Map();
let urdf;
for (let record; (record = stream.nextRecord()); ) {
  if (record.type === "Schema") schemas.set(record.id, record);
  if (record.type === "Channel") channels.set(record.id, record);
  if (record.type === "Attachment" && record.name === "robot.urdf") urdf = new TextDecoder().decode(record.data);
  if (record.type !== "Message") continue;
  const { topic, schemaId } = channels.get(record.channelId);
  if (!["/joint_states", "/left/pose", "/right/pose"].includes(topic)) continue;
  const definitions = () => rosmsg.parse(new TextDecoder().decode(schemas.get(schemaId).data), { ros2: true });
  const reader = (schemas.get(schemaId).reader ??= new serialization.MessageReader(definitions()));
  const message = reader.readMessage(record.data);
  if (topic === "/joint_states") joints.set(record.logTime, message);
  else (poses[topic.split("/")[1]] ??= []).push([record.logTime, message.pose.position]);
}

const robot = new URDFLoader().parse(urdf);
const out = { links: Object.keys(robot.links).length, joints: {}, shapes: 0, compared: 0, off_m: 0 };
for (const [name, joint] of Object.entries(robot.joints))
  if (joint.jointType !== "fixed") out.joints[name] = { type: joint.jointType, ...joint.limit };
robot.traverse((one) => (out.shapes += one.isMesh ? 1 : 0));
for (const [arm, told] of Object.entries(poses)) {
  for (const [time, at] of told) {
    const { name, position } = joints.get(time);
    name.forEach((one, i) => robot.joints[one].setJointValue(position[i]));
    robot.updateMatrixWorld(true);
    const tool = robot.links[`${arm}_tool`].getWorldPosition(new three.Vector3());
    out.off_m = Math.max(out.off_m, tool.distanceTo(new three.Vector3(at.x, at.y, at.z)));
    out.compared++;
  }
}
console.log(JSON.stringify(out));
