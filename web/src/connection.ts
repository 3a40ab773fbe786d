/** The websocket to the server: decodes messages, reconnects by itself, reports when what is shown is old. */

import type { ClientMessage, ServerMessage } from "./wire";

export type Link = "connecting" | "open" | "stale" | "lost";

export interface Handlers {
  message(message: ServerMessage): void;
  image(kind: number, jpeg: Blob): void;
  link(link: Link): void;
}

const STALE_AFTER_MS = 1_500;
const GIVE_UP_AFTER_MS = 6_000;
const FIRST_RETRY_MS = 250;
const LONGEST_RETRY_MS = 3_000;
const HEADER_BYTES = 16;

export class Connection {
  private socket: WebSocket | null = null;
  private link: Link = "connecting";
  private heard_ms = 0;
  private retry_ms = FIRST_RETRY_MS;

  constructor(
    private readonly url: string,
    private readonly handlers: Handlers,
  ) {
    window.setInterval(() => this.watch(), 500);
  }

  open(): void {
    const socket = new WebSocket(this.url);
    socket.binaryType = "arraybuffer";
    this.socket = socket;
    this.heard_ms = performance.now();
    socket.onmessage = (event: MessageEvent<string | ArrayBuffer>) => {
      if (socket === this.socket) this.receive(event.data);
    };
    socket.onclose = () => {
      if (socket === this.socket) this.retry();
    };
  }

  send(message: ClientMessage): void {
    if (this.socket?.readyState === WebSocket.OPEN) this.socket.send(JSON.stringify(message));
  }

  private receive(data: string | ArrayBuffer): void {
    this.heard_ms = performance.now();
    this.retry_ms = FIRST_RETRY_MS;
    if (typeof data === "string") {
      this.handlers.message(JSON.parse(data) as ServerMessage);
      this.report("open");
      return;
    }
    if (data.byteLength <= HEADER_BYTES) return;
    const header = new Uint8Array(data, 0, HEADER_BYTES);
    if (header[0] !== 0x47 || header[1] !== 0x54) return; // "GT"
    this.handlers.image(header[2] ?? 0, new Blob([new Uint8Array(data, HEADER_BYTES)], { type: "image/jpeg" }));
  }

  /** A connection that is open but silent is as good as lost: the picture is old. */
  private watch(): void {
    if (this.link === "lost" || !this.socket || document.hidden) return;
    const silent_ms = performance.now() - this.heard_ms;
    if (silent_ms > GIVE_UP_AFTER_MS) this.retry();
    else if (silent_ms > STALE_AFTER_MS && this.link === "open") this.report("stale");
  }

  private retry(): void {
    const old = this.socket;
    this.socket = null;
    old?.close();
    this.report("lost");
    window.setTimeout(() => this.open(), this.retry_ms);
    this.retry_ms = Math.min(this.retry_ms * 2, LONGEST_RETRY_MS);
  }

  private report(link: Link): void {
    if (link === this.link) return;
    this.link = link;
    this.handlers.link(link);
  }
}
