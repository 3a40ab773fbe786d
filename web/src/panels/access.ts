/** Who commands the robot, who asks to, and the token that says who somebody is. */

import { act } from "../act";
import { RequestError, api } from "../api";
import type { Link } from "../connection";
import { Text, h } from "../dom";
import { t, titled, translated } from "../i18n";
import { icon } from "../icons";
import { Sheet } from "../sheet";
import type { Access, Party } from "../wire";

/** What this console may do now: command, ask for it, or watch. */
type Standing = "free" | "mine" | "theirs" | "viewer" | "nobody";

function standing(access: Access): Standing {
  if (!access.you) return "nobody";
  if (access.you.role === "viewer") return "viewer";
  if (access.holds_lease) return "mine";
  return access.lease.holder ? "theirs" : "free";
}

export class AccessPanel {
  private readonly text = new Text(h("span", { class: "lease-text" }));
  private readonly ask = h("button", { class: "chip strong", type: "button", hidden: true });
  private readonly take = translated(h("button", { class: "chip strong", type: "button", hidden: true }), "lease.take");
  /** In the banner. */
  readonly element = h("div", { class: "lease", "data-standing": "free" }, this.text.element, this.ask, this.take);
  /** Over the panels while somebody asks the holder for the lease. */
  readonly asks = h("div", { class: "asks", role: "status", "aria-live": "polite" });
  readonly button = titled(h("button", { class: "chip", type: "button" }, icon("person")), "button.access");
  private readonly who = new Text(h("p"));
  private readonly token = h("input", { type: "password", id: "token", autocomplete: "current-password", required: true, spellcheck: false });
  private readonly refusal = h("p", { class: "bad", role: "alert" });
  private readonly logout = translated(h("button", { class: "button", type: "button" }), "access.logout");
  private readonly sheet: Sheet;
  private access: Access | null = null;
  private asked = false;

  constructor(private readonly changed: () => void) {
    const enter = translated(h("button", { class: "button primary", type: "submit" }), "access.login");
    const label = translated(h("label", { for: "token" }), "access.token");
    const form = h("form", { class: "token-form" }, label, this.token, enter);
    this.sheet = new Sheet("panel.access", this.who.element as HTMLElement, form, this.refusal, translated(h("p", { class: "hint" }), "access.hint"), this.logout);
    form.addEventListener("submit", (event) => {
      event.preventDefault();
      void this.login();
    });
    this.logout.addEventListener("click", () => void this.leave());
    this.button.addEventListener("click", () => this.sheet.toggle());
    this.ask.addEventListener("click", () => void act(api.lease(this.access?.holds_lease || this.asked ? "release" : "request")));
    this.take.addEventListener("click", () => void act(api.lease("take")));
  }

  get dialog(): HTMLElement {
    return this.sheet.element;
  }

  /** The server wants a token before it shows anything. */
  link(link: Link): void {
    if (link !== "locked") return;
    this.set({ type: "access", you: null, by_token: false, holds_lease: false, lease: { holder: null, requests: [], since: null } });
    this.sheet.open();
    this.token.focus();
  }

  set(access: Access): void {
    const before = this.access;
    this.access = access;
    const now = standing(access);
    this.asked = access.lease.requests.some((party) => party.id === access.you?.id);
    this.element.dataset["standing"] = now;
    this.text.set(now === "theirs" ? t("lease.theirs", { name: nameOf(access.lease.holder) }) : t(`lease.${now}`));
    this.ask.hidden = now !== "mine" && now !== "theirs";
    translated(this.ask, now === "mine" ? "lease.release" : this.asked ? "lease.withdraw" : "lease.request");
    this.take.hidden = !(now === "theirs" && access.you?.role === "supervisor");
    this.who.set(access.you ? t("access.you", { role: t(`role.${access.you.role}`), name: nameOf(access.you) }) : t("access.none"));
    this.logout.hidden = !access.by_token;
    this.lock(now === "theirs" || now === "viewer" || now === "nobody");
    const mine = now === "mine" ? access.lease.requests : [];
    this.asks.replaceChildren(...mine.map((party) => this.request(party)));
    if (access.you && before && !before.you) this.sheet.close();
  }

  restyle(): void {
    if (this.access) this.set(this.access);
  }

  /** Controls that command are out of reach while another console, or nobody here, may use them. Never the stop. */
  private lock(locked: boolean): void {
    for (const element of document.querySelectorAll<HTMLElement>("[data-commands]")) element.inert = locked;
    document.body.classList.toggle("locked", locked);
  }

  private request(party: Party): HTMLElement {
    const grant = translated(h("button", { class: "button primary", type: "button" }), "lease.grant");
    const deny = translated(h("button", { class: "button", type: "button" }), "lease.deny");
    grant.addEventListener("click", () => void act(api.decide("grant", party.id)));
    deny.addEventListener("click", () => void act(api.decide("deny", party.id)));
    return h("div", { class: "ask" }, h("b", {}, t("lease.asks", { name: nameOf(party) })), grant, deny);
  }

  private async login(): Promise<void> {
    this.refusal.textContent = "";
    try {
      this.set(await api.login(this.token.value.trim()));
    } catch (error) {
      if (!(error instanceof RequestError)) throw error;
      this.refusal.textContent = error.message;
      return;
    }
    this.token.value = "";
    this.sheet.close();
    this.changed();
  }

  private async leave(): Promise<void> {
    if (await act(api.logout())) this.changed();
  }
}

/** What somebody calls themselves, else the beginning of their id. */
function nameOf(party: Party | null): string {
  return party ? party.name || t("access.console", { id: party.id.slice(0, 4) }) : "";
}
