// A draft: changes of zones, obstacles and joint limits that aren't saved yet. They can be undone.

const MOST_UNDONE = 100;

export class Draft extends EventTarget {
  constructor() {
    super();
    this.items = []; // zones and obstacles: {key, table, at, base, values, gone, metre, radian, ...}
    this.limits = {}; // changed limits by joint: [lower, upper]
    this.past = [];
    this.next = 0;
  }

  // Begin a draft from the content of the files.
  open(told) {
    this.told = told;
    this.items = told.entries.map((entry) => ({ ...entry, key: `k${this.next++}`, base: present(entry.values), values: present(entry.values), gone: false }));
    this.limits = {};
    this.past = [];
    this.tell();
  }

  get size() {
    return this.items.filter((one) => isChanged(one)).length + Object.keys(this.limits).length;
  }

  item(key) {
    return this.items.find((one) => one.key === key && !one.gone);
  }

  tell() {
    this.dispatchEvent(new Event("changed"));
  }

  // Store the present state, so that `undo` can restore it.
  mark() {
    this.past.push(JSON.stringify([this.items, this.limits]));
    if (this.past.length > MOST_UNDONE) this.past.shift();
  }

  undo() {
    if (!this.past.length) return;
    [this.items, this.limits] = JSON.parse(this.past.pop());
    this.tell();
  }

  // Change values of an entry; undefined removes a key. `marked` is true if the state was stored before, as during a
  // drag.
  set(key, values, marked = false) {
    const item = this.item(key);
    if (!item) return;
    if (!marked) this.mark();
    item.values = present({ ...item.values, ...values });
    this.tell();
  }

  add(table, values) {
    this.mark();
    const { told } = this;
    const names = new Set(this.items.filter((one) => !one.gone).map((one) => String(one.values.name).toUpperCase()));
    let name = values.name;
    for (let count = 2; names.has(name.toUpperCase()); count += 1) name = `${values.name}_${count}`;
    const key = `k${this.next++}`;
    const like = { metre: told.metre, radian: told.radian, length_unit: told.length_unit, angle_unit: told.angle_unit, speed_unit: told.length_unit && `${told.length_unit}/s` };
    this.items.push({ ...like, key, table, at: null, base: null, values: { ...values, name }, gone: false });
    this.tell();
    return key;
  }

  copy(key) {
    const { table, values, metre, radian } = this.item(key);
    const made = this.add(table, structuredClone(values));
    Object.assign(this.item(made), { metre, radian });
    return made;
  }

  remove(key) {
    this.mark();
    this.item(key).gone = true;
    this.items = this.items.filter((one) => !(one.gone && one.at === null));
    this.tell();
  }

  limit(joint, pair) {
    this.mark();
    if (pair) this.limits[joint] = pair;
    else delete this.limits[joint];
    this.tell();
  }

  // Return the draft as a message to the server.
  message() {
    const entries = this.items.filter(isChanged).map(({ table, at, values, gone }) => ({ table, at, values: gone ? null : values }));
    const limits = Object.entries(this.limits).map(([joint, [lower, upper]]) => ({ joint, lower, upper }));
    return {
      ...(entries.length ? { known: this.told.known, entries } : {}),
      ...(limits.length ? { robot_known: this.told.robot_known, limits } : {}),
    };
  }
}

export function isChanged(one) {
  return one.gone || one.at === null || JSON.stringify(sorted(one.values)) !== JSON.stringify(sorted(one.base));
}

function sorted(values) {
  return Object.entries(values).sort(([a], [b]) => (a < b ? -1 : 1));
}

function present(values) {
  return Object.fromEntries(Object.entries(values).filter(([, value]) => value !== null && value !== undefined));
}
