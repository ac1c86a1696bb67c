"use strict";
// A table wider than its window shows a hint, and on which side it continues.
(() => {
  function look(one) {
    const beyond = one.scrollWidth - one.clientWidth;
    const [left, right] = [one.scrollLeft > 1, one.scrollLeft < beyond - 1];
    one.parentElement.classList.toggle("more-left", left);
    one.parentElement.classList.toggle("more-right", right);
    one.parentElement.querySelector(".hint").hidden = beyond <= 1;
  }

  const changed = new ResizeObserver((seen) => seen.forEach(({ target }) => look(target.closest(".scroll"))));
  document.querySelectorAll(".scroll").forEach((one) => {
    changed.observe(one);
    changed.observe(one.firstElementChild);
    one.addEventListener("scroll", () => look(one), { passive: true });
  });
})();
