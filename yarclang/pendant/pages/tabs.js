// A page with a row of tabs. The second part of the address is the tab: #/system/users.

import { h, put } from "/dom.js";

// Return a page made of tabs [name, title, page, role]. Tabs for which the user lacks the role are hidden.
export function tabbed(group, tabs) {
  return (place, app, rest) => {
    const [wanted, ...below] = rest.split("/");
    const shown = tabs.filter(([, , , role]) => app.may(role));
    const [name, title, page] = shown.find(([known]) => known === wanted) ?? shown[0];
    const inner = h("div", { class: "tab" });
    put(place,
      h("nav", { class: "tabs", "aria-label": "Parts of this page" },
        shown.map(([known, label]) => h("a", { href: `#/${group}/${known}`, class: "place", "aria-current": known === name ? "page" : null }, label))),
      inner);
    put(inner, h("h1", { class: "hidden" }, title));
    return page(inner, app, below.join("/"));
  };
}
