// How a run has gone: rows [t_s, disagreement_m, curve of the law, ...speeds], from the server up to now, and from
// there on from the frames of a live run. Of many agents there are three speeds: the fastest, the mean and the slowest.

const MOST_ROWS = 1200;
export const MOST_SPEEDS = 8;  // as the server keeps them

/** Speeds as a row has them. */
export function speedsOf(speeds) {
  if (speeds.length <= MOST_SPEEDS) return speeds;
  const mean = speeds.reduce((sum, v) => sum + v, 0) / speeds.length;
  return [Math.max(...speeds), mean, Math.min(...speeds)];
}

/** Rows in order of time, thinned out by half whenever there are too many. */
export class History {
  rows = [];
  #every = 1;
  #seen = 0;

  /** Adds a row that is later than all; an earlier one begins anew. */
  add(row) {
    if (this.rows.length && row[0] <= this.rows.at(-1)[0]) this.clear();
    if (this.#seen++ % this.#every) return;
    this.rows.push(row);
    if (this.rows.length >= MOST_ROWS) this.#thin();
  }

  /** Takes the place of all rows. */
  set(rows) {
    this.clear();
    this.rows = rows;
    if (rows.length >= MOST_ROWS) this.#thin();
  }

  clear() {
    this.rows = [];
    this.#every = 1;
    this.#seen = 0;
  }

  #thin() {
    this.rows = this.rows.filter((_, k) => k % 2 === 0);
    this.#every *= 2;
  }

  /** The newest row up to a time; null: there is none. */
  at(t_s) {
    let low = 0, high = this.rows.length;  // rows before `low` are not later, those from `high` on are
    while (low < high) {
      const middle = (low + high) >> 1;
      if (this.rows[middle][0] <= t_s + 1e-9)
        low = middle + 1;
      else
        high = middle;
    }
    return this.rows[low - 1] ?? null;
  }
}
