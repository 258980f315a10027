// The table of a run's incidents, events.csv.

import {seconds} from "./numbers.js";

/** What happened, but for events, which have marks of their own: {t_s, words}. */
export function incidentsIn(csv) {
  const [names, ...rows] = rowsOf(csv);
  return rows.map((row) => Object.fromEntries(names.map((name, k) => [name, row[k]])))
      .filter(({t_s, what, until_s}) => t_s && until_s && what && what !== "event")
      .map((incident) => ({t_s: Number(incident.t_s), words: wordsFor(incident)}));
}

function wordsFor({what, t_s, until_s, agent, detail, with: other}) {
  const until = until_s === t_s ? "" : `until ${seconds(Number(until_s))}`;
  return [`${what.replaceAll("_", " ")} of agent ${agent}`, other, detail, until].filter(Boolean).join(", ");
}

/** Rows of fields; quoted ones may hold commas, lines and doubled quotes (RFC 4180). */
function rowsOf(csv) {
  const rows = [[]];
  const field = /(?:"((?:[^"]|"")*)"|([^",\n]*))(,|\n|$)/gy;
  while (field.lastIndex < csv.length) {
    const [, quoted, plain, end] = field.exec(csv) ?? [];
    if (end === undefined) break;  // no such table
    rows.at(-1).push(quoted === undefined ? plain : quoted.replaceAll('""', '"'));
    if (end === "\n") rows.push([]);
  }
  return rows.filter((row) => row.length > 1);
}
