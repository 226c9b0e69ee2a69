// Colours with a meaning, the same everywhere: the body's sides, people, and how far off something is.

export const SIDE_COLOURS = {l: '#0072B2', r: '#D55E00'};

/** The middle of the body has the theme's own grey. */
export function sideColour(side) {
  return SIDE_COLOURS[side] || themeColour('--middle');
}

const PEOPLE = ['#009E73', '#E69F00', '#56B4E9', '#8C6BB1', '#A6761D', '#66C2A5'];
export const personColour = p => PEOPLE[p % PEOPLE.length];

let theme = null;
export function themeColour(name) {
  if (!theme) theme = getComputedStyle(document.documentElement);
  return theme.getPropertyValue(name).trim();
}

/** After the theme has changed. */
export function forgetTheme() { theme = null; }

/** Grey where something agrees, ever more magenta where it is off; `severity` from 0 to 1, `agrees` the grey. */
export function offColour(severity, agrees = '--agrees') {
  if (!(severity > 0)) return themeColour(agrees);
  const s = Math.min(severity, 1);
  const from = hex(themeColour(agrees));
  const to = hex(themeColour('--off'));
  return `rgb(${from.map((x, i) => Math.round(x + s * (to[i] - x))).join()})`;
}

function hex(colour) {
  return [1, 3, 5].map(i => parseInt(colour.slice(i, i + 2), 16));
}
