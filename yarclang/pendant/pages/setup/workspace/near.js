// The smallest distances between bodies. They are requested repeatedly while the page is shown, and drawn as lines in
// the scene.

import { post } from "/api.js";
import { BufferAttribute, BufferGeometry, LineBasicMaterial, LineSegments } from "/bundles/three.js";
import { h, put, text } from "/dom.js";

const EACH = 250; // time between a reply and the next request [ms]
const AGAIN = 2000; // time after a refusal [ms]

export class Nearest {
  constructor(draft) {
    this.draft = draft;
    this.rows = [];
    this.body = h("tbody");
    this.why = h("p", { class: "soft", hidden: true });
    this.place = h("section", { class: "near", "aria-label": "Distances" }, h("h2", {}, "Distances now"), this.why,
      h("table", {}, h("thead", {}, h("tr", {}, h("th", {}, "Between"), h("th", {}, "mm"), h("th", {}, "Margin"))), this.body));
    this.ask();
  }

  async ask() {
    let wait = EACH;
    if (!document.hidden) {
      try {
        const draft = this.draft.told?.cell && this.draft.message();
        this.show(await post("/api/workspace/distances", draft?.entries ? { draft: { known: draft.known, entries: draft.entries } } : {}));
      } catch (refused) {
        this.show({ pairs: [], what: refused.message });
        wait = AGAIN;
      }
    }
    if (!this.closed) this.waiting = setTimeout(() => this.ask(), wait);
  }

  show({ pairs, what }) {
    if (this.closed) return;
    text(this.why, what);
    this.why.hidden = !what;
    while (this.rows.length < pairs.length) {
      const cells = [h("td"), h("td"), h("td")];
      this.rows.push({ cells, row: h("tr", {}, cells) });
    }
    put(this.body, this.rows.slice(0, pairs.length).map(({ row }) => row));
    pairs.forEach((one, number) => {
      const { cells, row } = this.rows[number];
      text(cells[0], `${one.first} – ${one.second}`);
      text(cells[1], one.distance.toFixed(1));
      text(cells[2], one.margin.toFixed(0));
      row.dataset.bad = String(one.distance <= one.margin);
    });
    this.draw(pairs.filter(({ points }) => points.length === 6));
  }

  // Draw lines between the nearest points in the scene.
  draw(pairs) {
    if (!this.scene || this.scene.closed) return;
    if (!this.line) {
      this.line = new LineSegments(new BufferGeometry(), new LineBasicMaterial({ color: 0xff2d95, depthTest: false, transparent: true }));
      this.line.renderOrder = 9;
      this.line.frustumCulled = false;
      this.scene.painter.scene.add(this.line);
    }
    const points = new Float32Array(pairs.slice(0, 3).flatMap((one) => one.points));
    this.line.geometry.setAttribute("position", new BufferAttribute(points, 3));
    this.scene.invalidate();
  }

  close() {
    this.closed = true;
    clearTimeout(this.waiting);
    this.line?.removeFromParent();
    this.line?.geometry.dispose();
    this.line?.material.dispose();
  }
}
