/** Runs an action of the operator and shows a refusal as a notice. */

import { RequestError, api } from "./api";
import { h } from "./dom";
import { t } from "./i18n";

const notices = h("div", { class: "notices", role: "status", "aria-live": "polite" });
const SHOWN_MS = 6_000;
const ESTOP_TRIES = 4;

export function noticeBoard(): HTMLElement {
  return notices;
}

export function notify(text: string): void {
  const notice = h("p", { class: "notice" }, text);
  notices.append(notice);
  while (notices.childElementCount > 3) notices.firstElementChild?.remove();
  window.setTimeout(() => notice.remove(), SHOWN_MS);
}

export async function act(action: Promise<unknown>): Promise<boolean> {
  try {
    await action;
    return true;
  } catch (error) {
    if (!(error instanceof RequestError)) throw error;
    notify(error.status === 0 ? t("notice.unreachable", { detail: error.message }) : t("notice.refused", { detail: error.message }));
    return false;
  }
}

/** Told on the window when the emergency stop is asked for. */
export const EMERGENCY_STOP = "emergencystop";

/** The emergency stop is tried again when it fails; the operator hears of every failure. Whether it was accepted. */
export async function emergencyStop(): Promise<boolean> {
  window.dispatchEvent(new Event(EMERGENCY_STOP));
  for (let i = 0; i < ESTOP_TRIES; i++) if (await act(api.estop())) return true;
  return false;
}
