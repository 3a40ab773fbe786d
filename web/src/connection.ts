/** The websocket to the server: decodes messages, reconnects and resumes by itself, reports when what is shown is old. */

import { clientKey } from "./client";
import type { ClientMessage, ServerMessage } from "./wire";

/** locked: the server wants a token first. */
export type Link = "connecting" | "open" | "stale" | "lost" | "locked";

export interface Handlers {
  /** received_ms: when the message came, by performance.now(). */
  message(message: ServerMessage, received_ms: number): void;
  image(kind: number, picture: Blob): void;
  link(link: Link): void;
}

const STALE_AFTER_MS = 1_500;
const GIVE_UP_AFTER_MS = 6_000;
const FIRST_RETRY_MS = 250;
const LONGEST_RETRY_MS = 3_000;
const HEADER_BYTES = 16;
const NO_CREDENTIAL = 4401;

export class Connection {
  private socket: WebSocket | null = null;
  private link: Link = "connecting";
  private heard_ms = 0;
  private retry_ms = FIRST_RETRY_MS;
  /** What was seen last; the server then tells only what was missed. */
  private boot = "";
  private event_id = 0;

  constructor(
    private readonly url: string,
    private readonly handlers: Handlers,
  ) {
    window.setInterval(() => this.watch(), 500);
  }

  open(): void {
    const address = new URL(this.url);
    address.searchParams.set("client", clientKey);
    if (this.boot && this.event_id > 0) {
      address.searchParams.set("boot", this.boot);
      address.searchParams.set("after", String(this.event_id));
    }
    const socket = new WebSocket(address);
    socket.binaryType = "arraybuffer";
    this.socket = socket;
    this.heard_ms = performance.now();
    socket.onmessage = (event: MessageEvent<string | ArrayBuffer>) => {
      if (socket === this.socket) this.receive(event.data);
    };
    socket.onclose = (event) => {
      if (socket !== this.socket) return;
      if (event.code === NO_CREDENTIAL) this.lock();
      else this.retry();
    };
  }

  /** Connects anew with what the browser has to show now (after a login or logout). */
  reopen(): void {
    const old = this.socket;
    this.socket = null;
    old?.close();
    this.report("connecting");
    this.open();
  }

  send(message: ClientMessage): void {
    if (this.socket?.readyState === WebSocket.OPEN) this.socket.send(JSON.stringify(message));
  }

  private receive(data: string | ArrayBuffer): void {
    const now_ms = performance.now();
    this.heard_ms = now_ms;
    this.retry_ms = FIRST_RETRY_MS;
    if (typeof data === "string") {
      const message = JSON.parse(data) as ServerMessage;
      if (message.type === "hello") this.greet(message.boot);
      if (message.type === "event") this.event_id = Math.max(this.event_id, message.id);
      this.handlers.message(message, now_ms);
      this.report("open");
      return;
    }
    if (data.byteLength <= HEADER_BYTES) return;
    const header = new Uint8Array(data, 0, HEADER_BYTES);
    if (header[0] !== 0x47 || header[1] !== 0x54) return; // "GT"
    this.handlers.image(header[2] ?? 0, new Blob([new Uint8Array(data, HEADER_BYTES)]));
  }

  private greet(boot: string): void {
    if (boot !== this.boot) this.event_id = 0; // the server counts anew
    this.boot = boot;
  }

  /** A connection that is open but silent is as good as lost: the picture is old. */
  private watch(): void {
    if (this.link === "lost" || this.link === "locked" || !this.socket || document.hidden) return;
    const silent_ms = performance.now() - this.heard_ms;
    if (silent_ms > GIVE_UP_AFTER_MS) this.retry();
    else if (silent_ms > STALE_AFTER_MS && this.link === "open") this.report("stale");
  }

  private lock(): void {
    this.socket = null;
    this.report("locked");
  }

  private retry(): void {
    const old = this.socket;
    this.socket = null;
    old?.close();
    this.report("lost");
    window.setTimeout(() => {
      if (!this.socket && this.link !== "locked") this.open();
    }, this.retry_ms);
    this.retry_ms = Math.min(this.retry_ms * 2, LONGEST_RETRY_MS);
  }

  private report(link: Link): void {
    if (link === this.link) return;
    this.link = link;
    this.handlers.link(link);
  }
}
