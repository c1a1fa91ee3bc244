/// \file
/// The style sheet of the report for light and dark screens, phones and paper. The contrast of text
/// is at least 4.5 (WCAG 2.1, AA); a test computes it from the variables.
#pragma once

#include <string_view>

namespace lefort::report {

inline constexpr std::string_view kPageStyle = R"css(
:root {
  color-scheme: light dark;
  --ground: #ffffff; --panel: #f5f7f9; --ink: #1b2026; --muted: #56606b; --rule: #d9dee4;
  --caution-ground: #fff3cd; --caution-ink: #5c4300; --alarm-ground: #b3121d; --alarm-ink: #ffffff;
  --line-1: #1f5fa8; --line-2: #b3480f; --line-3: #2f7d32; --line-4: #7b3fa0;
}
@media (prefers-color-scheme: dark) {
  :root {
    --ground: #14181d; --panel: #1c2229; --ink: #e8ebef; --muted: #aab4bf; --rule: #39424c;
    --caution-ground: #3d3000; --caution-ink: #ffe69a; --alarm-ground: #c0141f;
    --alarm-ink: #ffffff;
    --line-1: #6cb2f0; --line-2: #f0a060; --line-3: #7fcf85; --line-4: #c99df0;
  }
}
* { box-sizing: border-box; }
body { margin: 0; background: var(--ground); color: var(--ink);
  font: 16px/1.55 system-ui, "Segoe UI", "DejaVu Sans", sans-serif; }
.caution, .alarm { margin: 0; padding: .55rem 1rem; text-align: center; font-weight: 600; }
.caution { background: var(--caution-ground); color: var(--caution-ink); }
.alarm { background: var(--alarm-ground); color: var(--alarm-ink); letter-spacing: .02em; }
header.alarm { font-size: 1.15rem; }
header.alarm p { margin: .1rem 0; }
main { max-width: 74rem; margin: 0 auto; padding: 1.6rem 1.2rem 3rem; }
h1 { font-size: 1.9rem; line-height: 1.2; margin: 0; letter-spacing: -.01em; }
h2 { font-size: 1.2rem; margin: 2.6rem 0 .8rem; padding-bottom: .3rem;
  border-bottom: 1px solid var(--rule); }
h3 { font-size: 1rem; margin: 0 0 .4rem; }
main p { margin: .5rem 0; max-width: 62rem; overflow-wrap: anywhere; }
.subtitle { color: var(--muted); }
.plan { font-size: 1.1rem; margin-top: 1rem; }
.pictures { display: grid; gap: 1.4rem;
  grid-template-columns: repeat(auto-fit, minmax(min(100%, 30rem), 1fr)); }
figure .alarm, section > .alarm { max-width: none; }
figure { margin: 0; break-inside: avoid; }
figure img { display: block; width: 100%; height: auto; background: #ffffff; }
.frame { border: 1px solid var(--rule); border-radius: 6px; overflow: hidden; }
figcaption { padding-top: .5rem; color: var(--muted); font-size: .93rem; overflow-wrap: anywhere; }
figcaption strong { color: var(--ink); display: block; }
.compare { --at: 50%; }
.stack { display: grid; position: relative; }
.stack img { grid-area: 1 / 1; }
.stack .after { clip-path: inset(0 0 0 var(--at)); }
.stack::after { content: ""; position: absolute; top: 0; bottom: 0; left: var(--at); width: 2px;
  margin-left: -1px; background: #1b2026; }
.slider { display: flex; gap: .8rem; align-items: center; padding-top: .5rem; font-size: .93rem; }
.slider input { flex: 1; accent-color: var(--line-1); min-height: 1.5rem; cursor: ew-resize; }
.numbers { display: grid; gap: 1rem; margin: 0;
  grid-template-columns: repeat(auto-fit, minmax(12rem, 1fr)); }
.numbers div { background: var(--panel); border: 1px solid var(--rule); border-radius: 6px;
  padding: .8rem 1rem; display: flex; flex-direction: column-reverse; justify-content: flex-end; }
.numbers dt { color: var(--muted); font-size: .9rem; line-height: 1.35; overflow-wrap: anywhere; }
.numbers dd { margin: 0; font-size: 1.6rem; font-weight: 600; font-variant-numeric: tabular-nums;
  overflow-wrap: anywhere; }
.plots svg { display: block; width: 100%; height: auto; }
.scroll { overflow-x: auto; margin-bottom: 1.4rem; }
table { border-collapse: collapse; width: 100%; font-size: .95rem;
  font-variant-numeric: tabular-nums; }
caption { text-align: left; font-weight: 600; padding-bottom: .4rem; }
th, td { padding: .38rem .7rem; border-bottom: 1px solid var(--rule); text-align: right;
  vertical-align: baseline; }
th:first-child, td:first-child { text-align: left; }
thead th { border-bottom: 2px solid var(--muted); }
tbody th { font-weight: 400; }
.provenance th { white-space: nowrap; color: var(--muted); }
.provenance td { text-align: left; font-family: ui-monospace, "DejaVu Sans Mono", monospace;
  font-size: .85rem; overflow-wrap: anywhere; }
footer { color: var(--muted); font-size: .9rem; margin-top: 2.5rem; padding-top: .8rem;
  border-top: 1px solid var(--rule); }
@media print {
  :root { --ground: #ffffff; --panel: #ffffff; --ink: #000000; --muted: #444444; --rule: #bbbbbb;
    --caution-ground: #ffffff; --caution-ink: #000000;
    --line-1: #1f5fa8; --line-2: #b3480f; --line-3: #2f7d32; --line-4: #7b3fa0; }
  body { font-size: 10pt; }
  main { max-width: none; padding: .8rem 0 0; }
  .caution { border: 1.5pt solid #000000; }
  .alarm, .frame { -webkit-print-color-adjust: exact; print-color-adjust: exact; }
  .slider, .stack::after { display: none; }
  .stack { grid-template-columns: 1fr 1fr; }
  .stack img { grid-area: auto; }
  .stack .after { clip-path: none; }
  h2, caption { break-after: avoid; }
  tr, .numbers div { break-inside: avoid; }
  .pictures { grid-template-columns: 1fr 1fr; }
  .pictures .compare { grid-column: 1 / -1; }
}
)css";

}  // namespace lefort::report
