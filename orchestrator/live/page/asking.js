// Asks the server for something and shows what it answers. Nothing changes on the page because it was asked for: what
// changes comes back as a row, an experiment or an event.

const SERVICE = "/mascot/ask";
const PATIENCE_MS = 10_000;

/** The keys of one [[events]] table. */
export const gotoToml = (agent, p_W) => `goto = { agent = ${agent}, position_m = [${p_W.map(metres).join(", ")}] }`;
export const edgesToml = (verb, pairs) => `${verb} = [${pairs.map((pair) => `[${pair.join(", ")}]`).join(", ")}]`;
export const faultToml = (agent, of, kind) =>
    `fault = { agent = ${agent}${of === "agent" ? "" : `, of = "${of}"`}, kind = "${kind}" }`;
export const restartToml = (agent) => `restart = ${agent}`;
export function setToml(key, value, agents = []) {
  const only = agents.length ? `\nagents = [${agents.join(", ")}]` : "";
  return `set = { ${JSON.stringify(key)} = ${tomlValue(value)} }${only}`;
}

const metres = (x) => String(Math.round(x * 1000) / 1000 || 0);

/** A TOML value. Texts need no more escapes than JSON has. */
function tomlValue(value) {
  return Array.isArray(value) ? `[${value.map(tomlValue).join(", ")}]` : JSON.stringify(value);
}

export class Asking {
  #connection;
  #model;
  #notices;

  constructor(connection, model, notices) {
    this.#connection = connection;
    this.#model = model;
    this.#notices = notices;
  }

  /**
   * Resolves to the answer, {granted, words}; never rejects. A refusal is shown, and so is consent if `say` is given.
   */
  async ask(request, say = "") {
    const close = say ? this.#notices.wait(`${say} …`) : () => {};
    const answer = await this.#answer(request);
    close();
    this.#model.lastAnswer = {request, ...answer};
    if (!answer.granted)
      this.#notices.show(say ? `${say}: refused` : "Refused", answer.words, "refused");
    else if (say)
      this.#notices.show(say, answer.words, "granted");
    return answer;
  }

  /** Asks for an event: the keys of one [[events]] table. `edge`: as for Model.expect(). */
  async event(toml, say, edge = null) {
    const answer = await this.ask({ask: "event", toml}, say);
    if (answer.granted) this.#model.expect(toml, answer.words, edge);
    return answer;
  }

  async #answer(request) {
    try {
      return await Promise.race([this.#connection.call(SERVICE, request), timeOut()]);
    } catch (error) {
      return {granted: false, words: error.message};
    }
  }
}

const timeOut = () => new Promise(
    (_, reject) => setTimeout(() => reject(new Error(`no answer within ${PATIENCE_MS / 1000} s`)), PATIENCE_MS));
