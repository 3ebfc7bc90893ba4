// Drawing of a plot on a canvas.

const COLOURS = ["#2f86d6", "#e0731d", "#27a05c", "#d63f6c", "#8a66d6", "#a88a00", "#17a2b0", "#b05a3c"];
const SHADES = { hold: "--warn", fault: "--bad", disconnected: "--accent" };
const [LEFT, RIGHT, TOP, BOTTOM] = [58, 10, 8, 24]; // margins around the panel [px]

export const colourOf = (index) => COLOURS[index % COLOURS.length];

export class Drawing {
  constructor(canvas) {
    this.canvas = canvas;
    this.pen = canvas.getContext("2d");
    this.window = [0, 1];
  }

  // Return the time [s] at a horizontal position on the canvas [px].
  timeAt(x) {
    const [from, to] = this.window;
    return from + ((x - LEFT) / Math.max(1, this.width - LEFT - RIGHT)) * (to - from);
  }

  paint(shown) {
    const { canvas, pen } = this;
    const [width, height] = [canvas.clientWidth, canvas.clientHeight];
    if (width < 80 || height < 50) return [];
    const ratio = devicePixelRatio || 1;
    if (canvas.width !== Math.round(width * ratio) || canvas.height !== Math.round(height * ratio)) {
      canvas.width = Math.round(width * ratio);
      canvas.height = Math.round(height * ratio);
    }
    const look = getComputedStyle(canvas);
    this.colour = (name) => look.getPropertyValue(name).trim();
    Object.assign(this, { width, height, window: shown.window });
    pen.setTransform(ratio, 0, 0, ratio, 0, 0);
    pen.clearRect(0, 0, width, height);
    pen.font = "13px system-ui, sans-serif";
    this.timeTicks();
    for (const one of shown.states) this.shade(one.from_s, one.to_s, this.colour(SHADES[one.state] ?? "--line"), 0.22);
    const values = shown.lines ? this.lines(shown) : this.signals(shown);
    this.cursor(shown.time);
    return values;
  }

  x(time) {
    const [from, to] = this.window;
    return LEFT + ((time - from) / (to - from)) * (this.width - LEFT - RIGHT);
  }

  timeTicks() {
    const { pen, height } = this;
    const [from, to] = this.window;
    const step = niceStep((to - from) / Math.max(2, this.width / 110));
    pen.textAlign = "center";
    pen.textBaseline = "top";
    for (let time = Math.ceil(from / step) * step; time <= to; time += step) {
      this.rule(this.x(time), TOP, this.x(time), height - BOTTOM, "--line");
      pen.fillStyle = this.colour("--soft");
      pen.fillText(`${rounded(time, step)} s`, Math.min(this.x(time), this.width - 24), height - BOTTOM + 5);
    }
  }

  rule(x1, y1, x2, y2, colour, wide = 1) {
    const { pen } = this;
    pen.strokeStyle = this.colour(colour);
    pen.lineWidth = wide;
    pen.beginPath();
    pen.moveTo(x1, y1);
    pen.lineTo(x2, y2);
    pen.stroke();
  }

  shade(from, to, colour, strength) {
    const { pen } = this;
    const [a, b] = [Math.max(LEFT, this.x(from)), Math.min(this.width - RIGHT, Math.max(this.x(to), this.x(from) + 2))];
    if (b <= a) return;
    pen.globalAlpha = strength;
    pen.fillStyle = colour;
    pen.fillRect(a, TOP, b - a, this.height - TOP - BOTTOM);
    pen.globalAlpha = 1;
  }

  lines({ lines, planned, hidden, time }) {
    const [low, high] = this.range(lines, planned, hidden);
    const y = (value) => this.height - BOTTOM - ((value - low) / (high - low)) * (this.height - TOP - BOTTOM);
    this.valueTicks(low, high, y);
    const digits = Math.max(0, Math.min(5, 3 - Math.floor(Math.log10(high - low))));
    const { pen } = this;
    pen.save();
    pen.beginPath();
    pen.rect(LEFT, TOP, this.width - LEFT - RIGHT, this.height - TOP - BOTTOM);
    pen.clip();
    const told = [];
    lines.values.forEach((row, index) => {
      if (hidden.has(index)) return;
      if (planned) this.line(planned.times, planned.values[index], planned.breaks, y, this.colour("--soft"), 5, 0.35);
      this.line(lines.times, row, lines.breaks, y, colourOf(index), 1.8, 1);
      const at = nearest(lines.times, time);
      if (at >= 0) told.push(`${lines.names[index]} ${row[at].toFixed(digits)}`);
    });
    pen.restore();
    return told.length ? [...told, `[${lines.unit}]`] : [];
  }

