// The pages of users, sessions and the audit trail, and of the user's own account.

import { call, get, post, remove } from "/api.js";
import { theme } from "/app.js";
import { button, h, put } from "/dom.js";
import { serviced } from "/service.js";

const ROLES = ["viewer", "operator", "programmer", "service"];

export function peoplePage(place, app) {
  const users = h("tbody", {});
  const sessions = h("tbody", {});
  const audit = h("tbody", {});
  let oldest = null;
  const head = (...names) => h("thead", {}, h("tr", {}, names.map((name) => h("th", { scope: "col" }, name))));
  put(place,
    h("h1", { class: "hidden" }, "Users"),
    h("section", {}, h("h2", {}, "Users"), h("table", {}, head("Name", "Role", "PIN", "Logged in", ""), users), adding()),
    h("section", {}, h("h2", {}, "Sessions"), h("table", {}, head("User", "Role", "From", "Browser", "Quiet for", ""), sessions)),
    h("section", {}, h("h2", {}, "Audit trail"), h("table", {}, head("Time (UTC)", "Who", "From", "What", "Detail", "Outcome"), audit), button("Older", () => more())));

  async function look() {
    const told = await app.tried(() => get("/api/users"));
    put(users, (told?.users ?? []).map((one) => h("tr", {},
      h("th", { scope: "row" }, one.user), h("td", {}, roleOf(one)), h("td", {}, one.has_pin ? "yes" : "none"), h("td", {}, counted(one.sessions)),
      h("td", {}, h("div", { class: "side-by-side" }, button("New password", () => secret(one, "password")), button("New PIN", () => secret(one, "pin")), button("Remove", () => gone(one)))))));
    const open = await app.tried(() => get("/api/sessions"));
    put(sessions, (open?.sessions ?? []).map((one) => h("tr", {},
      h("th", { scope: "row" }, one.user), h("td", {}, one.role), h("td", {}, one.address), h("td", {}, one.agent), h("td", {}, `${Math.round(one.quiet_s)} s`),
      h("td", {}, one.here ? "this one" : button("End", () => serviced(app, () => remove(`/api/sessions/${one.session}`)).then(look))))));
    put(audit);
    oldest = null;
    await more();
  }

  async function more() {
    const told = await app.tried(() => get(`/api/audit?count=50${oldest === null ? "" : `&before=${oldest}`}`));
    for (const one of told?.entries ?? []) {
      oldest = one.number;
      audit.append(h("tr", {}, [one.time.slice(0, 23).replace("T", " "), one.user, one.address, one.action, one.detail, one.outcome].map((value) => h("td", {}, value))));
    }
  }

  function roleOf(one) {
    const made = h("select", { "aria-label": `Role of ${one.user}`, onchange: () => change(one, { role: made.value }) }, ROLES.map((role) => h("option", { value: role, selected: role === one.role }, role)));
    return made;
  }

  const change = (one, fields) => serviced(app, () => post(`/api/users/${encodeURIComponent(one.user)}`, fields)).then(look);

  function secret(one, what) {
    const value = h("input", { type: "password", required: true, autocomplete: "off", "aria-label": what });
    const form = h("form", { onsubmit: (event) => { event.preventDefault(); dialog.close(); change(one, { [what]: value.value }); } },
      h("h2", {}, `New ${what === "pin" ? "PIN" : what} of ${one.user}`), value, h("div", { class: "actions" }, h("button", { type: "submit", class: "main" }, "Set"), button("Cancel", () => dialog.close())));
    const dialog = h("dialog", { class: "asks", onclose: () => dialog.remove() }, form);
    document.body.append(dialog);
    dialog.show();
  }

  function gone(one) {
    const dialog = h("dialog", { class: "asks", onclose: () => dialog.remove() }, h("p", {}, `Remove ${one.user}? What they did stays in the audit trail.`),
      h("div", { class: "actions" }, button("Remove", () => { dialog.close(); serviced(app, () => call("DELETE", `/api/users/${encodeURIComponent(one.user)}`)).then(look); }, { class: "main" }), button("Cancel", () => dialog.close())));
    document.body.append(dialog);
    dialog.show();
  }

  function adding() {
    const form = h("form", {
      class: "adding",
      onsubmit: async (event) => {
        event.preventDefault();
        const given = Object.fromEntries([...new FormData(form)].filter(([, value]) => value !== ""));
        if (await serviced(app, () => post("/api/users", given))) form.reset();
        look();
      },
    },
    h("label", {}, "Name", h("input", { name: "user", required: true, maxlength: 40, autocomplete: "off" })),
    h("label", {}, "Role", h("select", { name: "role" }, ROLES.map((role) => h("option", { value: role, selected: role === "operator" }, role)))),
    h("label", {}, "Password", h("input", { name: "password", type: "password", required: true, minlength: 8, autocomplete: "new-password" })),
    h("label", {}, "PIN (service)", h("input", { name: "pin", type: "password", inputmode: "numeric", autocomplete: "off" })),
    h("button", { type: "submit" }, "Add"));
    return form;
  }

  look();
  app.whenBack(look);
}

// Return the number of a user's sessions, in words.
function counted(count) {
  return count > 1 ? `${count} times` : count ? "once" : "no";
}

export function accountPage(place, app) {
  const themes = h("select", { onchange: () => theme(themes.value) },
    [["auto", "as the device"], ["light", "light"], ["dark", "dark"]].map(([value, label]) => h("option", { value, selected: value === document.documentElement.dataset.theme }, label)));
  const form = h("form", {
    onsubmit: async (event) => {
      event.preventDefault();
      const given = Object.fromEntries([...new FormData(form)].filter(([, value]) => value !== ""));
      if (await app.tried(() => post("/api/me", given))) {
        form.reset();
        app.notice("It was changed.");
      }
    },
  },
  h("label", {}, "Password now", h("input", { name: "old_password", type: "password", required: true, autocomplete: "current-password" })),
  h("label", {}, "New password", h("input", { name: "password", type: "password", minlength: 8, autocomplete: "new-password" })),
  h("label", {}, "New PIN", h("input", { name: "pin", type: "password", inputmode: "numeric", autocomplete: "off" })),
  h("button", { type: "submit" }, "Change"));
  put(place, h("h1", { class: "hidden" }, "Account"),
    h("section", {}, h("h2", {}, `${app.me.user}, ${app.me.role}`), form),
    h("section", {}, h("h2", {}, "Colours"), h("label", {}, "This device is ", themes)),
    h("section", {}, h("h2", {}, "For programmers"), h("p", {}, h("a", { href: "/api/docs" }, "The API of this pendant"), ": other programs can do everything that these pages do.")));
}
