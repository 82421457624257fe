// Chooses the flight point shown, and shows what a mark on a plot stands for.
(function () {
  "use strict";
  document.documentElement.classList.add("scripted");
  const buttons = [...document.querySelectorAll("[data-point]")];
  function choose(index) {
    buttons.forEach((b) => b.setAttribute("aria-pressed", b.dataset.point === String(index)));
    document.querySelectorAll("[data-for-point]").forEach((e) => e.classList.toggle("chosen", e.dataset.forPoint === String(index)));
    const button = buttons.find((b) => b.dataset.point === String(index));
    if (button) document.dispatchEvent(new CustomEvent("flightpoint", { detail: { index, name: button.dataset.name } }));
  }
  buttons.forEach((b) => b.addEventListener("click", () => choose(b.dataset.point)));
  choose(0);
  const tip = document.getElementById("tip");
  function place(event) {
    if (event.target.nodeName === "CANVAS") return; // the viewer has its own
    const mark = event.target.closest && event.target.closest("[data-tip]");
    tip.hidden = !mark;
    if (!mark) return;
    tip.textContent = mark.dataset.tip;
    const box = mark.getBoundingClientRect();
    tip.style.left = `${Math.min(box.right + 10, innerWidth - tip.offsetWidth - 10) + scrollX}px`;
    tip.style.top = `${box.top + scrollY - 6}px`;
  }
  document.addEventListener("pointerover", place);
  document.addEventListener("focusin", place);
  const links = [...document.querySelectorAll("nav a")];
  const seen = new IntersectionObserver((entries) => entries.forEach((entry) => {
    if (entry.isIntersecting) links.forEach((a) => a.classList.toggle("here", a.hash === `#${entry.target.id}`));
  }), { rootMargin: "-20% 0px -70% 0px" });
  document.querySelectorAll("main > section[id]").forEach((s) => seen.observe(s));
  const scheme = document.getElementById("scheme");
  scheme.addEventListener("click", () => {
    const dark = getComputedStyle(document.documentElement).getPropertyValue("--is-dark").trim() === "1";
    document.documentElement.dataset.scheme = dark ? "light" : "dark";
  });
})();
