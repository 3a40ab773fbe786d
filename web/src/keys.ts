/** Keyboard shortcuts. The space bar is the emergency stop wherever the focus is. */

export type Shortcuts = Readonly<Record<string, () => void>>;

export function listen(stop: () => void, shortcuts: Shortcuts): void {
  window.addEventListener(
    "keydown",
    (event) => {
      if (event.code === "Space") {
        event.preventDefault();
        event.stopPropagation();
        if (!event.repeat) stop();
        return;
      }
      if (event.ctrlKey || event.metaKey || event.altKey) return;
      const target = event.target as HTMLElement;
      if (target.matches("textarea, input:not([type=range], [type=checkbox])")) return; // letters belong there
      const arrows = event.key.startsWith("Arrow");
      if (arrows && target.matches("input, select, .events")) return;
      const key = event.shiftKey && event.key.length === 1 ? `Shift+${event.key.toUpperCase()}` : event.key.toLowerCase();
      const action = shortcuts[key] ?? shortcuts[event.key];
      if (!action || event.repeat) return;
      event.preventDefault();
      action();
    },
    { capture: true },
  );
  // A focused button would take the space bar's release as a click.
  window.addEventListener("keyup", (event) => event.code === "Space" && event.preventDefault(), { capture: true });
}
