// A table or a listing says when there is more of it to the right. The legend hides and shows series: a click one,
// a double click all others; under the pointer it stands out, and a tap shows what the pointer would. Everything is
// drawn without this.
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
  const later = keys.filter(key => 'later' in key.dataset).map(key => key.dataset.s), hidden = new Set();
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
  if (!later.length) continue;
  const rest = document.createElement('button');
  const few = yes => {
    hidden.clear();
    if (yes) for (const s of later) hidden.add(s);
    for (const key of keys) key.hidden = yes && 'later' in key.dataset;
    rest.textContent = yes ? `show all ${keys.length}` : 'show a few';
    rest.onclick = () => few(!yes);
    show();
  };
  keys[0].parentElement.append(rest);
  few(true);
}
const tip = document.createElement('div');
tip.className = 'tip';
tip.hidden = true;
document.body.append(tip);
document.addEventListener('pointerup', event => {
  if (event.pointerType === 'mouse') return;
  const svg = event.target.closest('.panel svg');
  let said = null, least = 24;  // pixels: a finger is wide
  for (const title of svg ? svg.querySelectorAll('g title') : []) {
    const mark = title.parentElement, box = mark.getBoundingClientRect();
    if (box.width > 40 || box.width === 0) continue;  // a line, or hidden
    const far = Math.hypot(box.x + box.width / 2 - event.clientX, box.y + box.height / 2 - event.clientY);
    if (far < least) [said, least] = [title, far];
  }
  said ??= event.target.querySelector(':scope > title');
  tip.hidden = !svg || !said || said.parentElement === svg;
  const mine = tip.hidden ? null : said.closest('g.s');
  for (const g of document.querySelectorAll('.panel g.s'))
    g.classList.toggle('other', !!mine && g.ownerSVGElement === svg && g.dataset.s !== mine.dataset.s);
  if (tip.hidden) return;
  tip.textContent = said.textContent;
  tip.style.left = `${Math.min(event.pageX, document.documentElement.clientWidth - tip.offsetWidth - 8)}px`;
  tip.style.top = `${event.pageY - tip.offsetHeight - 18}px`;
});
