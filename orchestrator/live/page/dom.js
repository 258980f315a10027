// Small helpers for elements. Text from the server is only ever set as text.

export const byId = (id) => document.getElementById(id);

/** An element with properties and children; a text is a child, too. */
export function element(name, properties = {}, ...children) {
  const made = document.createElement(name);
  for (const [key, value] of Object.entries(properties)) {
    if (key.includes("-") || key === "role")
      made.setAttribute(key, value);
    else
      made[key] = value;
  }
  made.append(...children);
  return made;
}

/** Sets the text of an element if it has another one. */
export function setText(target, text) {
  if (target.textContent !== text) target.textContent = text;
}

/** At most one call of `update` in `period_ms`, in the picture that comes then. */
export function throttled(period_ms, update) {
  let last = -Infinity, timer = null;
  return () => {
    if (timer !== null) return;
    timer = setTimeout(() => {
      timer = null;
      last = performance.now();
      update();
    }, Math.max(0, period_ms - (performance.now() - last)));
  };
}
