// What to type so that the selected agent of a recording lives through it again, or so that tools hear the recording.
import {element} from "../dom.js";

/** A word as a shell reads it. */
const shellWord = (word) => /^[\w@%+=:,./-]+$/.test(word) ? word : `'${word.replaceAll("'", "'\\''")}'`;

/** Elements with both commands, each to be copied. `run`: the recording as verbs take it. */
export function replayCommands(run, agent) {
  return [
    element("h4", {textContent: "replay"}),
    row(`orchestrator replay ${shellWord(run)} --to ${agent}`,
        "The agent's process lives through the recording again; its commands are compared, bit for bit"),
    row(`orchestrator replay ${shellWord(run)} --speed 1`, "The samples come on DDS again, for tools that listen"),
  ];
}

function row(command, meaning) {
  const button = element("button", {type: "button", className: "small", textContent: "Copy"});
  button.addEventListener("click", async () => {
    try {
      await navigator.clipboard.writeText(command);  // only on https and on this machine
      button.textContent = "Copied";
    } catch {
      getSelection().selectAllChildren(button.previousElementSibling);
      button.textContent = "Selected";
    }
  });
  return element("div", {className: "to-type", title: meaning}, element("code", {textContent: command}), button);
}
