// A picture of the next step, made of SVG elements: the tool at the pointed object, the points of the frame, or a joint
// and its marks.

const SVG = "http://www.w3.org/2000/svg";
// For each touch of a tip, as drawn: angle of the tool [deg], and its length as a factor (below 1: tilted away from the
// viewer; above 1: towards the viewer).
const TILTS = [[0, 1], [32, 1], [-32, 1], [6, 0.68], [-6, 1.12], [44, 0.9], [-44, 0.9]];
const AT = [[70, 150], [236, 118], [128, 62]];
const NAMES = ["origin", "on x", "on the plane"];

function s(tag, attributes = {}, ...children) {
  const made = document.createElementNS(SVG, tag);
  for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, value);
  made.append(...children);
  return made;
}

export function picture(told) {
  const [said, ...parts] = PICTURES[told.kind](told);
  return s("svg", { viewBox: "0 0 300 190", class: "picture", role: "img", "aria-label": said }, ...parts);
}

function tool([angle, length], look) {
  const turned = `translate(150 130) rotate(${angle}) scale(1 ${length})`;
  return s("g", { transform: turned, class: `tool ${look}` },
    s("path", { d: "M0 0 L-5 -22 L-9 -62 L-24 -62 L-24 -82 L24 -82 L24 -62 L9 -62 L5 -22 Z" }),
    s("path", { d: "M-13 -82 L-13 -104 L13 -104 L13 -82", class: "flange" }));
}

function tip(told) {
  const count = told.touches.length;
  const next = TILTS[count % TILTS.length];
  const before = TILTS.slice(0, Math.min(count, TILTS.length)).filter((one) => one !== next);
  const turns = count ? `The tool at the same point, ${next[1] < 1 ? "tilted towards you" : next[1] > 1 ? "tilted away from you" : "tilted to another side"}` : "The tool's tip at a pointed object";
  const parts = [
    s("path", { d: "M150 130 L128 182 L172 182 Z", class: "object" }),
    s("path", { d: "M90 182 L210 182", class: "ground" }),
    ...before.slice(-3).map((one) => tool(one, "before")),
    tool(next, "next"),
    s("circle", { cx: 150, cy: 130, r: 5, class: "point next" }),
  ];
  if (count) parts.push(arc(before.at(-1)?.[0] ?? 0, next[0]));
  return [turns, ...parts];
}

// Return an arrow from one tilt to the next.
function arc(from, to) {
  const place = (angle) => [150 + 116 * Math.sin((angle * Math.PI) / 180), 130 - 116 * Math.cos((angle * Math.PI) / 180)];
  const [x, y] = place(from);
  const [u, v] = place(to);
  const side = to > from ? 1 : -1;
  const way = ((to + (side > 0 ? 0 : 180)) * Math.PI) / 180;
  const head = [-0.5, 0.5].map((off) => [u - 11 * Math.cos(way + off), v - 11 * Math.sin(way + off)]);
  return s("path", { class: "way", d: `M${x} ${y} A116 116 0 0 ${side > 0 ? 1 : 0} ${u} ${v} M${head[0]} L${u} ${v} L${head[1]}` });
}

function frame(told) {
  const count = told.touches.length;
  const points = AT.map(([x, y], at) => [x, y, NAMES[at], at]);
  // a further point on the plane
  if (count >= AT.length) points.push([128, 98, "further", count]);
  const [ox, oy] = AT[0];
  return [
    count < AT.length ? `Touch the point ${NAMES[count]}` : "Touch a further point of the plane",
    s("path", { d: "M40 166 L262 122 L284 52 L98 60 Z", class: "plate" }),
    s("path", { d: `M${ox} ${oy} L262 113 M252 108 L262 113 L254 121`, class: "axis x" }),
    s("path", { d: `M${ox} ${oy} L110 70 M101 79 L110 70 L113 83`, class: "axis y" }),
    s("path", { d: `M${ox} ${oy} L${ox} 64 M64 74 L${ox} 64 L76 74`, class: "axis z" }),
    label(268, 108, "x", "axis x"), label(106, 58, "y", "axis y"), label(58, 60, "z", "axis z"),
    ...points.flatMap(([x, y, name, at]) => [
      s("circle", { cx: x, cy: y, r: at === count ? 9 : 6, class: `point ${at === count ? "next" : at < count ? "done" : "later"}` }),
      label(x + 12, y + 18, `${at + 1} ${name}`, at === count ? "named next" : "named"),
    ]),
  ];
}

function label(x, y, text, look) {
  return s("text", { x, y, class: look }, text);
}

function home(told) {
  const turned = told.touches.length ? 0 : 24;
  return [
    told.touches.length ? "The joint at its mark" : "Turn the joint until both marks meet",
    s("circle", { cx: 120, cy: 108, r: 50, class: "link" }),
    s("path", { d: "M78 150 L66 182 L174 182 L162 150", class: "link" }),
    s("path", { d: "M120 66 L111 84 L129 84 Z", class: "mark still" }),
    s("g", { transform: `rotate(${turned} 120 108)` },
      s("path", { d: "M112 58 L112 12 L128 12 L128 58", class: "link moved" }),
      s("path", { d: "M120 57 L111 40 L129 40 Z", class: "mark next" })),
    ...(turned ? [s("path", { class: "way", d: "M176 46 A82 82 0 0 0 142 29 M153 25 L142 29 L150 38" })] : []),
    label(190, 60, "moving mark", "named next"), label(190, 96, "fixed mark", "named"),
  ];
}

const PICTURES = { tip, frame, home };
