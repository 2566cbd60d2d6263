// Appended to a page by browser.cmake, which shows it in a frame as wide as a screen: what a reader would miss.
'use strict';
const wrong = [];
const wide = document.documentElement.scrollWidth;
if (wide > window.innerWidth) {
  wrong.push(`the page is ${wide} wide in a window of ${window.innerWidth}`);
  for (const e of document.body.querySelectorAll('*'))
    if (e.getBoundingClientRect().right > window.innerWidth + 1 && !e.closest('.scroll, .formula, svg'))
      wrong.push(`beyond the edge: ${e.outerHTML.slice(0, 90)}`);
}
const shown = e => { const r = e.getBoundingClientRect(); return r.width > 100 && r.height > 100; };
for (const figure of document.querySelectorAll('figure')) {
  const panels = [...figure.querySelectorAll('.panel')];
  if (!panels.length) wrong.push(`no panel in ${figure.id}`);
  for (const panel of panels)
    if ([...panel.querySelectorAll('svg')].filter(shown).length !== 1)
      wrong.push(`not one drawing is seen in a panel of ${figure.id}`);
  // Text of 13 units: what is it on this screen?
  for (const svg of [...figure.querySelectorAll('.panel svg')].filter(shown)) {
    const scale = svg.getBoundingClientRect().width / svg.viewBox.baseVal.width;
    if (12 * scale < 8.5) wrong.push(`text of ${(12 * scale).toFixed(1)} pixels in ${figure.id}`);
  }
}
for (const box of document.querySelectorAll('.formula')) {
  if (!box.textContent.trim()) wrong.push('an empty formula');
  if (box.querySelector('merror')) wrong.push(`not typeset: ${box.textContent}`);
}
for (const image of document.images) if (!image.complete || !image.naturalWidth)
  wrong.push(`a broken image: ${image.src}`);
// A click on a legend hides its series in every panel, a second one shows it again. What is hidden at first a button
// shows.
for (const rest of document.querySelectorAll('.legend button')) {
  if (!rest.closest('figure').querySelector('g.s.off')) wrong.push('a button for what is hidden, and nothing is');
  rest.click();
  if (rest.closest('figure').querySelector('g.s.off')) wrong.push(`${rest.textContent}: something is still hidden`);
}
// A tap says what the pointer would.
const mark = [...document.querySelectorAll('.panel g.s path title')].find(title => {
  const box = title.parentElement.getBoundingClientRect();
  return box.width > 0 && box.width < 20;
});
if (mark) {
  const box = mark.parentElement.getBoundingClientRect();
  mark.parentElement.dispatchEvent(new PointerEvent('pointerup', {
    pointerType: 'touch', bubbles: true, clientX: box.x + box.width / 2, clientY: box.y + box.height / 2 }));
  const tip = document.querySelector('.tip');
  if (tip.hidden || tip.textContent !== mark.textContent) wrong.push(`a tap says "${tip.textContent}"`);
  document.body.dispatchEvent(new PointerEvent('pointerup', { pointerType: 'touch', bubbles: true }));
  if (!tip.hidden) wrong.push('a tap elsewhere leaves the tip');
}
for (const key of document.querySelectorAll('.legend span[data-s]')) {
  if (key.parentElement.querySelectorAll('span[data-s]').length < 2) continue;
  const mine = [...key.closest('figure').querySelectorAll(`g.s[data-s="${key.dataset.s}"]`)];
  const hidden = () => mine.filter(g => getComputedStyle(g).display === 'none').length;
  key.click();
  if (hidden() !== mine.length) wrong.push(`a click on ${key.textContent} does not hide it`);
  key.click();
  if (hidden()) wrong.push(`a second click on ${key.textContent} does not show it`);
  if (!mine.length) wrong.push(`nothing is drawn of ${key.textContent} in ${key.closest('figure').id}`);
}
const seen = `width ${window.innerWidth}, figures ${document.querySelectorAll('figure').length}, formulas ${
  document.querySelectorAll('.formula').length}, typeset ${document.querySelectorAll('.formula math').length}`;
window.parent.postMessage({ wrong: wrong.join(' | '), seen }, '*');
