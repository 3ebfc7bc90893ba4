// Style and texts that the pages of the history share.

import { h } from "/dom.js";

// Load the style sheet of these pages, unless it is loaded already.
export function style() {
  if (document.querySelector("link[href='/history/history.css']")) return;
  document.head.append(h("link", { rel: "stylesheet", href: "/history/history.css" }));
}

// Convert a time (ISO 8601, UTC) to the browser's time zone and language. The date is left out if it is today.
export function local(iso) {
  const when = new Date(iso);
  if (Number.isNaN(when.getTime())) return "unknown";
  const time = when.toLocaleTimeString([], { hour: "2-digit", minute: "2-digit", second: "2-digit" });
  return when.toDateString() === new Date().toDateString() ? time : `${when.toLocaleDateString()} ${time}`;
}

export const utc = (iso) => `${iso.slice(0, 19).replace("T", " ")} UTC`;

export function both(iso) {
  return iso ? `${local(iso)} (${utc(iso)})` : "";
}

// Return a list of names and values, without those that have no value.
export function facts(pairs) {
  return h("dl", { class: "facts" }, pairs.filter(([, value]) => value).map(([name, value]) => [h("dt", {}, name), h("dd", {}, value)]).flat());
}

// Open a program of the project at a line.
export function goToLine(app, file, line) {
  app.left = { file, lines: [line, line], state: app.left?.file === file ? app.left.state : { doc: null } };
  location.hash = `#/program/${encodeURIComponent(file)}`;
}
