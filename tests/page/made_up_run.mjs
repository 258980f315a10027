// A run that nobody flies: agents that follow what they hear, with numbers that look right. For the page's tests, where
// a real run would be slow, or would not do what is to be seen (refusals, a thousand agents, losses at will).

const RATE_HZ = 100, DURATION_S = 60;

/** Some rows of the table of faults. */
const FAULT_KINDS = [
  ["agent", "kill", "unanswered", "its process dies: the agent is lost (`run.on_agent_loss`)"],
  ["agent", "mute", "", "nobody hears it; it hears the others"], ["agent", "ok", "", "ends mute, deaf and lie"],
  ["sensor", "stuck", "", "it measures the same position and velocity for ever"],
  ["motor", "off", "motor", "it does not turn: its command is 0, whatever the agent commands"],
  ["link", "delayed", "delay_s", "what it sends arrives `delay_s` later"]
].map(([of, kind, parameters, meaning]) => ({of, kind, parameters, meaning}));

/** Numbers in [0, 1) that are the same each time. */
const dice = (k) => {
  const x = Math.sin(12.9898 * k + 4.1) * 43758.5453;
  return x - Math.floor(x);
};

export class MadeUpRun {
  tick = 0;
  state = "running";
  pace = 1;
  events = [];
  vehicles = [];
  waiting = [];
  past = [];  // rows of the curves of a run
  gains = {p_gain: 0.35, beta: 1.1};

  constructor({
    agents = 10,
    source = "run",
    name = "gather at the leader",
    leader = 4,
    lossy = false,
    range_m = 100,
    end_s = DURATION_S,
    loss = "",
    incidents = "",
    disagreement_m = null,  // as it is, unless given
    rate_per_s = 0.19,      // that theory predicts from the start
    slowest_per_s = 0.15,   // of the slowest mode
    why = "",               // it is silent of the rest
    responses = [],         // disagreement that theory predicts: {from_s, until_s, every_s, value_m}
    curve = null,           // of the law: {name, unit, meaning, decays, agrees, since_s, predicted}
    law_value = null,       // its value at a time
    places_m = 0,           // radius of a circle that the agents are to form; 0: none
    cells = [],             // {region_m, agents}: regions that agents divide
    hulls = [],             // {agents, axes}: agents whose hull is drawn, which lead
    liars = {},             // number of an agent -> time from which on it lies
    faults = {},            // number of an agent -> what is wrong with it, in words
    on_agent_loss = "hold",
    survives = [],  // {from_s, is_wrong, words}: what the team can still do
    happened = [[15, "goto = { agent = 4, position_m = [1.0, 6.0, 3.0] }", false], [32, "cut = [[3, 4]]", true]],
    // events of a recording: time, keys, whether they were given by hand
    left_out = null,    // of each edge at a time: bit k for axis k; null: no law leaves anything out
    own = {},           // key -> values that agents have of their own: {agent, value}
    drift_m_per_s = 0,  // at which all are shown to go east
    waits = false       // what is granted while the run is paused takes effect when it goes on
  } = {}) {
    Object.assign(this, {
      size: agents,
      source,
      name,
      lossy,
      range_m,
      end_s,
      loss,
      incidents,
      disagreement_m,
      rate_per_s,
      slowest_per_s,
      why,
      responses,
      curve,
      law_value,
      places_m,
      cells,
      hulls,
      liars,
      faults,
      on_agent_loss,
      survives,
      happened,
      left_out,
      own,
      drift_m_per_s,
      waits,
      leader: Math.min(leader, agents)
    });
    const spread = 2.2 * Math.sqrt(agents);
    this.p = Array.from(
        {length: agents},
        (_, k) => [spread * (2 * dice(3 * k) - 1), spread * (2 * dice(3 * k + 1) - 1), 1 + 4 * dice(3 * k + 2)]);
    this.v = this.p.map(() => [0, 0, 0]);
    this.a = this.p.map(() => [0, 0, 0]);
    this.home = this.p.map((p) => [...p]);
    this.edges = this.#tree();
    this.cut = new Set();     // indices of edges
    this.losing = new Set();  // of those that lose every sample
    if (source === "recording") this.#record();
  }

