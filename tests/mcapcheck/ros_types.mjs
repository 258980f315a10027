#!/usr/bin/env node
// ros_types.mjs FILE.mcap: holds the channels of record.ros_types against the states of the same recording, all decoded
// by the readers that Foxglove uses, with the schemas in the file. Prints JSON: how many messages of each topic were
// looked at, what is wrong with them, and for each message on /scene its time, its markers by name, and the lines of each
// colour as pairs of agents. Exit: 0 nothing is wrong, 1 something is.
import { open } from "node:fs/promises";
import { McapIndexedReader } from "@mcap/core";
import * as nodejsPkg from "@mcap/nodejs";
import * as rosmsgPkg from "@foxglove/rosmsg";
import * as ros2serPkg from "@foxglove/rosmsg2-serialization";
import zstdPkg from "@foxglove/wasm-zstd";

const pick = (module, name) => module[name] ?? module.default?.[name]; // CommonJS packages under ESM
const FileHandleReadable = pick(nodejsPkg, "FileHandleReadable");
const parse = pick(rosmsgPkg, "parse");
const MessageReader = pick(ros2serPkg, "MessageReader");

await zstdPkg.isLoaded;
const file = await open(process.argv[2], "r");
const reader = await McapIndexedReader.Initialize({
  readable: new FileHandleReadable(file),
  decompressHandlers: { zstd: (data, size) => zstdPkg.decompress(data, Number(size)) },
});

const problems = [];
const wrong = (where, what) => { if (problems.length < 20) problems.push(`${where}: ${what}`); };
const counts = {}, schemas = {}, qos = {}, scenes = [];
const decoders = new Map();
for (const channel of reader.channelsById.values()) {
  const schema = reader.schemasById.get(channel.schemaId);
  decoders.set(channel.id, new MessageReader(parse(new TextDecoder().decode(schema.data), { ros2: true })));
  schemas[channel.topic] = [schema.name, schema.encoding, channel.messageEncoding];
  qos[channel.topic] = channel.metadata.get("offered_qos_profiles");
}

const same = (a, b) => Object.keys(b).every((key) => a[key] === b[key]);
const near = (a, b) => Object.keys(b).every((key) => Math.abs(a[key] - b[key]) <= 1e-12 * (1 + Math.abs(b[key])));
const stampNs = (header) => BigInt(header.stamp.sec) * 1000000000n + BigInt(header.stamp.nanosec ?? header.stamp.nsec);

/** The vector v in W, as seen in the frame that q turns into W: by the matrix of q, written out. */
function inBody(q, v) {
  const { x, y, z, w } = q;
  const rows = [
    [1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y)],
    [2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x)],
    [2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)],
  ].map(([a, b, c]) => a * v.x + b * v.y + c * v.z);
  return { x: rows[0], y: rows[1], z: rows[2] };
}

/** All messages of one time, by topic. */
function look(time, row) {
  const states = new Map();
  for (const [topic, message] of row)
    if (topic.endsWith("/state")) states.set(topic.split("/")[1], message);
  for (const [topic, message] of row) {
    const where = `${topic} at ${Number(time) / 1e9} s`;
    if (topic.endsWith("/odom")) {
      const name = topic.split("/")[1], state = states.get(name);
      if (stampNs(message.header) !== time) wrong(where, "its stamp is not its time");
      if (message.header.frame_id !== "world" || message.child_frame_id !== name) wrong(where, "its frames");
      if (!same(message.pose.pose.position, state.pose.position)) wrong(where, "position");
      if (!same(message.pose.pose.orientation, state.pose.orientation)) wrong(where, "orientation");
      if (!same(message.twist.twist.angular, state.twist.angular)) wrong(where, "angular velocity");
      if (!near(message.twist.twist.linear, inBody(state.pose.orientation, state.twist.linear)))
        wrong(where, "velocity in the body's frame");
      for (const part of [message.pose, message.twist])
        if (part.covariance.length !== 36 || part.covariance.some((c) => c !== 0)) wrong(where, "covariance");
    } else if (topic === "/tf") {
      if (message.transforms.length !== states.size) wrong(where, "the number of transforms");
      for (const { header, child_frame_id: name, transform } of message.transforms) {
        const { position, orientation } = states.get(name).pose;
        if (stampNs(header) !== time || header.frame_id !== "world") wrong(where, "header");
        if (!same(transform.translation, position) || !same(transform.rotation, orientation)) wrong(where, name);
      }
    } else if (topic === "/scene") {
      lookAtScene(where, time, message, states);
    }
  }
}

function lookAtScene(where, time, message, states) {
  const at = (point) => [...states].find(([, state]) => same(point, state.pose.position))?.[0];
  const markers = {}, edges = {};
  for (const marker of message.markers) {
    markers[marker.ns] = (markers[marker.ns] ?? 0) + 1;
    if (stampNs(marker.header) !== time) wrong(where, `the stamp of ${marker.ns} ${marker.id}`);
    if (marker.ns !== "edges") continue;
    const pairs = [];
    for (let k = 0; k < marker.points.length; k += 2)
      pairs.push(`${at(marker.points[k])}-${at(marker.points[k + 1])}`.replaceAll("agent_", ""));
    edges[["heard", "lost", "out of range", "nothing yet"][marker.id - 1]] = pairs;
  }
  const trail = message.markers.find((marker) => marker.ns === "trails");
  if (trail && trail.points.length > 0 && time === 0n && at(trail.points[0]) !== "agent_1") wrong(where, "trail");
  scenes.push({ t: Number(time) / 1e9, markers, edges, trail: trail?.points.length ?? null });
}

let now = null, row = [];
for await (const message of reader.readMessages()) {
  const topic = reader.channelsById.get(message.channelId).topic;
  counts[topic] = (counts[topic] ?? 0) + 1;
  if (message.publishTime !== message.logTime) wrong(topic, "its times differ");
  if (now !== null && message.logTime !== now) {
    look(now, row);
    row = [];
  }
  now = message.logTime;
  row.push([topic, decoders.get(message.channelId).readMessage(message.data)]);
}
if (now !== null) look(now, row);
await file.close();
console.log(JSON.stringify({ counts, schemas, qos, scenes, problems }));
process.exit(problems.length > 0 ? 1 : 0);