  // Return the smallest and the largest value in the visible time range, with a margin.
  range(lines, planned, hidden) {
    let [low, high] = [Infinity, -Infinity];
    const [from, to] = this.window;
    for (const one of [lines, planned]) {
      one?.values.forEach((row, index) => {
        if (hidden.has(index)) return;
        row.forEach((value, at) => {
          if (one.times[at] < from || one.times[at] > to) return;
          low = Math.min(low, value);
          high = Math.max(high, value);
        });
      });
    }
    if (low > high) return [-1, 1];
    const room = Math.max((high - low) * 0.06, 1e-6 * Math.max(1, Math.abs(high)), high === low ? 0.5 : 0);
    return [low - room, high + room];
  }

  valueTicks(low, high, y) {
    const { pen } = this;
    const step = niceStep((high - low) / Math.max(2, this.height / 55));
    pen.textAlign = "right";
    pen.textBaseline = "middle";
    for (let value = Math.ceil(low / step) * step; value <= high; value += step) {
      this.rule(LEFT, y(value), this.width - RIGHT, y(value), Math.abs(value) < step / 1e6 ? "--soft" : "--line");
      pen.fillStyle = this.colour("--soft");
      pen.fillText(rounded(value, step), LEFT - 6, y(value));
    }
  }

  line(times, row, breaks, y, colour, wide, strength) {
    const { pen } = this;
    const starts = new Set(breaks);
    pen.strokeStyle = colour;
    pen.lineWidth = wide;
    pen.globalAlpha = strength;
    pen.lineJoin = "round";
    pen.beginPath();
    times.forEach((time, at) => (at === 0 || starts.has(at) ? pen.moveTo(this.x(time), y(row[at])) : pen.lineTo(this.x(time), y(row[at]))));
    pen.stroke();
    pen.globalAlpha = 1;
  }

  signals({ signals, time }) {
    const { pen } = this;
    const each = (this.height - TOP - BOTTOM) / Math.max(signals.length, 1);
    const told = [];
    signals.forEach((one, index) => {
      const [top, high] = [TOP + index * each, Math.min(0.62 * each, 40)];
      const bar = (from, to, colour, size) => {
        const [a, b] = [Math.max(LEFT, this.x(from)), Math.min(this.width - RIGHT, Math.max(this.x(to), this.x(from) + 2))];
        pen.fillStyle = colour;
        if (b > a) pen.fillRect(a, top + (each + high) / 2 - size, b - a, size);
      };
      for (const part of one.stretches) {
        bar(part.from_s, part.to_s, one.is_input ? COLOURS[2] : COLOURS[0], part.value === 0 ? 2 : high);
        if (part.from_s <= time && time <= part.to_s) told.push(`${one.name} ${part.value === 1 ? "ON" : part.value === 0 ? "OFF" : part.value}`);
      }
      pen.globalAlpha = 0.5;
      for (const wait of one.waits) bar(wait.from_s, wait.to_s, this.colour(wait.met ? "--warn" : "--bad"), high / 3);
      pen.globalAlpha = 1;
      pen.fillStyle = this.colour("--ink");
      pen.textAlign = "left";
      pen.textBaseline = "middle";
      pen.fillText(one.name.slice(0, 24), LEFT + 6, top + 9);
    });
    return told;
  }

  cursor(time) {
    const x = this.x(time);
    if (x >= LEFT - 1 && x <= this.width - RIGHT + 1) this.rule(x, TOP, x, this.height - BOTTOM, "--accent", 2);
  }
}

// Return the smallest step of at least `least` that is 1, 2 or 5 times a power of ten.
function niceStep(least) {
  const power = 10 ** Math.floor(Math.log10(Math.max(least, 1e-9)));
  return [1, 2, 5, 10].map((one) => one * power).find((one) => one >= least * 0.999) ?? power;
}

function rounded(value, step) {
  const digits = Math.max(0, Math.min(6, -Math.floor(Math.log10(step) + 1e-9)));
  return (Math.abs(value) < step / 1e6 ? 0 : value).toFixed(digits);
}

// Return the index of the value in ascending `times` that is nearest to a time; -1 if `times` is empty.
function nearest(times, time) {
  let [low, high] = [0, times.length - 1];
  if (high < 0) return -1;
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (times[middle] <= time) low = middle;
    else high = middle;
  }
  return Math.abs(times[low] - time) <= Math.abs(times[high] - time) ? low : high;
}
