// What a run has left beside its recording: its pictures and the figures of its summary.
import {byId, element} from "../dom.js";
import {figure} from "../numbers.js";

const MOST_ROWS = 300;

/** Figures of a summary by dotted name: [name, text]; lists are left out. */
export function figuresOf(summary, prefix = "") {
  const rows = [];
  for (const [key, value] of Object.entries(summary)) {
    const name = prefix + key;
    if (value !== null && typeof value === "object") {
      if (!Array.isArray(value)) rows.push(...figuresOf(value, `${name}.`));
    } else {
      rows.push([name, typeof value === "number" ? figure(value) : String(value ?? "-")]);
    }
  }
  return rows;
}

export class Results {
  #model;
  #shown = "";  // which results are on the page

  constructor(model) {
    this.#model = model;
    model.on("experiment", () => this.#show());
  }

  #show() {
    const {pictures = [], has_summary = false} = this.#model.experiment?.recorded ?? {};
    const key = JSON.stringify([this.#model.experiment?.name, pictures, has_summary]);
    if (key === this.#shown) return;
    this.#shown = key;
    byId("tab-results").hidden = pictures.length === 0 && !has_summary;
    const figures = element("div", {className: "figures-table"});
    byId("results").replaceChildren(...pictures.map(picture), figures);
    if (has_summary) this.#read(figures, key);
  }

  async #read(target, key) {
    const answer = await fetch("/results/summary.json").catch(() => null);
    const summary = answer?.ok ? await answer.json().catch(() => null) : null;
    if (key !== this.#shown) return;
    if (summary === null)
      return target.replaceChildren(element("p", {className: "muted hint"}, "The summary cannot be read."));
    const rows =
        figuresOf(summary)
            .slice(0, MOST_ROWS)
            .map(([name, text]) => element("tr", {}, element("th", {scope: "row"}, name), element("td", {}, text)));
    target.replaceChildren(element("table", {}, element("tbody", {}, ...rows)));
  }
}

function picture(name) {
  const address = `/results/${name}`, words = name.replace(/\.[a-z]+$/, "");
  return element(
      "figure", {},
      element(
          "a", {href: address, target: "_blank", rel: "noopener"},
          element("img", {src: address, alt: words, loading: "lazy"})),
      element("figcaption", {className: "muted"}, words));
}
