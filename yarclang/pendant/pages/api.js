// The only way from the pages to the robot: the API of this server (/api/docs).

export class Refused extends Error {
  constructor(status, told) {
    super(told.help ? `${told.error}: ${told.help}` : told.error);
    this.status = status;
    this.code = told.code ?? "";
    this.told = told;
  }
}

export async function call(method, path, body) {
  let answer;
  try {
    answer = await fetch(path, {
      method,
      credentials: "same-origin",
      headers: body === undefined ? {} : { "content-type": "application/json" },
      body: body === undefined ? undefined : JSON.stringify(body),
    });
  } catch {
    throw new Refused(0, { error: "the pendant's server can't be reached" });
  }
  const told = await answer.json().catch(() => ({ error: `the server answers ${answer.status}` }));
  if (!answer.ok) {
    const refused = new Refused(answer.status, told);
    if (answer.status === 401) document.dispatchEvent(new CustomEvent("loggedout", { detail: told }));
    throw refused;
  }
  return told;
}

export const get = (path) => call("GET", path);
export const post = (path, body = {}) => call("POST", path, body);
export const remove = (path) => call("DELETE", path);
export const order = (word, fields = {}) => post(`/api/orders/${word}`, fields);

// Silence after which the connection counts as lost [ms]: the server says something twice a second.
const SILENCE = 1300;
const AGAIN = 700;

export function address(path) {
  return `${location.protocol === "https:" ? "wss" : "ws"}://${location.host}${path}`;
}

// The socket of what the robot does. Tells each message by its name, and `lost`, `found`, and `back` when it was lost before.
export class Robot extends EventTarget {
  constructor() {
    super();
    this.display = null;
    this.connected = false;
    this.closed = false;
    this.heard = 0;
    this.open();
    this.watching = setInterval(() => this.watch(), 250);
  }

  open() {
    this.socket = new WebSocket(address("/api/robot"));
    const mine = this.socket;
    mine.onmessage = (event) => {
      if (mine !== this.socket) return;
      this.heard = performance.now();
      if (!this.connected) {
        this.connected = true;
        this.dispatchEvent(new Event("found"));
        if (this.wasLost) this.dispatchEvent(new Event("back"));
      }
      const told = JSON.parse(event.data);
      if (told.event === "display") this.display = told;
      this.dispatchEvent(new CustomEvent(told.event ?? (told.beat ? "beat" : "answer"), { detail: told }));
    };
    mine.onclose = (event) => {
      if (mine !== this.socket || this.closed) return;
      this.lose();
      if (event.code === 4401) document.dispatchEvent(new CustomEvent("loggedout", { detail: { error: event.reason } }));
      else setTimeout(() => !this.closed && mine === this.socket && this.open(), AGAIN);
    };
  }

  watch() {
    if (this.connected && performance.now() - this.heard > SILENCE) {
      this.lose();
      const old = this.socket;
      this.open();
      old.close();
    }
  }

  lose() {
    if (!this.connected) return;
    this.connected = false;
    this.wasLost = true;
    this.dispatchEvent(new Event("lost"));
  }

  // At once, by whatever way is open.
  stop() {
    if (this.socket.readyState === WebSocket.OPEN) this.socket.send('{"order": "stop"}');
    if (!this.connected) fetch("/api/orders/stop", { method: "POST", body: "{}", keepalive: true }).catch(() => {});
  }

  close() {
    this.closed = true;
    clearInterval(this.watching);
    this.socket.close();
  }
}

export function jogSocket() {
  return new WebSocket(address("/api/jog"));
}
