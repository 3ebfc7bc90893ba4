// The pendant's process: files that need a restart, restart and shutdown.

import { get, post } from "/api.js";
import { button, h, put } from "/dom.js";
import { serviced } from "/service.js";
import { asked } from "/system/asked.js";

export function ending(place, app) {
  const told = h("div", { "aria-live": "polite" });
  const may = app.may("service");
  put(place,
    h("h2", {}, "This pendant"), told,
    h("div", { class: "actions" },
      button("Restart", () => end("restart"), { disabled: !may }),
      button("Shut down", () => end("shut-down"), { disabled: !may })),
    may ? null : h("p", { class: "soft" }, "Restart and shut down need the role service and the PIN."));

  async function look() {
    let shown;
    try {
      shown = await get("/api/system/controller");
    } catch {
      return;
    }
    put(told,
      h("p", {}, shown.served ? `yarc serve owns ${shown.robot} and keeps running: only the pendant is restarted.` : `This process owns ${shown.robot}: the robot comes to rest before it ends.`),
      shown.waiting.length
        ? h("ul", { class: "waiting" }, shown.waiting.map(({ file, what }) => h("li", {}, h("strong", {}, file), `: ${what}.`)))
        : h("p", { class: "soft" }, "No changed file needs a restart."));
  }

  async function end(how) {
    const restarts = how === "restart";
    const what = h("p", {}, restarts ? "Pages reconnect automatically; nobody has to log in again." : "The pages can't be opened until the pendant is started again on its computer.");
    if (!(await asked(place, restarts ? "Restart the pendant?" : "Shut down the pendant?", what, restarts ? "Restart" : "Shut down"))) return;
    if (await ended(how, false)) app.notice(restarts ? "The pendant restarts." : "The pendant was shut down.");
  }

  // Request the end of the process. If the robot is moving, ask the user first whether to stop it.
  async function ended(how, stop) {
    let under = "";
    const done = await serviced(app, async () => {
      try {
        return await post(`/api/system/${how}`, { stop });
      } catch (refused) {
        if (refused.code !== "under-way") throw refused;
        under = refused.told.error;
        return null;
      }
    });
    if (!under) return done;
    const what = h("p", {}, `${under}. It is stopped on its path first.`);
    return (await asked(place, "Stop it?", what, "Stop it, then continue")) ? ended(how, true) : null;
  }

  return look;
}
