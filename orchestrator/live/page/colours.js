// Colours: of agents as in the pictures of a run (a palette that colour-blind readers can distinguish; viridis for more
// agents than it has), the others from the style sheet.

const AGENTS =
    ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#000000", "#882255", "#5c2d00", "#f0e442"];
const VIRIDIS = ["#440154", "#482878", "#3e4989", "#31688e", "#26828e", "#1f9e89", "#35b779", "#6ece58", "#b5de2b"];
const ON_DARK = {
  "#0072b2": "#2f9be0",
  "#000000": "#f2f2f2",
  "#882255": "#c4457f",
  "#5c2d00": "#a0703c"
};  // too dark on a dark ground
const ON_LIGHT = {
  "#f0e442": "#c9b800"
};  // too pale on a light one

export const isDark = () => document.documentElement.dataset.theme === "dark";

/** Colours "#rrggbb" of `size` agents, in the scheme of now. */
export function agentColours(size) {
  const changed = isDark() ? ON_DARK : ON_LIGHT;
  if (size <= AGENTS.length) return AGENTS.slice(0, size).map((colour) => changed[colour] ?? colour);
  const first = isDark() ? 0.3 : 0, last = isDark() ? 1 : 0.9;
  return Array.from({length: size}, (_, k) => viridis(first + (last - first) * k / (size - 1)));
}

function viridis(share) {
  const place = share * (VIRIDIS.length - 1), k = Math.min(Math.floor(place), VIRIDIS.length - 2);
  const [from, to] = [rgb(VIRIDIS[k]), rgb(VIRIDIS[k + 1])];
  return "#" +
      from.map((c, i) => Math.round(255 * (c + (to[i] - c) * (place - k))).toString(16).padStart(2, "0")).join("");
}

/** Red, green, blue in [0, 1] of "#rrggbb". */
export const rgb = (colour) => [1, 3, 5].map((k) => parseInt(colour.slice(k, k + 2), 16) / 255);

const styles = new Map();  // asked for in the scheme of now

/** A colour of the style sheet, "#rrggbb". */
export function styleColour(name) {
  if (!styles.has(name))
    styles.set(name, getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim());
  return styles.get(name);
}

/** Takes the scheme "light" or "dark". */
export function setScheme(scheme) {
  document.documentElement.dataset.theme = scheme;
  styles.clear();
}
