// The keyboard, and the sheet that explains it.
import {byId, element} from "../dom.js";

const SHEET = [
  ["space", "pause or go on"],
  [".", "one tick"],
  ["← →", "slower, faster; in a recording a tick back or on, with Shift a second"],
  ["Page ↑ ↓", "in a recording ten seconds back or on"],
  ["↑ ↓", "choose the agent before or after"],
  ["1 – 9", "choose agent 1 to 9"],
  ["Esc", "close the menu; choose none"],
  ["f", "follow the chosen agent"],
  ["a", "look at all"],
  ["t", "look from above"],
  ["v  c", "arrows: velocity, commanded acceleration"],
  ["n  r  e", "numbers, trails, edges"],
  ["?", "this sheet"],
];
const POINTER = [
  ["drag", "turn; with the right button, or two fingers, move; wheel or pinch: nearer"],
  ["drag an agent that leads or flies to waypoints", "send it there, at its height; with Shift straight up or down"],
  ["click an edge", "cut it, or mend it"],
  ["click an agent", "choose it"],
];

export function bindKeys({model, view, transport, follow, layers}) {
  const leftOrRight = (by, shiftKey) => !model.isRecording ? transport.changePace(by) :
      shiftKey                                             ? transport.seekBy(by) :
                                                             transport.step(by);
  const actions = {
    " ": () => transport.playOrPause(),
    ".": () => transport.step(),
    ArrowLeft: ({shiftKey}) => leftOrRight(-1, shiftKey),
    ArrowRight: ({shiftKey}) => leftOrRight(1, shiftKey),
    PageUp: () => model.isRecording && transport.seekBy(-10),
    PageDown: () => model.isRecording && transport.seekBy(10),
    ArrowUp: () => model.select(model.selected > 1 ? model.selected - 1 : model.size),
    ArrowDown: () => model.select(model.selected < model.size ? model.selected + 1 : 1),
    Escape: () => {
      if (byId("layers").open)
        byId("layers").open = false;
      else
        model.select(0);
    },
    f: follow,
    a: () => view.fit(),
    t: () => view.top(),
    v: () => layers.toggle("velocity"),
    c: () => layers.toggle("acceleration"),
    n: () => layers.toggle("numbers"),
    r: () => layers.toggle("trails"),
    e: () => layers.toggle("edges"),
    "?": () => byId("help").showModal(),
  };
  for (let number = 1; number <= 9; ++number) actions[number] = () => model.select(number);
  addEventListener("keydown", (event) => {
    const action = actions[event.key];
    if (!action || event.ctrlKey || event.altKey || event.metaKey || isTyping(event) ||
        document.querySelector("dialog[open]"))
      return;
    event.preventDefault();
    action(event);
  });
  // The view takes the focus when it is pressed; a frame around it is for those who come to it by the keyboard.
  addEventListener("pointerdown", () => document.body.classList.add("pointing"), true);
  addEventListener("keydown", ({key}) => key === "Tab" && document.body.classList.remove("pointing"), true);
  // A control that was pressed with the pointer does not keep the focus: the next space pauses, and does not press it
  // again. (Clicks by the keyboard have no detail.)
  addEventListener("click", ({target, detail}) => {
    const control = target.closest?.("button, summary");
    if (detail > 0 && control && control === document.activeElement) control.blur();
  });
}

// A focused control keeps the keys that it understands.
function isTyping({target, key}) {
  if (target.matches("input:not([type=checkbox]), select, textarea")) return true;
  if (target.matches("[role=tab]")) return key.startsWith("Arrow") || key === " ";
  return target.matches("button, summary, input") && key === " ";
}

export function fillHelp(dialog) {
  const table = (rows) => element(
      "dl", {className: "keys"},
      ...rows.flatMap(([key, words]) => [element("dt", {textContent: key}), element("dd", {textContent: words})]));
  const close = element("button", {type: "button", textContent: "Close"});
  close.addEventListener("click", () => dialog.close());
  // The heading has the focus, so that a sheet that is longer than the screen is open at its beginning.
  dialog.replaceChildren(
      element("h2", {id: "help-title", tabIndex: -1, autofocus: true, textContent: "Keys and pointer"}), table(SHEET),
      table(POINTER), element("p", {
        className: "muted",
        textContent:
            "Velocity arrows end where the agent is after a second; acceleration arrows are 1 m long for 1 m/s². The run decides about everything that you ask for, and says so in a corner of the view."
      }),
      close);
}
