#!/usr/bin/env node
// The page and a made-up run on one port: what orchestrator/live/ does, for tests of the page.
//   node fake_server.mjs [--port 8765] [--agents 10] [--recording]
import {createServer} from "node:http";
import {readFile} from "node:fs/promises";
import {extname, join, normalize} from "node:path";
import {fileURLToPath} from "node:url";
import {MadeUpRun} from "./made_up_run.mjs";
import {accept} from "./web_socket.mjs";

const PAGE = fileURLToPath(new URL("../../orchestrator/live/page", import.meta.url));
const VENDOR = "/usr/share/javascript";
const TYPES = {
  ".html": "text/html; charset=utf-8",
  ".js": "text/javascript; charset=utf-8",
  ".css": "text/css; charset=utf-8",
  ".svg": "image/svg+xml"
};
const CHANNELS = ["/ui/experiment", "/ui/frame", "/ui/events", "/ui/curves", "/ui/vehicles"];
const SERVICE = 7;

async function serve({url}, response) {
  const path = normalize(new URL(url, "http://x").pathname);
  const file =
      path.startsWith("/vendor/") ? join(VENDOR, path.slice(8)) : join(PAGE, path === "/" ? "index.html" : path);
  try {
    const body = await readFile(file);
    response.writeHead(
        200, {"Content-Type": TYPES[extname(file)] ?? "application/octet-stream", "Content-Security-Policy": POLICY});
    response.end(body);
  } catch {
    response.writeHead(404).end();
  }
}

// As strict as the real one.
const POLICY = "default-src 'none'; script-src 'self'; style-src 'self' 'unsafe-inline'; img-src 'self' data: blob:; " +
    "font-src 'self'; connect-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'";

/**
 * Starts a server on a free port, with a row each `frame_ms`. `asked` has all that clients asked for. `steer`: the
 * token without which clients only watch; null: all steer.
 */
export async function startFake({port = 0, session = "1", frame_ms = 100, steer = null, ...options} = {}) {
  const run = new MadeUpRun(options), clients = new Set(), asked = [];
  const server = createServer(serve);
  server.on("upgrade", (request, socket) => {
    const client = {subscriptions: new Map()};
    const onMessage = (message) =>
        (typeof message === "string" ? onText(client, JSON.parse(message)) : onCall(client, message));
    client.socket =
        accept(request, socket, ["foxglove.sdk.v1", "foxglove.websocket.v1"], onMessage, () => clients.delete(client));
    if (!client.socket) return;
    clients.add(client);
    const text = (message) => client.socket.send(JSON.stringify(message));
    const maySteer = steer === null || request.url === `/?steer=${steer}`;
    text({
      op: "serverInfo",
      name: "made up",
      capabilities: maySteer ? ["services"] : [],
      supportedEncodings: ["json"],
      sessionId: session
    });
    text({
      op: "advertise",
      channels: CHANNELS.map(
          (topic, k) =>
              ({id: k + 1, topic, encoding: "json", schemaName: topic, schema: "{}", schemaEncoding: "jsonschema"}))
    });
    if (maySteer)
      text({
        op: "advertiseServices",
        services: [{id: SERVICE, name: "/mascot/ask", type: "ask", requestSchema: "", responseSchema: ""}]
      });
  });

  const send = (client, topic, json) => {
    const subscription = client.subscriptions.get(CHANNELS.indexOf(topic) + 1);
    if (subscription === undefined) return;
    const payload = Buffer.from(JSON.stringify(json)), frame = Buffer.alloc(13 + payload.length);
    frame.writeUInt8(1, 0);
    frame.writeUInt32LE(subscription, 1);
    frame.writeBigUInt64LE(BigInt(Math.round(1e9 * run.t_s)), 5);
    payload.copy(frame, 13);
    client.socket.send(frame);
  };
  const sendAll = (topic, json) => {
    for (const client of clients) send(client, topic, json);
  };

  function onText(client, {op, subscriptions}) {
    if (op !== "subscribe") return;
    for (const {id, channelId} of subscriptions) client.subscriptions.set(channelId, id);
    send(client, "/ui/experiment", run.experiment());
    send(client, "/ui/events", run.events);
    send(client, "/ui/curves", {rows: run.curves});
    send(client, "/ui/vehicles", run.vehicles);
    send(client, "/ui/frame", run.frame());
  }

  function onCall(client, message) {
    const request = JSON.parse(message.subarray(13 + message.readUInt32LE(9)).toString());
    asked.push(request);
    const answer = run.ask(request), head = Buffer.from(message.subarray(0, 13 + message.readUInt32LE(9)));
    head.writeUInt8(3, 0);
    client.socket.send(Buffer.concat([head, Buffer.from(JSON.stringify(answer))]));
    if (run.take() || request.ask === "event" && answer.granted) {
      sendAll("/ui/experiment", run.experiment());
      sendAll("/ui/events", run.events);
    }
    sendAll("/ui/frame", run.frame());
  }

  const timer = setInterval(() => {
    if (run.state !== "running") return;
    run.advance(frame_ms / 1000);
    sendAll("/ui/frame", run.frame());
  }, frame_ms);
  await new Promise((ready) => server.listen(port, "127.0.0.1", ready));
  const drop = () => {
    for (const {socket} of clients) socket.drop();
  };
  return {
    run,
    asked,
    drop,
    tellVehicles(vehicles) {
      run.vehicles = vehicles;
      sendAll("/ui/vehicles", vehicles);
    },
    tellEvents: () => sendAll("/ui/events", run.events),
    port: server.address().port,
    url: `http://127.0.0.1:${server.address().port}/`,
    stop() {
      clearInterval(timer);
      drop();
      server.closeAllConnections();
      return new Promise((done) => server.close(done));
    },
  };
}

if (process.argv[1] === fileURLToPath(import.meta.url)) {
  const value = (name, otherwise) =>
      (process.argv.includes(name) ? Number(process.argv[process.argv.indexOf(name) + 1]) : otherwise);
  const {url} = await startFake({
    frame_ms: 33,
    lossy: true,
    range_m: 12,
    port: value("--port", 8765),
    agents: value("--agents", 10),
    source: process.argv.includes("--recording") ? "recording" : "run"
  });
  console.log(url);
}
