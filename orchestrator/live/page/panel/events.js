// The events of the run: when, what, and by whom, if that is known; to be copied into an experiment file.
import {byId, element, setText} from "../dom.js";
import {seconds} from "../numbers.js";

export class Events {
  #model;
  #notices;

  constructor(model, notices) {
    this.#model = model;
    this.#notices = notices;
    model.on("events", () => this.#show());
    model.on("run", () => this.#show());
  }

  #show() {
    const {events, expected, isRecording} = this.#model;
    const counts = [events.length || "", expected.length ? `${expected.length} pending` : ""];
    setText(byId("event-count"), counts.filter(Boolean).join(" + "));
    const pending = expected.toReversed().map((event) => this.#pendingRow(event));
    if (pending.length > 0 && events.length === 0) return byId("events").replaceChildren(...pending);
    if (events.length === 0)
      return byId("events").replaceChildren(element("p", {
        className: "muted hint",
        textContent: isRecording ?
            "Nothing was changed in this run." :
            "Nothing has been changed yet. Drag an agent that leads, click an edge, or tune a key: what you do stands here, and in the config.toml of the run."
      }));
    const all =
        button("Copy all as TOML", () => this.#copy(events.map(({toml}) => toml.trimEnd()).join("\n\n") + "\n"));
    byId("events").replaceChildren(
        element("div", {className: "row-end"}, all), ...pending,
        ...events.toReversed().map((event) => this.#row(event)));
  }

  #pendingRow({toml, words}) {
    return element(
        "article", {className: "event"},
        element(
            "header", {}, element("b", {textContent: "pending"}),
            element("span", {className: "muted", textContent: ` ${words}`})),
        element("pre", {textContent: toml.trim()}));
  }

  #row({tick, t_s, toml, by_hand}) {
    const copy = button("Copy as TOML", () => this.#copy(toml));
    return element(
        "article", {className: "event"},
        element(
            "header", {}, element("b", {textContent: `tick ${tick}`}),
            element("span", {className: "muted", textContent: ` ${seconds(t_s)}`}),
            ...(by_hand === null ? [] :
                                   [element("span", {className: "badge", textContent: by_hand ? "by hand" : "file"})]),
            copy),
        element("pre", {textContent: toml.trim()}));
  }

  async #copy(text) {
    await copyText(text);
    this.#notices.show("Copied", "", "granted");
  }
}

function button(textContent, onClick) {
  const made = element("button", {type: "button", className: "small", textContent});
  made.addEventListener("click", onClick);
  return made;
}

// Browsers give the clipboard to pages of https and of this machine only; the old way works everywhere.
async function copyText(text) {
  if (navigator.clipboard) return navigator.clipboard.writeText(text).catch(() => copyBySelection(text));
  copyBySelection(text);
}

function copyBySelection(text) {
  const area = document.body.appendChild(element("textarea", {value: text}));
  area.select();
  document.execCommand("copy");
  area.remove();
}
