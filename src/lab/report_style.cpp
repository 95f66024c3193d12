#include "lab/report_style.h"

#include <fmt/format.h>

#include "lab/pixels.h"

namespace pentaprism {
namespace {

constexpr const char* kStyle = R"css(
:root{color-scheme:light dark;--paper:#faf9f6;--card:#fff;--ink:#1c1e22;--soft:#5d626b;--line:#dddad2;--accent:#5b34c9;--good:#dff0e2}
@media(prefers-color-scheme:dark){:root{--paper:#131417;--card:#1b1d21;--ink:#e9e8e4;--soft:#a2a6ae;--line:#34373d;--accent:#b49bff;--good:#1f3d29}}
*{box-sizing:border-box}
html{scroll-behavior:smooth}
body{margin:0;background:var(--paper);color:var(--ink);font:16px/1.5 system-ui,sans-serif}
main{max-width:1320px;margin:0 auto;padding:0 24px 64px}
header{max-width:1320px;margin:0 auto;padding:40px 24px 8px}
h1{font-size:2.1rem;line-height:1.15;margin:0 0 8px}
h2{font-size:1.5rem;margin:56px 0 6px;padding-top:12px;border-top:1px solid var(--line)}
h3{font-size:1.05rem;margin:28px 0 6px}
p{max-width:76ch;margin:8px 0}
.soft{color:var(--soft)}
.small{font-size:.86rem}
nav{position:sticky;top:0;z-index:2;background:var(--paper);border-bottom:1px solid var(--line)}
nav div{max-width:1320px;margin:0 auto;padding:8px 24px;display:flex;flex-wrap:wrap;gap:4px 18px;font-size:.9rem}
a{color:var(--accent);text-decoration:none}
a:hover{text-decoration:underline}
.cards{display:grid;grid-template-columns:repeat(auto-fit,minmax(220px,1fr));gap:12px;margin:20px 0}
.card{background:var(--card);border:1px solid var(--line);border-radius:10px;padding:12px 16px}
.card b{display:block;font-size:1.5rem;line-height:1.25}
.card span{color:var(--soft);font-size:.88rem}
.panels{display:grid;grid-template-columns:repeat(auto-fill,minmax(340px,1fr));gap:12px;margin:10px 0}
.panel{background:var(--card);border:1px solid var(--line);border-radius:10px;padding:8px 8px 2px}
svg{width:100%;height:auto;display:block}
svg text{font:11px system-ui,sans-serif;fill:var(--soft)}
svg .head{font-size:13px;font-weight:600;fill:var(--ink)}
svg .end{text-anchor:end}
svg .mid{text-anchor:middle}
svg .grid{stroke:var(--line);stroke-width:1;fill:none}
.series path{fill:none;stroke:var(--c);stroke-width:1.8}
.series circle{fill:var(--c);stroke:var(--card);stroke-width:1}
.series.s0 path{stroke-width:3}
.dim{opacity:.1}
.swatch{display:inline-block;width:22px;height:0;border-top:3px solid var(--c);margin-right:7px;vertical-align:middle}
.scroll{overflow-x:auto;margin:10px 0}
table{border-collapse:collapse;font-size:.88rem;font-variant-numeric:tabular-nums;background:var(--card)}
th,td{padding:5px 10px;border-bottom:1px solid var(--line);text-align:right;white-space:nowrap}
th{font-weight:600;vertical-align:bottom;background:var(--card)}
thead th{border-bottom:2px solid var(--line)}
.tight{font-size:.8rem}.tight th,.tight td{padding:4px 7px}
th.t,td.t{text-align:left}
td.gap,th.gap{border-left:2px solid var(--line)}
td.best{background:var(--good);font-weight:600}
td.bad{color:#c0271a;font-weight:600}
tbody tr:hover td{background:color-mix(in srgb,var(--accent) 8%,var(--card))}
th button,td button{all:unset;cursor:pointer;font:inherit}
th button:focus-visible,td button:focus-visible{outline:2px solid var(--accent)}
th[aria-sort] button::after{content:" \2195";color:var(--soft)}
th[aria-sort=ascending] button::after{content:" \2191";color:var(--accent)}
th[aria-sort=descending] button::after{content:" \2193";color:var(--accent)}
.filters{display:flex;flex-wrap:wrap;gap:10px;margin:10px 0;font-size:.9rem}
select{font:inherit;color:var(--ink);background:var(--card);border:1px solid var(--line);border-radius:6px;padding:3px 6px}
figure{margin:0}
figcaption{font-size:.84rem;color:var(--soft);line-height:1.35;margin-top:4px}
figcaption b{color:var(--ink)}
img{width:100%;height:auto;display:block;border-radius:4px}
.pictures{display:grid;grid-template-columns:repeat(auto-fill,minmax(260px,1fr));gap:14px;margin:12px 0}
.maps{display:grid;grid-template-columns:repeat(auto-fill,minmax(400px,1fr));gap:16px;margin:12px 0}
.maps img{image-rendering:pixelated}
.pair{display:grid;grid-template-columns:1fr 1fr;gap:3px}
.heat{height:12px;width:260px;border-radius:3px;border:1px solid var(--line)}
.heatscale{display:grid;grid-template-columns:auto auto auto;width:260px;font-size:.78rem;color:var(--soft)}
.heatscale :nth-child(2){text-align:center}
.heatscale :nth-child(3){text-align:right}
@media(max-width:520px){.maps{grid-template-columns:1fr}main,header{padding-left:14px;padding-right:14px}}
@media print{nav{display:none}.panel,.card{break-inside:avoid}}
)css";

constexpr const char* kScript = R"js(
for (const table of document.querySelectorAll('table.sortable')) {
  const body = table.tBodies[0];
  [...table.tHead.rows[0].cells].forEach((head, column) => head.querySelector('button').addEventListener('click', () => {
    const up = head.getAttribute('aria-sort') !== 'ascending';
    for (const other of table.tHead.rows[0].cells) other.setAttribute('aria-sort', 'none');
    head.setAttribute('aria-sort', up ? 'ascending' : 'descending');
    const key = row => row.cells[column].dataset.v ?? row.cells[column].textContent;
    const order = (a, b) => { const x = key(a), y = key(b), d = x - y; return Number.isNaN(d) ? x.localeCompare(y) : d; };
    body.append(...[...body.rows].sort((a, b) => up ? order(a, b) : order(b, a)));
  }));
}
const filters = [...document.querySelectorAll('.filters select')];
const filter = () => {
  for (const row of document.querySelectorAll('#all tbody tr'))
    row.hidden = filters.some(f => f.value && row.cells[f.dataset.column].textContent !== f.value);
};
for (const f of filters) f.addEventListener('change', filter);
let lit = null;
document.addEventListener('click', event => {
  const button = event.target.closest('[data-light]');
  if (!button) return;
  lit = lit === button.dataset.light ? null : button.dataset.light;
  for (const series of document.querySelectorAll('[data-m]')) series.classList.toggle('dim', lit !== null && series.dataset.m !== lit);
});
)js";

// Hues that stay apart for most eyes, on light and on dark; then the same ones dashed.
constexpr const char* kHues[] = {"#4a78d6", "#d9820f", "#2f9e58", "#c8453b", "#8d5bd0",
                                 "#9a6b43", "#d264a5", "#1f9bab", "#8a8f1f", "#7c828c"};
constexpr const char* kDashes[] = {"none", "6 4", "2 3", "9 3 2 3"};

}  // namespace

std::string report_style(int methods) {
    std::string style = kStyle;
    style += ".s0{--c:var(--ink)}\n";
    constexpr int hues = static_cast<int>(std::size(kHues));
    for (int i = 1; i < methods; ++i) {
        const int k = i - 1;
        style += fmt::format(".s{}{{--c:{}}}.s{} path{{stroke-dasharray:{}}}\n", i, kHues[k % hues], i,
                             kDashes[k / hues % static_cast<int>(std::size(kDashes))]);
        constexpr const char* kBorders[] = {"solid", "dashed", "dotted", "double"};
        style += fmt::format(".swatch.s{}{{border-top-style:{}}}\n", i, kBorders[k / hues % 4]);
    }
    std::string gradient;
    for (const std::string& colour : heat_scale(16)) gradient += "," + colour;
    return style + ".heat{background:linear-gradient(to right" + gradient + ")}\n";
}

std::string report_script() {
    return kScript;
}

}  // namespace pentaprism
