// The server's side of RFC 6455, as far as a page needs it: whole messages, no extensions, no fragments.
import {createHash} from "node:crypto";

const TEXT = 1, BINARY = 2, CLOSE = 8, PING = 9, PONG = 10;
const keyAnswer = (key) => createHash("sha1").update(`${key}258EAFA5-E914-47DA-95CA-C5AB0DC85B11`).digest("base64");

/**
 * Answers an upgrade with one of `protocols`. Returns {send, drop}; `onMessage` gets texts as strings, bytes as
 * Buffers.
 */
export function accept(request, socket, protocols, onMessage, onClose) {
  const protocol =
      (request.headers["sec-websocket-protocol"] ?? "").split(/,\s*/).find((name) => protocols.includes(name));
  if (!protocol) return socket.end("HTTP/1.1 400 Bad Request\r\nConnection: close\r\n\r\n");
  socket.write(
      "HTTP/1.1 101 Switching Protocols\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n" +
      `Sec-WebSocket-Accept: ${keyAnswer(request.headers["sec-websocket-key"])}\r\nSec-WebSocket-Protocol: ${
          protocol}\r\n\r\n`);
  socket.setNoDelay(true);
  let rest = Buffer.alloc(0);
  socket.on("data", (data) => {
    rest = Buffer.concat([rest, data]);
    for (let frame = read(rest); frame; frame = read(rest)) {
      rest = rest.subarray(frame.length);
      if (frame.opcode === TEXT)
        onMessage(frame.payload.toString());
      else if (frame.opcode === BINARY)
        onMessage(frame.payload);
      else if (frame.opcode === PING)
        socket.write(framed(PONG, frame.payload));
      else if (frame.opcode === CLOSE)
        socket.end(framed(CLOSE, frame.payload));
    }
  });
  socket.on("error", () => socket.destroy());
  socket.on("close", onClose);
  return {
    send: (message) =>
        socket.writable && socket.write(framed(typeof message === "string" ? TEXT : BINARY, Buffer.from(message))),
    drop: () => socket.destroy(),
  };
}

function framed(opcode, payload) {
  const size = payload.length;
  const head = size < 126 ? Buffer.from([0x80 | opcode, size]) : Buffer.alloc(size < 65536 ? 4 : 10);
  if (size >= 126) {
    head[0] = 0x80 | opcode;
    head[1] = size < 65536 ? 126 : 127;
    if (size < 65536)
      head.writeUInt16BE(size, 2);
    else
      head.writeBigUInt64BE(BigInt(size), 2);
  }
  return Buffer.concat([head, payload]);
}

// The first frame of some bytes; null: it is not whole.
function read(bytes) {
  if (bytes.length < 2) return null;
  const short = bytes[1] & 0x7f, at = short < 126 ? 2 : short === 126 ? 4 : 10;
  if (bytes.length < at + 4) return null;
  const size = short < 126 ? short : short === 126 ? bytes.readUInt16BE(2) : Number(bytes.readBigUInt64BE(2));
  const length = at + 4 + size;
  if (bytes.length < length) return null;
  const mask = bytes.subarray(at, at + 4);
  return {
    opcode: bytes[0] & 15,
    payload: Buffer.from(bytes.subarray(at + 4, length)).map((byte, k) => byte ^ mask[k % 4]),
    length
  };
}
