// The controller's settings, compared with those that the robot needs. They are sent after entering the PIN, and saved
// after another question.

import { order } from "/api.js";
import { button, h, put } from "/dom.js";
import { serviced } from "/service.js";
import { asked } from "/system/asked.js";

export function settings(place, app) {
  const shown = h("div", { class: "things", "aria-live": "polite" });
  put(place,
    h("h2", {}, "Settings"),
    h("div", { class: "actions" }, button("Look at everything", () => compare(), { disabled: !app.may("operator") })),
    shown);

  async function compare() {
    put(shown, h("p", {}, "Looking."));
    const told = await app.tried(() => order("settings"));
    if (!told) return put(shown);
    const wrong = told.things.filter(({ verdict }) => verdict !== "ok");
    put(shown,
      h("p", {}, wrong.length ? `${wrong.length} of ${told.things.length} checks failed.` : `All ${told.things.length} checks passed.`),
      wrong.length ? differences(wrong) : null,
      app.may("service") ? actions(told) : h("p", { class: "soft" }, "Sending settings needs the role service and the PIN."));
  }

  function differences(wrong) {
    const heads = ["What", "The controller has", "Needed", "What to do"];
    return h("table", {},
      h("thead", {}, h("tr", {}, heads.map((one) => h("th", { scope: "col" }, one)))),
      h("tbody", {}, wrong.map((one) => h("tr", { class: one.verdict },
        h("th", { scope: "row" }, one.name, one.about ? h("small", {}, ` ${one.about}`) : null),
        h("td", { class: "found" }, one.found), h("td", {}, one.wanted), h("td", {}, one.help)))));
  }

  function actions(told) {
    return h("div", { class: "actions" },
      button(`Send all ${told.lines} lines`, () => send(told)),
      button("Save in the controller", () => save()));
  }

  async function send(told) {
    const what = h("p", {}, "The controller's limits, scales, PLCs and axis definitions become those of this robot. All motors have to be disabled: the brakes must hold the arm.");
    if (!(await asked(place, "Send the settings?", what, `Send ${told.lines} lines`))) return;
    const sent = await serviced(app, () => order("send-settings", { known: told.sha256 }));
    if (!sent) return;
    await compare();
    if (sent.what) app.notice(`${sent.sent} of ${sent.of} lines were accepted: ${sent.what}: ${sent.help}`, true);
    else app.notice(`The controller has accepted all ${sent.of} lines. They are lost at power-off unless they are saved.`);
  }

  async function save() {
    const what = h("p", {}, "SAVE stores all present settings of the controller permanently, and replaces the stored ones. It takes some seconds.");
    if (!(await asked(place, "Save in the controller?", what, "Save"))) return;
    if (await serviced(app, () => order("save-settings"))) app.notice("The controller has saved its settings.");
  }

  return compare;
}
