// How the page of html_report.cc looks.
#pragma once

#include <string_view>

namespace arap::cli {

// Colours keep a contrast of 4.5 (text) and 3 (lines) in light and dark. Pictures are 480 units wide and
// grow with the page; on narrow ones their writing is larger, so that it stays readable.
inline constexpr std::string_view kReportStyle = R"css(
:root {
  --page: #f6f7f9; --box: #ffffff; --text: #1b2027; --soft: #56606c; --edge: #d5dae1; --grid: #e7eaee;
  --s1: #0b62b8; --s2: #b45309; --s3: #b4235a; --s4: #5b6673; --good: #0f7a43; --bad: #c01f2e;
}
@media (prefers-color-scheme: dark) {
  :root {
    --page: #12151a; --box: #1b2027; --text: #e6e9ed; --soft: #a3adb9; --edge: #363e49; --grid: #2a313a;
    --s1: #62b0ff; --s2: #f5a742; --s3: #ff7aa8; --s4: #a3adb9; --good: #4fce8c; --bad: #ff7b80;
  }
}
* { box-sizing: border-box; }
html { font-size: clamp(15px, 9px + 0.6vw, 22px); }
body { margin: 0; background: var(--page); color: var(--text); line-height: 1.45;
  font-family: system-ui, -apple-system, "Segoe UI", "DejaVu Sans", sans-serif; }
main { max-width: 108rem; margin: 0 auto; padding: 1.2rem 1rem 3rem; }
h1, h2, h3 { line-height: 1.2; margin: 0; }
h1 { font-size: 1.6rem; }
h2 { font-size: 1.25rem; margin: 2rem 0 .7rem; }
h3 { font-size: 1rem; margin-bottom: .4rem; }
header p { margin: .3rem 0 1.2rem; color: var(--soft); }
.cards { display: grid; gap: .7rem; margin: 0; grid-template-columns: repeat(auto-fit, minmax(8.5rem, 1fr)); }
.card, .figure, .scroll, details { background: var(--box); border: 1px solid var(--edge); border-radius: .5rem; }
.card { padding: .7rem .8rem; }
.card dt { color: var(--soft); font-size: .85rem; }
.card dd { margin: 0; font-size: 1.5rem; font-weight: 600; font-variant-numeric: tabular-nums; }
.card small { display: block; font-size: .78rem; font-weight: 400; color: var(--soft); }
.card.good dd, .good { color: var(--good); }
.card.bad dd, .bad { color: var(--bad); }
.figures { display: grid; gap: .9rem; grid-template-columns: minmax(0, 1fr); margin-bottom: .9rem; }
.figure { padding: .8rem .8rem .5rem; min-width: 0; }
.figure .scroll { border: 0; margin: 0; padding: 0; }
.legend { display: flex; flex-wrap: wrap; gap: .1rem 1rem; margin: 0 0 .4rem; padding: 0; list-style: none; font-size: .82rem; color: var(--soft); }
.legend svg { width: 30px; height: 8px; margin-right: .4rem; vertical-align: middle; }
.chart { display: block; width: 100%; max-width: 48rem; height: auto; }
.chart text { fill: var(--soft); font-size: 12px; }
.chart .x, .chart .title { text-anchor: middle; }
.chart .end { text-anchor: end; }
.chart .y { text-anchor: end; dominant-baseline: central; }
.chart .note { fill: var(--text); }
.grid { stroke: var(--grid); stroke-width: 1; fill: none; }
.axis { stroke: var(--soft); stroke-width: 1; fill: none; }
.limit { stroke: var(--good); stroke-width: 1.5; stroke-dasharray: 2 3; fill: none; }
.line { fill: none; stroke-width: 2; stroke-linejoin: round; stroke-linecap: round; }
.s1 { stroke: var(--s1); } .s2 { stroke: var(--s2); stroke-dasharray: 7 4; }
.s3 { stroke: var(--s3); stroke-dasharray: 1.5 4; } .s4 { stroke: var(--s4); stroke-dasharray: 3 6; }
circle { fill: var(--box); stroke-width: 2; stroke-dasharray: none !important; }
.band { fill: var(--text); opacity: 0; }
.band:hover { opacity: .09; }
.scroll { overflow-x: auto; margin-bottom: .9rem; padding: .6rem .8rem; }
table { border-collapse: collapse; width: 100%; font-size: .9rem; font-variant-numeric: tabular-nums; }
caption { text-align: left; color: var(--soft); font-size: .82rem; padding-bottom: .4rem; }
th, td { text-align: right; padding: .25rem .6rem; border-top: 1px solid var(--grid); white-space: nowrap; }
th:first-child, .words th, .words td { text-align: left; }
div.words { width: fit-content; max-width: 100%; }
.words th, .words td { white-space: normal; vertical-align: top; padding-right: 1.6rem; }
.words td:last-child { min-width: 9rem; padding-right: 0; }
thead th { color: var(--soft); font-weight: 600; border-top: 0; }
tbody th { font-weight: 500; }
tr > :first-child { padding-left: 0; }
details { margin-bottom: .9rem; }
summary { cursor: pointer; padding: .6rem .8rem; }
details .scroll { border: 0; max-height: 30rem; overflow: auto; margin: 0; }
@media (min-width: 1000px) { .figures { grid-template-columns: repeat(2, minmax(0, 1fr)); } }
@media (min-width: 2000px) {
  .figures { grid-template-columns: repeat(4, minmax(0, 1fr)); }
  .figures.two { grid-template-columns: repeat(2, minmax(0, 1fr)); }
  .chart text { font-size: 15px; }
  .two .chart text { font-size: 12px; }
}
@media (max-width: 600px) { .chart text { font-size: 16px; } main { padding: .8rem .7rem 2rem; }
  .words th, .words td { padding-right: .8rem; } .words td:last-child { min-width: 6.5rem; } }
@media print { .figure, .card, .scroll { break-inside: avoid; } .band { display: none; } }
)css";

}  // namespace arap::cli
