// The changes that a backup's restore would make, with a choice for files that the backup doesn't contain.

import { call, post } from "/api.js";
import { button, h, put } from "/dom.js";
import { sized, when } from "/files/names.js";
import { serviced } from "/service.js";
import { count } from "/system/look.js";

const WORDS = { conflict: "can't be restored", changed: "changed", extra: "not in the backup", new: "new" };
const MARKS = { conflict: "deleted", changed: "changed", extra: "deleted", new: "new" };
const FIRST = 60;

// Return the element. `done` is called with the result of the restore, "again", or null.
export function planned(app, plan, done) {
  const remove = h("input", { type: "checkbox", checked: plan.undoes });
  const nothing = plan.new + plan.changed + plan.extra === 0;
  const list = h("ul", { class: "planned" });
  const go = button(plan.undoes ? "Undo it" : "Restore", () => apply(), { class: "main", disabled: plan.conflicts > 0 || nothing });

  function rows(most) {
    const more = plan.files.length - most;
    put(list,
      plan.files.slice(0, most).map((one) => h("li", {},
        h("span", { class: `mark ${MARKS[one.what]}` }, WORDS[one.what]),
        h("span", { class: "filename" }, one.file, one.why ? h("span", { class: "bad" }, ` ${one.why}`) : null),
        h("span", { class: "soft" }, one.what === "conflict" ? "" : sized(one.size)))),
      more > 0 ? h("li", {}, button(`${more} more`, () => rows(plan.files.length))) : null);
  }

  async function apply() {
    go.disabled = true;
    const told = await serviced(app, async () => {
      try {
        return await call("POST", "/api/backup/restore", { number: plan.number, digest: plan.digest, remove: remove.checked });
      } catch (refused) {
        if (!["changed", "half", "missing"].includes(refused.code)) throw refused;
        app.notice(refused.message, true);
        return refused.code === "missing" ? "gone" : "again";
      }
    });
    if (told === "gone") done(null);
    else if (told) done(told);
    else go.disabled = false;
  }

  async function away() {
    await app.tried(() => post("/api/backup/forget"));
    done(null);
  }

  rows(FIRST);
  const from = [plan.robot, when(plan.made)].filter(Boolean).join(", ");
  return h("div", { class: "plan" },
    h("h2", {}, plan.undoes ? "Changes by undoing" : `What this backup would change${from ? ` (${from})` : ""}`),
    plan.notes.map((one) => h("p", { class: "warn" }, `${one}.`)),
    h("p", {}, `${plan.new} new, ${plan.changed} changed, ${plan.same} unchanged, ${plan.extra} not in the backup.`),
    plan.conflicts ? h("p", { class: "bad" }, `${plan.conflicts} can't be restored: rename or delete the files in their way, and upload the backup again.`) : null,
    nothing && !plan.conflicts ? h("p", {}, "Nothing would change.") : list,
    plan.extra ? h("label", { class: "switch" }, remove, `delete ${count(plan.extra, "file")} that ${plan.undoes ? "the restore has made" : "the backup doesn't have"}`) : null,
    plan.restart.length ? h("p", { class: "warn" }, `${plan.restart.join(", ")} will take effect after a restart (System > Controller).`) : null,
    h("div", { class: "actions" }, go, button("Put it away", away)));
}
