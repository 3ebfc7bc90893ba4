// Create DOM elements from data. A text is never parsed as HTML, so names of people and files can't inject markup.

export function h(tag, attributes = {}, ...children) {
  const made = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (value === undefined || value === null || value === false) continue;
    if (name.startsWith("on")) made.addEventListener(name.slice(2), value);
    else if (name === "value") made.value = value;
    else if (name === "checked") made.checked = value;
    else made.setAttribute(name, value === true ? "" : value);
  }
  made.append(...children.flat().filter((one) => one !== null && one !== undefined && one !== false));
  return made;
}

export function put(place, ...children) {
  place.replaceChildren(...children.flat().filter((one) => one !== null && one !== undefined && one !== false));
}

// Set a text only if it differs. Otherwise screen readers would read it again, and the browser would lay it out again.
export function text(place, value) {
  if (place.textContent !== value) place.textContent = value;
}

export function mark(place, name, value) {
  if (place.getAttribute(name) !== value) place.setAttribute(name, value);
}

export function button(label, act, attributes = {}) {
  return h("button", { type: "button", onclick: act, ...attributes }, label);
}

export function seconds(value) {
  if (value < 60) return `${value.toFixed(1)} s`;
  return `${Math.floor(value / 60)}:${String(Math.floor(value % 60)).padStart(2, "0")} min`;
}

// Return the index of a command within blocks, in words: "P0020(#2)>P0010" becomes P0020 (pass 3) › P0010.
export function stands(where) {
  return where.split(">").map((one) => one.replace(/\(#(\d+)\)/g, (_, pass) => ` (pass ${Number(pass) + 1})`)).join(" › ");
}

// Split a command's title into the command and its place, in words: "P0020(#2)>P0010 MOVEL" becomes "P0010 MOVEL" and
// "in P0020 (pass 3)".
export function called(title) {
  const [where, ...name] = title.split(" ");
  const parts = where.split(">");
  const [, own, pass = ""] = parts.pop().match(/^(.*?)((?:\(#\d+\))*)$/);
  const words = [parts.length ? `in ${stands(parts.join(">"))}` : "", stands(pass).trim()].filter(Boolean);
  return [[own, ...name].join(" "), words.join(" ")];
}
