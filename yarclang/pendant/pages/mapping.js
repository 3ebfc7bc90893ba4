// The page on which users map joystick axes and keys to actions. Bars show the deflection of each axis.

import { DEEDS, DEFAULT, TARGETS } from "/devices.js";
import { button, h, put, text } from "/dom.js";

export function mappingPage(place, app) {
  const { devices } = app;
  const name = h("p", {});
  const bars = h("div", { class: "bars" });
  const keys = h("table", { class: "keys" });
  const told = h("p", { role: "status" });
  put(place,
    h("h1", { class: "hidden" }, "Joystick and keys"),
    h("div", { class: "columns" },
      h("section", {}, h("h2", {}, "Joystick"), name, bars,
        h("p", {}, "Hold the enabling button, then move the stick. Releasing the button stops the robot.")),
      h("section", {}, h("h2", {}, "Keys"), keys, told,
        h("p", {}, "A key of a keyboard, or a membrane switch that acts as one. If one key is the enabling key, the other keys jog only while it is held. Escape always stops."),
        button("Restore defaults", () => { devices.map = structuredClone(DEFAULT); devices.keep(); draw(); drawKeys(); }))));
  let shown = "";
  let rows = [];
  let buttons = [];

  function draw() {
    const pad = devices.pad;
    shown = pad ? pad.id : "";
    text(name, pad ? pad.id : "No joystick: connect one, and press a button on it.");
    if (!pad) { put(bars); rows = []; return; }
    rows = pad.axes.map((_, number) => {
      devices.map.axes[number] ??= { to: "", sign: 1 };
      const mapped = devices.map.axes[number];
      const at = h("span", { class: "at" });
      const to = h("select", { "aria-label": `Axis ${number} moves`, onchange: () => { mapped.to = to.value; devices.keep(); } },
        ["", ...TARGETS].map((one) => h("option", { value: one, selected: one === mapped.to }, one ? one.toUpperCase() : "nothing")));
      const turned = h("input", { type: "checkbox", checked: mapped.sign < 0, onchange: () => { mapped.sign = turned.checked ? -1 : 1; devices.keep(); } });
      return { at, row: h("div", { class: "joint" }, h("strong", {}, `Axis ${number}`), h("div", { class: "bar" }, at), to, h("label", {}, turned, "reversed")) };
    });
    buttons = pad.buttons.map((_, number) => h("label", { class: "pad" },
      h("input", { type: "radio", name: "enable", checked: number === devices.map.enable, onchange: () => { devices.map.enable = number; devices.keep(); } }), `Button ${number}`));
    put(bars, rows.map(({ row }) => row), h("fieldset", { class: "pads" }, h("legend", {}, "Enabling button"), buttons));
  }

  function refresh() {
    const pad = devices.pad;
    if ((pad?.id ?? "") !== shown || (pad && rows.length !== pad.axes.length)) draw();
    pad?.axes.forEach((value, number) => rows[number].at.style.setProperty("left", `${50 + 50 * value}%`));
    pad?.buttons.forEach((one, number) => buttons[number].classList.toggle("on", one.pressed));
  }

  function drawKeys() {
    const deeds = [...DEEDS, ...TARGETS.flatMap((axis) => [`${axis}+`, `${axis}-`])];
    put(keys, h("tbody", {}, deeds.map((deed) => {
      const mapped = Object.entries(devices.map.keys).filter(([, one]) => one === deed).map(([code]) => code);
      return h("tr", {}, h("th", { scope: "row" }, DEEDS.includes(deed) ? deed : `jog ${deed.toUpperCase()} (joint ${TARGETS.indexOf(deed[0]) + 1}${deed[1]})`),
        h("td", {}, mapped.join(", ") || "none"),
        h("td", {}, button("Choose", () => learn(deed)), mapped.length ? button("None", () => forget(deed)) : null));
    })));
  }

  function learn(deed) {
    text(told, `Press the key that is to ${DEEDS.includes(deed) ? deed : `jog ${deed}`}.`);
    devices.learning = (code) => {
      if (code === "Escape") return text(told, "Escape always stops.");
      devices.map.keys[code] = deed;
      devices.keep();
      text(told, `${code}: ${deed}.`);
      drawKeys();
    };
  }

  function forget(deed) {
    for (const [code, one] of Object.entries(devices.map.keys)) if (one === deed) delete devices.map.keys[code];
    devices.keep();
    drawKeys();
  }

  draw();
  drawKeys();
  const looking = setInterval(refresh, 50);
  return () => {
    clearInterval(looking);
    devices.learning = null;
  };
}
