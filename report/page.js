// A table or a listing says when there is more of it to the right. The legend hides and shows series: a click one,
// a double click all others; under the pointer it stands out. Everything is drawn without this.
'use strict';
for (const box of document.querySelectorAll('.scroll, pre')) {
  const look = () => box.classList.toggle('more', box.scrollLeft + box.clientWidth < box.scrollWidth - 2);
  box.addEventListener('scroll', look, { passive: true });
  new ResizeObserver(look).observe(box);
  look();
}
for (const figure of document.querySelectorAll('figure')) {
  const keys = [...figure.querySelectorAll('.legend span[data-s]')];
  if (keys.length < 2) continue;
  const hidden = new Set();
  const show = () => {
    for (const key of keys) {
      key.classList.toggle('off', hidden.has(key.dataset.s));
      key.setAttribute('aria-pressed', String(!hidden.has(key.dataset.s)));
    }
    for (const g of figure.querySelectorAll('g.s')) g.classList.toggle('off', hidden.has(g.dataset.s));
  };
  const toggle = s => { if (!hidden.delete(s)) hidden.add(s); show(); };
  for (const key of keys) {
    const s = key.dataset.s;
    key.tabIndex = 0;
    key.setAttribute('role', 'button');
    key.setAttribute('aria-pressed', 'true');
    key.title = 'click: hide or show; double click: this one alone, or all';
    key.onclick = event => { if (event.detail < 2) toggle(s); };
    for (const [event, on] of [['pointerenter', true], ['pointerleave', false]])
      key.addEventListener(event, () => {
        for (const g of figure.querySelectorAll('g.s')) g.classList.toggle('other', on && g.dataset.s !== s);
      });
    key.onkeydown = event => { if (event.key === 'Enter' || event.key === ' ') { event.preventDefault(); toggle(s); } };
    key.ondblclick = () => {
      const alone = keys.every(k => k.dataset.s === s || hidden.has(k.dataset.s));
      hidden.clear();
      if (!alone) for (const k of keys) if (k.dataset.s !== s) hidden.add(k.dataset.s);
      show();
    };
  }
}
