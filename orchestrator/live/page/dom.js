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

/** A number for people: about four digits. */
export function figure(x, digits = 3) {
  if (x === null || x === undefined || !Number.isFinite(x)) return "–";
  const size = Math.abs(x);
  if (size !== 0 && (size < 1e-3 || size >= 1e5)) return x.toExponential(1).replace("-", "−");
  return (size < 10       ? x.toFixed(digits) :
              size < 1000 ? x.toFixed(Math.max(0, digits - 1)) :
                            x.toFixed(0))
      .replace("-", "−");
}

/** A unit as it is typeset: m² for m^2. */
export const typeset = (unit) => unit.replace("^2", "²").replace("^3", "³");

/** A number with so many decimals, and a minus that is as wide as a digit. */
export function fixed(x, decimals = 2) {
  if (!Number.isFinite(x)) return "–";
  const text = x.toFixed(decimals);
  return Number(text) === 0 ? text.replace("-", "") : text.replace("-", "−");
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
