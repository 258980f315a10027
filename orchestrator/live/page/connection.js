// A connection to a live view by the Foxglove WebSocket protocol, as far as the page needs it: channels of JSON (binary
// opcode 1) and services of JSON (opcode 2 out, 3 in). A lost connection is made again, for as long as the page is
// open.

const PROTOCOLS = ["foxglove.sdk.v1", "foxglove.websocket.v1"];
const MESSAGE = 1, CALL = 2, RESPONSE = 3;
const FIRST_RETRY_MS = 500, LAST_RETRY_MS = 5000;
const ENCODING = "json";

const decoder = new TextDecoder();
const encoder = new TextEncoder();

/** JSON of the bytes of a message. */
export const parse = (bytes) => JSON.parse(decoder.decode(bytes));

export class Connection {
  #url;
  #topics;   // topic -> function of the bytes of each message
  #changed;  // told "open", with the session and whether this page may steer, or "lost"
  #socket = null;
  #subscriptions = new Map();  // subscription id -> topic
  #services = new Map();       // name -> id
  #calls = new Map();          // call id -> function that settles the call
  #lastCall = 0;
  #retry_ms = FIRST_RETRY_MS;

  constructor(url, topics, changed) {
    this.#url = url;
    this.#topics = topics;
    this.#changed = changed;
    this.#open();
  }

  /** Calls a service. Resolves to its response; rejects with an Error that says why there is none. */
  call(service, request) {
    const id = this.#services.get(service);
    if (this.#socket?.readyState !== WebSocket.OPEN) return Promise.reject(new Error("not connected"));
    if (id === undefined) return Promise.reject(new Error("this view only watches"));
    const call = ++this.#lastCall;
    this.#socket.send(callFrame(id, call, encoder.encode(JSON.stringify(request))));
    return new Promise((resolve, reject) => this.#calls.set(call, {resolve, reject}));
  }

  #open() {
    const socket = new WebSocket(this.#url, PROTOCOLS);
    socket.binaryType = "arraybuffer";
    socket.onmessage = ({data}) => (typeof data === "string" ? this.#onText(JSON.parse(data)) : this.#onBinary(data));
    socket.onclose = () => this.#onClose();
    this.#socket = socket;
  }

  #onClose() {
    this.#subscriptions.clear();
    this.#services.clear();
    for (const {reject} of this.#calls.values()) reject(new Error("the connection was lost before the answer came"));
    this.#calls.clear();
    this.#changed("lost");
    setTimeout(() => this.#open(), this.#retry_ms);
    this.#retry_ms = Math.min(2 * this.#retry_ms, LAST_RETRY_MS);
  }

  #onText(message) {
    if (message.op === "serverInfo") {
      this.#retry_ms = FIRST_RETRY_MS;
      this.#changed("open", message.sessionId, message.capabilities.includes("services"));
    } else if (message.op === "advertise") {
      this.#subscribe(message.channels.filter(({topic, encoding}) => encoding === ENCODING && topic in this.#topics));
    } else if (message.op === "advertiseServices") {
      for (const {name, id} of message.services) this.#services.set(name, id);
    } else if (message.op === "serviceCallFailure") {
      this.#settle(message.callId, "reject", new Error(message.message));
    }
  }

  #subscribe(channels) {
    for (const {id, topic} of channels) this.#subscriptions.set(id, topic);
    if (channels.length === 0) return;
    const subscriptions = channels.map(({id}) => ({id, channelId: id}));
    this.#socket.send(JSON.stringify({op: "subscribe", subscriptions}));
  }

  #onBinary(data) {
    const view = new DataView(data);
    const opcode = view.getUint8(0);
    if (opcode === MESSAGE) {
      this.#topics[this.#subscriptions.get(view.getUint32(1, true))]?.(new Uint8Array(data, 13));
    } else if (opcode === RESPONSE) {
      this.#settle(view.getUint32(5, true), "resolve", parse(new Uint8Array(data, 13 + view.getUint32(9, true))));
    }
  }

  #settle(call, how, what) {
    this.#calls.get(call)?.[how](what);
    this.#calls.delete(call);
  }
}

// Opcode, service, call, length of the encoding's name, that name, payload; numbers little-endian.
function callFrame(service, call, payload) {
  const name = encoder.encode(ENCODING);
  const frame = new Uint8Array(13 + name.length + payload.length);
  const view = new DataView(frame.buffer);
  view.setUint8(0, CALL);
  view.setUint32(1, service, true);
  view.setUint32(5, call, true);
  view.setUint32(9, name.length, true);
  frame.set(name, 13);
  frame.set(payload, 13 + name.length);
  return frame;
}
