// A small plot of a number in the last hour: one point per minute, from the smallest to the largest value.

const [WIDTH, HEIGHT, EDGE, MOST] = [120, 28, 2, 60];

export function sparkline(name) {
  // the HTML parser creates SVG elements in the right namespace
  const made = new DOMParser().parseFromString("<svg><polyline></polyline></svg>", "text/html");
  const element = document.adoptNode(made.querySelector("svg"));
  const line = element.firstChild;
  element.setAttribute("viewBox", `0 0 ${WIDTH} ${HEIGHT}`);
  element.setAttribute("class", "sparkline");
  element.setAttribute("role", "img");
  element.setAttribute("aria-label", `${name} in the last hour`);
  let shown = "";

  function show(values) {
    const points = drawn(values);
    if (points === shown) return;
    shown = points;
    line.setAttribute("points", points);
    element.toggleAttribute("data-empty", values.length < 2);
  }

  show([]);
  return { element, show };
}

// Draw the newest point at the right edge. A constant number is a line in the middle.
function drawn(values) {
  const [least, greatest] = [Math.min(...values), Math.max(...values)];
  const span = greatest - least || 1;
  const step = (WIDTH - 2 * EDGE) / (MOST - 1);
  return values
    .map((value, number) => {
      const x = WIDTH - EDGE - (values.length - 1 - number) * step;
      const share = greatest === least ? 0.5 : (value - least) / span;
      return `${x.toFixed(1)},${(HEIGHT - EDGE - share * (HEIGHT - 2 * EDGE)).toFixed(1)}`;
    })
    .join(" ");
}
