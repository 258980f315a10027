// What the server answered, for some seconds, in a corner of the view.
import {element} from "../dom.js";

const STAY_MS = {
  granted: 3500,
  refused: 9000
};
const MOST = 4;

export class Notices {
  #box;

  constructor(box) { this.#box = box; }

  /** Shows that an answer is awaited. Returns the function that ends it. */
  wait(title) {
    const notice = this.#add("waiting", title, "");
    return () => notice.remove();
  }

  /** `kind`: "granted" or "refused". */
  show(title, words, kind) {
    const notice = this.#add(kind, title, words);
    setTimeout(() => notice.remove(), STAY_MS[kind]);
  }

  #add(kind, title, words) {
    const close = element("button", {type: "button", className: "quiet", textContent: "×", "aria-label": "Close"});
    const notice = element(
        "div", {className: `notice ${kind}`, role: kind === "refused" ? "alert" : "status"},
        element("div", {}, element("b", {textContent: title}), element("p", {textContent: words})), close);
    close.addEventListener("click", () => notice.remove());
    this.#box.append(notice);
    while (this.#box.children.length > MOST) this.#box.firstChild.remove();
    return notice;
  }
}
