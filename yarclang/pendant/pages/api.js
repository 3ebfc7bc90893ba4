// Requests to the API of this server (/api/docs). The pages reach the robot only through this module.

export class Refused extends Error {
  constructor(status, told) {
    super(told.help ? `${told.error}: ${told.help}` : told.error);
    this.status = status;
    this.code = told.code ?? "";
    this.told = told;
  }
}

// The last heartbeat of the server. Orders name it, so that the server doesn't carry them out if they were delayed on
// their way.
let beat = 0;

export async function call(method, path, body, headers = {}) {
  let answer;
  try {
    answer = await fetch(path, {
      method,
      credentials: "same-origin",
      headers: body === undefined ? headers : { "content-type": "application/json", ...headers },
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
export const order = (word, fields = {}) => call("POST", `/api/orders/${word}`, fields, beat ? { "x-yarc-beat": String(beat) } : {});

// Longest silence of the server, after which the connection counts as lost [ms]. The server sends a message twice a
// second.
const SILENCE = 1300;
const AGAIN = 700;

export function address(path) {
  return `${location.protocol === "https:" ? "wss" : "ws"}://${location.host}${path}`;
}

// The WebSocket with the robot's state. Dispatches an event for each message, named after the message's kind; `lost`
// and `found` when the connection is lost and restored; and `back` on a restored connection.
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
      if (told.beat) beat = told.beat;
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

  // Order a stop at once: through the WebSocket, and by HTTP if the connection is lost.
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