  // Each agent hears one before it and one after it; the first ones hear the leader.
  #tree() {
    const edges = [];
    for (let i = 1; i <= this.size; ++i) {
      if (i === this.leader) continue;
      edges.push([i, i <= this.leader + 2 && i >= this.leader - 3 ? this.leader : Math.max(1, Math.floor(i / 2)), 1]);
      if (i % 3 === 0 && i > 1) edges.push([i, i - 1, 0.5]);
      if (i % 4 === 1 && i > 1 && i - 1 !== this.leader) edges.push([i - 1, i, 0.5]);
    }
    return edges.filter(([i, j]) => i !== j);
  }

  experiment() {
    const live = (key, unit, value, max) => ({
      key,
      kind: "number",
      unit,
      min: 0,
      max,
      open_min: false,
      names: [],
      value,
      own: this.own[key] ?? [],
      meaning: `${key} of all agents`
    });
    return {
      name: this.name,
      source: this.source,
      engine: this.rows ? "" : "dds",
      recorded: this.rows ? {run: "runs/made up", end_s: this.end_s, loss: this.loss, incidents: this.incidents} : null,
      rate_hz: RATE_HZ,
      ticks: RATE_HZ * DURATION_S,
      duration_s: DURATION_S,
      axes: "xyz",
      leader: this.leader,
      agents: this.p.map((_, k) => this.#agent(k + 1)),
      edges: this.edges,
      range_m: this.range_m,
      cells: this.cells,
      hulls: this.hulls,
      leaves_out: this.left_out !== null,
      on_agent_loss: this.on_agent_loss,
      fault_kinds: this.source === "recording" ? [] : FAULT_KINDS,
      survives: this.survives,
      obstacles: this.size > 20 ? [] :
                                  [
                                    {kind: "box", position_m: [5, 4, 1], size_m: [2, 1, 2], heading_rad: 0.5},
                                    {kind: "cylinder", position_m: [-5, 3, 1.5], size_m: [1.4, 1.4, 3]},
                                    {kind: "sphere", position_m: [2, -5, 0.8], size_m: [1.6, 1.6, 1.6]}
                                  ],
      wind_m_per_s: [3, 1.5, 0],
      prediction: {
        from_s: 0,
        of_agreement: true,
        stable: true,
        value_m: this.home[this.leader - 1],
        rate_per_s: this.rate_per_s,
        slowest_rate_per_s: this.slowest_per_s,
        settling_time_s: 21,
        why: this.why
      },
      responses: this.responses,
      curve: this.curve,
      live_keys: [
        live("law.safety.distance_m", "", null, 1e6), live("law.p_gain", "1/s^2", this.gains.p_gain, 1000),
        live("law.beta", "1/s", this.gains.beta, 1000), live("law.reach_m", "m", [0.5, 1, 1.5], 1000),
        live("link.loss", "", 0.2, 1), {
          key: "physics.wind.mean_m_per_s",
          kind: "vector3",
          unit: "m/s",
          min: -200,
          max: 200,
          open_min: false,
          names: [],
          value: [3, 1.5, 0],
          own: [],
          meaning: "in W"
        },
        {
          key: "physics.collisions",
          kind: "boolean",
          unit: "",
          min: 0,
          max: 0,
          open_min: false,
          names: [],
          value: true,
          own: [],
          meaning: "bodies touch"
        }
      ],
    };
  }

  #agent(id) {
    const model = id % 5 === 2 ? "unicycle" :
        id % 7 === 5           ? "double_integrator" :
                                 "quadrotor",
          isQuadrotor = model === "quadrotor";
    return {
      id,
      model,
      rolls: model === "unicycle",
      actuator: isQuadrotor ? "speeds of rotors 1..4 (rad/s)" : "speeds (m/s)",
      size_m: isQuadrotor ? [0.5, 0.5, 0.1] : [0.4, 0.4, 0.4],
      arm_m: isQuadrotor ? 0.25 : 0,
      law: "consensus",
      leads: id === this.leader || this.hulls.some(({agents}) => agents.includes(id)),
      lies_from_s: this.liars[id] ?? null,
      lost: (this.faults[id] ?? []).some((words) => words.startsWith("lost")),
      faults: this.faults[id] ?? [],
      waypoints_m: id === this.leader ? [this.home[id - 1], [6, -2, 3]] : [],
      place_m: this.places_m ? [this.places_m * Math.cos(id), this.places_m * Math.sin(id), 0] : null,
      parent: 0,
      goto: id === this.leader
    };
  }

  // --- flying ---

  advance(wall_s) {
    if (this.state !== "running") return;
    const ticks = Math.max(1, Math.round(wall_s * (this.pace || 20) * RATE_HZ));
    for (let k = 0; k < ticks && this.state === "running"; ++k) this.step();
  }

  step() {
    ++this.tick;
    if (this.rows)
      this.#show(Math.min(this.rows.length - 1, Math.floor(this.tick / 10)));
    else
      this.#fly(1 / RATE_HZ);
    if (!this.rows && this.tick % 10 === 0) this.past.push(this.#curveRow(this.t_s, this.p, this.v));
    if (this.tick >= RATE_HZ * this.end_s) this.state = this.source === "recording" ? "paused" : "done";
  }

  #fly(dt_s) {
    const pull = this.p.map(() => [0, 0, 0]);
    this.edges.forEach(([i, j, weight], k) => {
      if (!this.cut.has(k))
        for (const c of [0, 1, 2])
          pull[i - 1][c] += weight * (this.p[j - 1][c] - this.p[i - 1][c] + this.#offset(i, c) - this.#offset(j, c));
    });
    for (const c of [0, 1, 2])
      pull[this.leader - 1][c] += this.home[this.leader - 1][c] +
          (c < 2 ? 1.5 * Math.sin(0.3 * this.t_s + c * 1.57) : 0) - this.p[this.leader - 1][c];
    this.p.forEach((p, k) => p.forEach((_, c) => {
      this.a[k][c] = Math.max(-3, Math.min(3, this.gains.p_gain * pull[k][c] - this.gains.beta * this.v[k][c]));
      this.v[k][c] += dt_s * this.a[k][c];
      p[c] += dt_s * this.v[k][c];
    }));
  }

  #offset(i, c) {
    return [
      1.2 * Math.sqrt(this.size) * Math.cos(2.4 * i) * Math.sqrt(i / this.size),
      1.2 * Math.sqrt(this.size) * Math.sin(2.4 * i) * Math.sqrt(i / this.size), 0.3 * (i % 5)
    ][c];
  }

  get t_s() { return this.tick / RATE_HZ; }

  #record() {
    const rows = [];
    for (let k = 0; k <= DURATION_S * 10; ++k) {
      rows.push(structuredClone({p: this.p, v: this.v, a: this.a}));
      for (let n = 0; n < 10; ++n) {
        ++this.tick;
        this.#fly(1 / RATE_HZ);
      }
    }
    this.rows = rows;
    this.tick = 0;
    this.state = "paused";
    this.#show(0);
    this.events = this.happened.map(([t_s, keys, by_hand], k) => ({
                                      number: k + 1,
                                      tick: t_s * RATE_HZ,
                                      t_s,
                                      toml: `[[events]]\nat_s = ${t_s.toFixed(1)}\n${keys}\n`,
                                      by_hand
                                    }));
  }

  #goTo(tick) {
    this.tick = Math.max(0, Math.min(RATE_HZ * this.end_s, tick));
    this.#show(Math.min(this.rows.length - 1, Math.floor(this.tick / 10)));
  }

  /** Rows of the curves: of a recording all, of a run up to now. */
  get curves() {
    if (!this.rows) return this.past;
    return this.rows.slice(0, Math.floor(10 * this.end_s) + 1).map(({p, v}, k) => this.#curveRow(k / 10, p, v));
  }

  #curveRow(t_s, p, v) {
    const speeds = v.map((each) => Math.hypot(...each)), mean = speeds.reduce((sum, x) => sum + x, 0) / speeds.length;
    const shown = speeds.length > 8 ? [Math.max(...speeds), mean, Math.min(...speeds)] : speeds;
    return [t_s, this.#disagreement(p), this.law_value?.(t_s) ?? null, ...shown];
  }

  #disagreement(p) {
    const middle = this.home[this.leader - 1];
    return this.disagreement_m ?? Math.max(...p.map(([x, y]) => Math.hypot(x - middle[0], y - middle[1])));
  }

  #show(k) { Object.assign(this, structuredClone(this.rows[k])); }

  frame() {
    const lost = (k) => this.losing.has(k) || (this.lossy && dice(k + 7.7 * Math.floor(this.tick / 12)) < 0.15);
    const length = ([x, y]) => Math.hypot(this.p[x - 1][0] - this.p[y - 1][0], this.p[x - 1][1] - this.p[y - 1][1]);
    const states = this.edges.map(
        (edge, k) =>
            (this.cut.has(k)                 ? 0 :
                 this.tick === 0             ? 4 :
                 length(edge) > this.range_m ? 3 :
                 lost(k)                     ? 2 :
                                               1));
    const round = (x) => Math.round(1e4 * x) / 1e4;
    return {
      tick: this.tick,
      t_s: this.t_s,
      state: this.state,
      pace: this.pace,
      real_time_factor: this.state === "running" ? (this.pace || 20) * 0.998 : 0,
      p: this.p.flatMap(([x, y, z]) => [x + this.drift_m_per_s * this.t_s, y, z]).map(round),
      v: this.v.flat().map(round),
      a: this.a.flat().map(round),
      q: this.a.flatMap((a, k) => this.#attitude(k, a)).map(round),
      u: this.p.flatMap((_, k) => [1, 2, 3, 4].map((r) => round(420 + 20 * dice(k + r) + 30 * this.a[k][2]))),
      flags: this.a.map((a) => (Math.max(...a.map(Math.abs)) >= 2.99 ? 1 : 0)),
      edge: states,
      age_s: states.map(
          (state, k) =>
              (state === 4     ? -1 :
                   state === 1 ? 0.01 :
                                 round(0.03 + 0.1 * dice(k)))),
      ...(this.left_out ? {left_out: this.left_out(this.t_s)} : {}),
      disagreement_m: this.#disagreement(this.p),
      curve: this.rows ? null : this.law_value?.(this.t_s) ?? null,
      speed_m_per_s: this.v.map((v) => round(Math.hypot(...v))),
      contacts: 0,
    };
  }

  #attitude(k, [ax, ay]) {
    if (k % 5 === 1) {
      const yaw = Math.atan2(this.v[k][1], this.v[k][0]);
      return [Math.cos(yaw / 2), 0, 0, Math.sin(yaw / 2)];
    }
    const roll = -ay / 19.6, pitch = ax / 19.6, w = Math.sqrt(Math.max(0, 1 - roll * roll - pitch * pitch));
    return [w, roll, pitch, 0];
  }

  // --- asking ---

  ask({ask, toml = "", value, count = 1, t_s}) {
    const at = `takes effect at tick ${this.tick + 1} (${(this.t_s + 0.01).toFixed(2)} s)`;
    if (ask === "pause")
      this.state = "paused";
    else if (ask === "resume")
      this.state = "running";
    else if (ask === "stop")
      this.state = "done";
    else if (ask === "step" && this.rows)
      this.#goTo(this.tick + count);
    else if (ask === "step")
      for (let k = 0; k < count; ++k) this.step();
    else if (ask === "pace")
      this.pace = value;
    else if (ask === "seek" && this.rows)
      this.#goTo(Math.round(t_s * RATE_HZ));
    else if (ask === "event")
      return this.#event(toml, at);
    else if (ask === "start" || ask === "land")
      return {granted: true, words: `asked to ${ask}`};
    else
      return {granted: false, words: `${ask}: expected pause, resume, step, pace, event or stop`};
    return {granted: true, words: at};
  }

  /** What has waited takes effect, if the run goes on. Returns whether there is such a thing. */
  take() {
    if (this.state === "paused" || this.waiting.length === 0) return false;
    this.events.push(...this.waiting.splice(0));
    return true;
  }

  #takeFault(toml) {
    const [, number] = /^(?:fault = \{ agent|restart) = (\d+)/.exec(toml) ?? [],
             kind = /kind = "(\w+)"/.exec(toml)?.[1];
    if (!number) return;
    const part = /of = "(\w+)"/.exec(toml)?.[1], words = part ? `${part} ${kind}` : kind === "kill" ? "lost" : kind;
    this.faults[number] = !kind || kind === "ok" ? [] : [...(this.faults[number] ?? []), words];
    const lost = Object.keys(this.faults).filter((id) => this.faults[id].includes("lost"));
    this.survives = lost.map((id) => ({from_s: 0, is_wrong: true, words: `agent ${id} is lost: the others go on`}));
  }

  #event(toml, words) {
    const numbers = [...toml.replace(/"[^"]*"/g, "").matchAll(/-?\d+(\.\d+)?(e-?\d+)?/g)].map(([text]) => Number(text));
    if (toml.startsWith("goto"))
      this.home[numbers[0] - 1] = numbers.slice(1, 4);
    else if (/^(cut|mend)/.test(toml)) {
      const k = this.edges.findIndex(([i, j]) => i === numbers[0] && j === numbers[1]);
      if (k < 0) return {granted: false, words: `event by hand: ${toml}: the file declares no such edge`};
      if (toml.startsWith("cut"))
        this.cut.add(k);
      else
        this.cut.delete(k);
    } else if (toml.includes("law.p_gain")) {
      if (numbers[0] > 1000)
        return {granted: false, words: `event by hand: law.p_gain: expected a number in [0, 1000], got ${numbers[0]}`};
      this.gains.p_gain = numbers[0];
    }
    this.#takeFault(toml);
    const list = this.waits && this.state === "paused" ? this.waiting : this.events;
    list.push({
      number: this.events.length + this.waiting.length + 1,
      tick: this.tick + 1,
      t_s: (this.tick + 1) / RATE_HZ,
      toml: `[[events]]\nat_s = ${((this.tick + 1) / RATE_HZ).toFixed(2)}\n${toml}\n`,
      by_hand: true
    });
    return {granted: true, words};
  }
}
