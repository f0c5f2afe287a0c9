// The connection to the server: opens again by itself, asks again for what was wanted, keeps the server's clock.

import { ServerClock } from "./clock.js";
import { decode } from "./wire.js";

const FIRST_PAUSE_MS = 500;
const LONGEST_PAUSE_MS = 5000;
const PING_MS = 2000;
/** Without an answer for so long the connection is taken for dead. */
const SILENCE_MS = 8000;

export class Link {
  /**
   * @param {string} address of the WebSocket
   * @param {(message: object, arrived_ms: number) => void} onMessage
   * @param {(state: "connecting"|"open"|"lost", text: string) => void} onState
   */
  constructor(address, onMessage, onState) {
    this.address = address;
    this.onMessage = onMessage;
    this.onState = onState;
    this.clock = new ServerClock();
    /** What is asked for again after a break, by key. */
    this.standing = new Map();
    this.pause_ms = FIRST_PAUSE_MS;
    this.bad = 0;
    setInterval(() => this.#ping(), PING_MS);
    this.#open();
  }

  /** Sends now if it can; `want` and `follow` hold until they are sent anew, also after a break. */
  send(message) {
    for (const key of ["want", "follow"]) {
      if (key in message) this.standing.set(key, message[key]);
    }
    if (this.isOpen()) this.socket.send(JSON.stringify(message));
  }

  isOpen() {
    return this.socket?.readyState === WebSocket.OPEN;
  }

  #open() {
    this.onState("connecting", "");
    const socket = new WebSocket(this.address);
    this.socket = socket;
    socket.binaryType = "arraybuffer";
    socket.onopen = () => {
      this.clock.forget();
      this.answered = performance.now();
      for (const [key, value] of this.standing) this.send({ [key]: value });
      this.#ping();
    };
    socket.onmessage = ({ data }) => this.#receive(data);
    socket.onclose = () => {
      if (socket === this.socket) this.#again();
    };
  }

  #receive(data) {
    const arrived = performance.now();
    let message;
    try {
      message = decode(data);
    } catch (error) {
      this.bad += 1;
      if (this.bad === 1) console.warn(`message skipped: ${error.message}`);
      return;
    }
    if (message.type === "pong") {
      this.answered = arrived;
      this.clock.note(message.ping, arrived, message.server_us);
      return;
    }
    if (message.type === "hello") {
      this.pause_ms = FIRST_PAUSE_MS;
      this.onState("open", "");
    }
    this.onMessage(message, arrived);
  }

  #again() {
    // Some jitter: the pages of a restarted server do not come back all at once.
    const pause = this.pause_ms * (0.75 + 0.5 * Math.random());
    this.pause_ms = Math.min(2 * this.pause_ms, LONGEST_PAUSE_MS);
    this.onState("lost", `trying again in ${Math.max(1, Math.round(pause / 1000))} s`);
    setTimeout(() => this.#open(), pause);
  }

  #ping() {
    if (!this.isOpen()) return;
    if (performance.now() - this.answered > SILENCE_MS) {
      const dead = this.socket;
      this.socket = null;
      dead.close();
      this.#again();
      return;
    }
    this.socket.send(JSON.stringify({ ping: performance.now() }));
  }
}
