// What the pages of System share: their style, and numbers in words.

import { h } from "/dom.js";

// The rules of a page, once.
export function styled(name) {
  const href = `/system/${name}.css`;
  if (document.querySelector(`link[href='${href}']`)) return;
  document.head.append(h("link", { rel: "stylesheet", href }));
}

export const count = (number, what) => `${number} ${what}${number === 1 ? "" : "s"}`;
