// What the accuracy page adds to the common look, and its little script: which view, which reference, which
// methods, sorting. Without the script the page shows the means against the reference with shadows.
#pragma once

namespace coppice {

inline constexpr const char* k_accuracy_style = R"(
:root { --c0:#1f6fb2; --c1:#c85f12; --c2:#258253; --c3:#8a56a8; --c4:#8f7300; --c5:#c23b5a; --good:#1d7a45;
  --bad:#b3401f }
@media (prefers-color-scheme:dark) { :root { --c0:#62aeea; --c1:#f2964f; --c2:#5cc48b; --c3:#c596d8;
  --c4:#d9bd45; --c5:#f27690;
  --good:#74d39a; --bad:#f19a76 } }
main { max-width:1240px }
p { max-width:52em }
[hidden] { display:none !important }
.in-shadowed .unshadowed, .in-unshadowed .shadowed { display:none }
.answer { font-size:20px; line-height:1.45; max-width:44em; margin:18px 0 }
.answer b, .good { color:var(--good) } .bad { color:var(--bad) }
small { font-size:13px } .numbers td { white-space:nowrap } .numbers td.text { white-space:normal }
.budgets td.text { white-space:nowrap } .scroll + .curves { margin-top:16px }
.scroll { overflow-x:auto } .scroll table { min-width:760px }
.numbers th { vertical-align:bottom; line-height:1.3 } .numbers td.text, .numbers th.text { text-align:left }
.numbers td:first-child { color:var(--ink) } .budgets td b { font-weight:600 }
tr.apart td { border-top:2px solid var(--soft) }
.badge { display:inline-block; border:1px solid currentColor; border-radius:99px; padding:0 9px;
  font-size:13px; white-space:nowrap }
.choose { position:sticky; top:0; z-index:2; display:flex; flex-wrap:wrap; gap:6px 28px;
  margin:28px -8px 0; padding:10px 8px;
  background:var(--paper); border-bottom:1px solid var(--line); font-size:14px }
.choose div { display:flex; flex-wrap:wrap; gap:6px; align-items:center }
.choose label { border:1px solid var(--line); border-radius:99px; padding:2px 12px; background:var(--card);
  cursor:pointer }
.choose label:has(:checked) { border-color:var(--leaf); box-shadow:inset 0 0 0 1px var(--leaf) }
.choose input { position:absolute; opacity:0; pointer-events:none }
  .choose label:has(:focus-visible) { outline:2px solid var(--leaf) }
.methods { display:flex; flex-wrap:wrap; gap:6px 20px; margin:12px 0 4px; padding:0; font-size:14px;
  max-width:none }
.methods label { display:flex; gap:6px; align-items:center; cursor:pointer } .methods input { margin:0;
  accent-color:var(--leaf) }
.key { width:34px; height:14px; flex:none; display:inline-block; vertical-align:-2px }
.curves { display:grid; grid-template-columns:repeat(auto-fit,minmax(min(100%,460px),1fr)); gap:16px }
.curves .plot { margin:0; padding:12px 12px 6px } .plot h3 { font-size:16px; margin:0 }
  .plot h3 span { font-weight:400; color:var(--soft); font-size:14px }
h3 { font-size:18px; margin:30px 0 6px } h3 .soft { font-weight:400; font-size:14px }
path.grid { fill:none } .better { fill:var(--good); opacity:.09 } .reference { stroke:var(--ink);
  stroke-width:1.2; stroke-dasharray:7 4; fill:none }
svg text.halo { fill:var(--ink); paint-order:stroke; stroke:var(--card); stroke-width:4px;
  stroke-linejoin:round }
.series.off { display:none } .focusing .series:not(.focus) { opacity:.12 }
  .series path:last-child { cursor:default }
.row { display:grid; gap:16px; margin-top:12px;
  grid-template-columns:repeat(auto-fill,minmax(min(100%,210px),1fr)) }
.row.main { grid-template-columns:repeat(auto-fill,minmax(min(100%,320px),1fr)) }
.row img { height:auto; border-radius:8px; background:var(--code) } .row a + a img { margin-top:6px }
.row figcaption { line-height:1.4 } .row figcaption b { color:var(--ink); font-weight:600 }
.row .none { padding:20px 12px; text-align:center; border:1px dashed var(--line); border-radius:8px;
  color:var(--soft); font-size:14px }
.row .none + .none { margin-top:6px }
th button { all:unset; cursor:pointer } th button:hover, th button:focus-visible { color:var(--leaf);
  text-decoration:underline }
th[aria-sort=ascending] button::after { content:" \2191" }
  th[aria-sort=descending] button::after { content:" \2193" }
.samples { font-size:14px } .samples td, .samples th { padding:5px 9px }
.bar { display:inline-block; height:9px; border-radius:2px; background:var(--c0); margin-right:8px;
  vertical-align:1px }
@media (prefers-reduced-motion:no-preference) { html { scroll-behavior:smooth }
  .series { transition:opacity .12s } }
@media print, (max-width:700px) { .choose { position:static } }
)";

inline constexpr const char* k_accuracy_script = R"(
const all = (selector, from = document) => from.querySelectorAll(selector);
const chosen = name => document.querySelector(`[name=${name}]:checked`)?.value;
function apply() {
  document.body.className = 'in-' + (chosen('truth') ?? 'shadowed');
  const view = chosen('view') ?? 'mean';
  for (const part of all('[data-view]')) part.hidden = part.dataset.view !== view;
  for (const box of all('.methods input'))
    for (const line of all('.curves .' + box.value)) line.classList.toggle('off', !box.checked);
}
for (const input of all('input')) input.addEventListener('change', apply);
for (const label of all('.methods label')) {
  const focus = on => {
    const curves = label.closest('section');
    curves.classList.toggle('focusing', on);
    for (const line of all('.' + label.querySelector('input').value, curves))
      line.classList.toggle('focus', on);
  };
  label.addEventListener('mouseenter', () => focus(true));
  label.addEventListener('mouseleave', () => focus(false));
}
for (const button of all('th button')) button.addEventListener('click', () => {
  const head = button.parentNode, body = head.closest('table').tBodies[0];
  const up = head.getAttribute('aria-sort') !== 'ascending';
  for (const other of head.parentNode.children) other.removeAttribute('aria-sort');
  head.setAttribute('aria-sort', up ? 'ascending' : 'descending');
  const truth = chosen('truth') ?? 'shadowed';
  const key = row => {
    const cell = row.cells[head.cellIndex];
    return cell.dataset[truth] ?? cell.dataset.key ?? cell.textContent;
  };
  const order = (a, b) => {
    if (a === '' || b === '') return (a === '') - (b === '');
    return (isNaN(a) || isNaN(b) ? a.localeCompare(b) : a - b) * (up ? 1 : -1);
  };
  body.append(...[...body.rows].sort((a, b) => order(key(a), key(b))));
});
apply();
)";

}  // namespace coppice
