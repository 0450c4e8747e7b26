// Keyboard shortcuts and reports about the browser window. The frame of the scene forwards its key presses.
(() => {
  const HANDLED = new Set(["/", "?", "u", "f", "Delete", "Home", "Escape"]);
  const isWriting = (element) =>
    element && (element.isContentEditable || /^(INPUT|TEXTAREA|SELECT)$/.test(element.tagName));

  // Arrow keys move the selection, except in elements that use them.
  const hasSelection = () => Boolean(document.querySelector(".semmap-marks")?.dataset.selected);
  const takesArrows = (element) => !(element === document.body || element.matches(".q-layout, #views")
    || (element.matches("button, a") && !element.closest("[role=tablist], [role=radiogroup], .q-btn-toggle")));

  function onArrow(event) {
    if (takesArrows(event.target) || !hasSelection() || document.querySelector(".q-dialog, .q-menu")) return;
    event.preventDefault();
    emitEvent("semmap_key", { key: `${event.shiftKey ? "Shift+" : ""}${event.key}` });
  }

  function onKey(event) {
    if (event.key.startsWith("Arrow") && !(event.ctrlKey || event.altKey || event.metaKey)) return onArrow(event);
    if (event.ctrlKey || event.altKey || event.metaKey || !HANDLED.has(event.key)) return;
    const element = event.target;
    if (isWriting(element)) {
      if (event.key === "Escape") element.blur();
      return;
    }
    if (document.querySelector(".q-dialog")) return; // a dialog handles its own keys
    if (event.key === "/") {
      const search = document.querySelector(".semmap-search input");
      if (search) { event.preventDefault(); window.focus(); search.focus(); search.select(); }
      return;
    }
    if (event.key !== "Escape") event.preventDefault();
    emitEvent("semmap_key", { key: event.key });
  }

  // The table of entities is one tab stop: arrow keys move within it, and Tab leaves it.
  const FOCUSED = "a[href], button, input, select, textarea, iframe, [tabindex]";

  function leaveTable(event) {
    const table = event.key === "Tab" && event.target.closest?.(".entity-table");
    if (!table) return;
    const side = event.shiftKey ? Node.DOCUMENT_POSITION_PRECEDING : Node.DOCUMENT_POSITION_FOLLOWING;
    const candidates = [...document.querySelectorAll(FOCUSED)].filter((element) =>
      element.tabIndex >= 0 && !element.disabled && element.checkVisibility() && !table.contains(element)
      && table.compareDocumentPosition(element) & side);
    const next = event.shiftKey ? candidates.at(-1) : candidates[0];
    if (next) { event.preventDefault(); event.stopPropagation(); next.focus(); }
  }

  // Click a pressed element even if an update moved it away from the pointer before the release. The browser itself
  // would not send a click then.
  const CLICKABLE = "button, [role=button], [role=tab], .q-chip--clickable, .q-item--clickable";
  const STILL_PX = 5;
  let pressed = null;

  function onPress(event) {
    const element = event.button === 0 ? event.target.closest?.(CLICKABLE) : null;
    pressed = element && { element, x: event.clientX, y: event.clientY };
  }

  function onRelease(event) {
    const { element, x, y } = pressed ?? {};
    pressed = null;
    if (!element || element.contains(event.target) || !element.isConnected || !element.checkVisibility()) return;
    if (Math.hypot(event.clientX - x, event.clientY - y) < STILL_PX) element.click();
  }

  // Quasar adds the options of a list with the next frame. If this frame is late, for example without a GPU, the
  // list is not placed again and remains hidden. Quasar also places lists when the window scrolls.
  function placeLists() {
    requestAnimationFrame(() => requestAnimationFrame(() => window.dispatchEvent(new Event("scroll"))));
  }

  // Attributes for what the libraries draw without them: the attribute, the selector, the value.
  const LABELS = [
    ["aria-label", ".q-drawer--left", "Lists"],
    ["aria-label", ".q-drawer--right", "Details"],
    ["aria-label", ".sparql-editor .cm-content", "SPARQL query"],
    ["aria-label", ".q-loading-bar", "Loading"],
    ["aria-label", ".q-uploader a.q-btn", "Choose a file"],
    ["aria-label", ".q-uploader__input", "Choose a file"],
    ["aria-label", ".q-table thead .q-checkbox", "Select all rows"],
    ["aria-label", ".q-table tbody .q-checkbox", "Select the row"],
    ["alt", ".semmap-plan img", ""],
    ["tabindex", ".q-table__middle.scroll", "0"], // scrolled with the keyboard
  ];

  function addLabels() {
    for (const [attribute, selector, text] of LABELS)
      for (const element of document.querySelectorAll(`${selector}:not([${attribute}])`))
        element.setAttribute(attribute, text);
  }

  let labelling = 0;
  function addLabelsSoon() {
    if (!labelling) labelling = setTimeout(() => { labelling = 0; addLabels(); }, 100);
  }

  function reportAppearance() {
    emitEvent("semmap_appearance", {
      dark: document.body.classList.contains("body--dark"),
      narrow: window.innerWidth <= 960,
      width: window.innerWidth,
    });
  }

  // Notices are above the timeline, which has two rows in a narrow window.
  function reportTimeline() {
    const timeline = document.querySelector(".semmap-time");
    const set = () => document.documentElement.style.setProperty("--timeline", `${timeline.offsetHeight}px`);
    new ResizeObserver(set).observe(timeline);
  }

  let resized = 0;
  function onResize() {
    clearTimeout(resized);
    resized = setTimeout(reportAppearance, 100);
  }

  // The grips at the edges of the lists and of the details change their widths; a double click resets them.
  const GRIP_STEP_PX = 20;
  let gripped = null;

  function setWidth(grip, px) {
    emitEvent("semmap_width", { side: grip.dataset.side, px });
  }

  function onGripPress(event) {
    gripped = event.target.closest?.(".semmap-grip");
    if (!gripped) return;
    event.preventDefault();
    gripped.setPointerCapture(event.pointerId);
    document.body.classList.add("semmap-gripping"); // the frame of the scene would take the pointer
  }

  function onGripMove(event) {
    if (!gripped) return;
    const x = Math.round(event.clientX);
    setWidth(gripped, gripped.dataset.side === "left" ? x : window.innerWidth - x);
  }

  function onGripRelease() {
    gripped = null;
    document.body.classList.remove("semmap-gripping");
  }

  function onGripKey(event) {
    const grip = event.target.closest?.(".semmap-grip");
    const by = { ArrowLeft: -GRIP_STEP_PX, ArrowRight: GRIP_STEP_PX }[event.key];
    if (!grip || !by) return;
    const sign = grip.dataset.side === "left" ? 1 : -1;
    setWidth(grip, Number(grip.getAttribute("aria-valuenow")) + sign * by);
  }

  // The scene is drawn on the same thread as the rest. It starts when the first rows of the table are painted and the
  // browser is idle, or after a timeout.
  let hasBegun = false;
  window.semmapBeginScene = () => {
    if (hasBegun) return;
    hasBegun = true;
    const begin = () => emitEvent("semmap_scene");
    const whenIdle = window.requestIdleCallback ?? ((call) => setTimeout(call, 100));
    requestAnimationFrame(() => requestAnimationFrame(() => whenIdle(begin, { timeout: 1000 })));
  };

  // For programs that drive this browser: resolves when all earlier input has been processed and its result is shown.
  const settling = new Map();
  let settles = 0;
  window.semmapSettled = () => new Promise((settled) => {
    const number = ++settles;
    settling.set(number, settled);
    emitEvent("semmap_settle", { number });
  });
  window.semmapIsSettled = (number) => {
    settling.get(number)?.();
    settling.delete(number);
  };

  document.addEventListener("keydown", onKey);
  document.addEventListener("pointerdown", onPress, true);
  document.addEventListener("pointerup", onRelease, true);
  document.addEventListener("pointercancel", () => { pressed = null; }, true);
  document.addEventListener("keydown", leaveTable, true);
  document.addEventListener("pointerdown", onGripPress);
  document.addEventListener("pointermove", onGripMove);
  document.addEventListener("pointerup", onGripRelease);
  document.addEventListener("pointercancel", onGripRelease);
  document.addEventListener("keydown", onGripKey);
  document.addEventListener("dblclick", (event) => {
    const grip = event.target.closest?.(".semmap-grip");
    if (grip) setWidth(grip, 0);
  });
  window.semmapStart = () => {
    new MutationObserver(reportAppearance).observe(document.body, { attributeFilter: ["class"] });
    new MutationObserver(placeLists) // NiceGUI sets a class while a list is open
      .observe(document.documentElement, { attributeFilter: ["class"] });
    new MutationObserver(addLabelsSoon).observe(document.body, { childList: true, subtree: true });
    window.addEventListener("resize", onResize);
    reportTimeline();
    addLabels();
    reportAppearance();
    setTimeout(semmapBeginScene, 5000);
  };
})();
