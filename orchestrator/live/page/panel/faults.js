// What goes wrong with an agent: the menu from which somebody chooses it. The table of faults is the server's.
import {faultToml, restartToml} from "../asking.js";
import {element} from "../dom.js";

const LOSSES = ["kill", "hang"];

export class FaultMenu {
  #model;
  #asking;
  #dialog;

  constructor(model, asking, dialog) {
    this.#model = model;
    this.#asking = asking;
    this.#dialog = dialog;
    dialog.addEventListener("click", ({target}) => target === dialog && dialog.close());  // beside the menu
  }

  /** Whether there is anything to choose: the page shows a run that it may change. */
  get isOffered() { return this.#model.canChange && this.#model.experiment.fault_kinds.length > 0; }

  open(number) {
    const {fault_kinds: kinds, on_agent_loss: onLoss} = this.#model.experiment, endsRun = onLoss === "abort";
    const parts = [...new Set(kinds.map(({of}) => of))];
    const choicesOf = (part) => kinds.filter(({of}) => of === part).map((row) => this.#choice(number, row, endsRun));
    const groups = parts.flatMap(
        (part) => [element("h4", {textContent: part}), element("div", {className: "choices"}, ...choicesOf(part))]);
    const close = element("button", {type: "button", textContent: "Close"});
    close.addEventListener("click", () => this.#dialog.close());
    const restart = element("button", {type: "button", textContent: "Restart"});
    restart.title = "A fresh agent takes its place: it has forgotten all, and is not lost, mute or deaf any more";
    restart.addEventListener("click", () => this.#ask(restartToml(number), `Restart agent ${number}`));
    this.#dialog.replaceChildren(
        element("h2", {id: "faults-title", tabIndex: -1, autofocus: true, textContent: `A fault of agent ${number}`}),
        ...groups, element("p", {
          className: endsRun ? "warn" : "muted",
          textContent: endsRun ? 'In this run, kill and hang end the run (run.on_agent_loss = "abort").' :
                                 `An agent that is killed or hangs is lost (run.on_agent_loss = "${onLoss}").`
        }),
        element("div", {className: "row-end"}, ...(endsRun ? [] : [restart]), close));
    this.#dialog.showModal();
  }

  #choice(number, {of, kind, parameters, meaning}, endsRun) {
    const button = element("button", {type: "button", className: "small", textContent: kind});
    button.dataset.fault = `${of} ${kind}`;
    button.classList.toggle("danger", endsRun && LOSSES.includes(kind));
    const usual = parameters && parameters !== "unanswered" ? `\nwith the usual ${parameters}` : "";
    button.title = meaning.replaceAll("`", "") + usual;
    button.addEventListener(
        "click",
        () => this.#ask(faultToml(number, of, kind), `Agent ${number}: ${of === "agent" ? "" : `${of} `}${kind}`));
    return button;
  }

  #ask(toml, say) {
    this.#dialog.close();
    return this.#asking.event(toml, say);
  }
}
