// Styles and number texts that the pages of System share.

import { h } from "/dom.js";

// Load the style sheet of a page, unless it is loaded already.
export function styled(name) {
  const href = `/system/${name}.css`;
  if (document.querySelector(`link[href='${href}']`)) return;
  document.head.append(h("link", { rel: "stylesheet", href }));
}

export const count = (number, what) => `${number} ${what}${number === 1 ? "" : "s"}`;
