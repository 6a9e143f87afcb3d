// The look of every page the program writes: sizes, cards, plots, tables, in a light and a dark theme.
#pragma once

namespace coppice {

inline constexpr const char* k_page_style = R"(
:root { --ink:#1d2a22; --soft:#5d6c62; --line:#dfe6df; --leaf:#2f6b3f; --paper:#fbfcf9; --card:#fff;
  --code:#eef3ec }
@media (prefers-color-scheme:dark) {
  :root { --ink:#e6ece6; --soft:#9dac9f; --line:#2f3a32; --leaf:#86c795; --paper:#121713; --card:#1a211c;
  --code:#263029;
    color-scheme:dark }
}
* { box-sizing:border-box }
body { margin:0; background:var(--paper); color:var(--ink);
  font:16px/1.55 system-ui,"Segoe UI",Roboto,sans-serif }
main { max-width:1040px; margin:0 auto; padding:48px 24px 72px }
h1 { font-size:34px; line-height:1.15; margin:0 0 8px; letter-spacing:-.01em }
h2 { font-size:21px; margin:48px 0 4px }
p { margin:4px 0 14px; max-width:46em } .soft { color:var(--soft) }
.cards { display:grid; grid-template-columns:repeat(auto-fit,minmax(176px,1fr)); gap:14px; margin:28px 0 8px }
.card { background:var(--card); border:1px solid var(--line); border-radius:12px; padding:16px 18px }
.card b { display:block; font-size:28px; line-height:1.2; color:var(--leaf);
  font-variant-numeric:tabular-nums }
.card span { color:var(--soft); font-size:14px }
figure { margin:0 } figcaption { color:var(--soft); font-size:14px; padding:6px 2px 0 }
img { width:100%; display:block; border-radius:10px }
.hero { margin:26px 0 0 }
.pictures { display:grid; grid-template-columns:repeat(auto-fill,minmax(440px,1fr)); gap:20px;
  margin-top:14px }
.plot { background:var(--card); border:1px solid var(--line); border-radius:12px; padding:16px 14px 6px;
  margin-top:10px }
svg { width:100%; height:auto; display:block } svg text { font-size:12px; fill:var(--soft) }
svg .grid { stroke:var(--line); stroke-width:1 }
.legend { display:flex; flex-wrap:wrap; gap:4px 18px; font-size:14px; margin:8px 0 6px 50px; max-width:none }
.legend i { display:inline-block; width:11px; height:11px; border-radius:3px; margin-right:6px }
table { border-collapse:collapse; width:100%; background:var(--card); border:1px solid var(--line);
  font-size:15px;
  margin-top:10px } td,th { text-align:left; padding:7px 14px; border-top:1px solid var(--line);
  vertical-align:top }
th { color:var(--soft); font-weight:500 } td:first-child { color:var(--soft); width:34% }
.numbers td, .numbers th { text-align:right; width:auto; font-variant-numeric:tabular-nums }
code { font:13px/1.5 ui-monospace,Menlo,Consolas,monospace; background:var(--code); padding:2px 6px;
  border-radius:5px;
  overflow-wrap:anywhere }
@media (max-width:520px) { .pictures { grid-template-columns:1fr } }
)";

}  // namespace coppice
