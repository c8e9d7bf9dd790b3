// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace tuina::telemetry {

/// The style sheet of every page: light, for desktop, phone and paper, with the fonts that are
/// there.
inline constexpr const char* page_style = R"css(
:root{--ink:#1f232a;--soft:#5b626d;--line:#e3e5e9;--paper:#fbfaf8;--card:#fff;--accent:#c8342c}
*{box-sizing:border-box}
html{-webkit-text-size-adjust:100%}
body{margin:0;background:var(--paper);color:var(--ink);font:16px/1.6 Inter,system-ui,-apple-system,"Segoe UI",Roboto,Helvetica,Arial,sans-serif;font-variant-numeric:tabular-nums}
main{max-width:1120px;margin:0 auto;padding:56px 40px 40px}
h1,h2{font-family:"Iowan Old Style","Palatino Linotype",Palatino,"URW Palladio L","P052","Book Antiqua",Georgia,serif;font-weight:600;letter-spacing:-.01em;line-height:1.2;text-wrap:balance}
h1{font-size:44px;margin:6px 0 10px;overflow-wrap:anywhere}
h2{font-size:27px;margin:0 0 6px}
h3{font-size:15px;font-weight:650;margin:26px 0 4px}
p{margin:0 0 12px;max-width:46em}
.over{display:flex;gap:12px;align-items:center;font-size:13px;letter-spacing:.09em;text-transform:uppercase;color:var(--soft)}
.badge{letter-spacing:.04em;border:1px solid #d9b08c;background:#fdf3e7;color:#8a4b12;border-radius:99px;padding:1px 11px;font-weight:600}
.badge.bad{border-color:#efb3bb;background:#fdeef0;color:#a3142f}
.meta{color:var(--soft);font-size:15px}
.lead{font-size:20px;line-height:1.6;margin:26px 0 34px;max-width:43em}
.tiles{display:flex;flex-wrap:wrap;gap:1px;background:var(--line);border:1px solid var(--line);border-radius:12px;overflow:hidden;margin:0 0 20px}
.tile{background:var(--card);padding:15px 14px 13px 16px;flex:1 1 136px}
.tiles.rows .tile{flex-basis:max(136px,22%)}
.tile b{display:block;font-size:26px;line-height:1.15;font-weight:600;letter-spacing:-.02em;white-space:nowrap}
.tile b small{font-size:14px;font-weight:500;color:var(--soft);letter-spacing:0;margin-left:4px}
.tile .label{display:block;font-size:13px;color:var(--soft);margin-bottom:4px}
.tile i{display:block;font-style:normal;font-size:12.5px;color:var(--soft);line-height:1.4;margin-top:4px}
section{background:var(--card);border:1px solid var(--line);border-radius:14px;padding:30px 34px 28px;margin:0 0 22px}
section>p:first-of-type{color:var(--soft)}
.two{display:grid;grid-template-columns:minmax(0,1.6fr) minmax(0,1fr);gap:30px;align-items:start}
.even{display:grid;grid-template-columns:1fr 1fr;gap:24px}
.three{display:grid;grid-template-columns:repeat(auto-fit,minmax(min(100%,290px),1fr));gap:20px}
.strip.odd{grid-template-columns:repeat(auto-fill,minmax(300px,1fr))}
svg{max-width:100%;height:auto;display:block}
svg.back{width:100%}
.strip{display:grid;grid-template-columns:repeat(auto-fill,minmax(226px,1fr));gap:22px 20px;margin:14px 0 6px}
figure{margin:0;break-inside:avoid}
figure svg{width:100%}
figcaption{font-size:13px;line-height:1.45;color:var(--soft);border-top:1px solid var(--line);padding-top:6px;margin-top:4px}
figcaption b{color:var(--ink);display:block}
figcaption span{display:block}
figcaption i{width:9px;height:9px;border-radius:99px;display:inline-block;margin-right:6px}
.wide{overflow-x:auto}
table{border-collapse:collapse;width:100%;font-size:14.5px;margin:6px 0 10px}
th{font-size:12.5px;font-weight:600;color:var(--soft);text-align:right;padding:7px 8px;border-bottom:1.5px solid #c9cdd4;vertical-align:bottom;line-height:1.3}
td{text-align:right;padding:7px 8px;border-bottom:1px solid var(--line);white-space:nowrap}
.l{text-align:left}
td.long{white-space:normal;min-width:16em}
td.group{text-align:left;white-space:normal;padding-top:18px;font-weight:600}
table.dense{font-size:12px}.dense th{font-size:11px}.dense th,.dense td{padding:6px 5px}
tr.ours{background:#fdf3e7}
td em{font-style:normal;color:var(--soft);font-size:13px;margin-left:6px}
.sim{background:#fdf8f1}
th.sim{color:#8a4b12}
.key{display:flex;flex-wrap:wrap;gap:4px 20px;font-size:14px;color:var(--soft);margin:10px 0 4px;padding:0;list-style:none}
.key li{display:flex;align-items:center;gap:7px}
.key i{width:12px;height:12px;border-radius:99px;display:inline-block}
.key i.flat{height:4px;width:18px}
.note{font-size:13.5px;color:var(--soft)}
.stop{border-left:4px solid #d61e3e;background:#fdeef0;padding:10px 16px;border-radius:0 8px 8px 0;margin:8px 0}
.calm{border-left:4px solid #10846a;background:#edf7f4;padding:10px 16px;border-radius:0 8px 8px 0;margin:8px 0;max-width:none}
details{margin:4px 0}
summary{cursor:pointer;font-weight:600}
pre{overflow-x:auto;background:#f6f6f4;border-radius:8px;padding:16px 18px;font:12.5px/1.55 ui-monospace,"SF Mono",Menlo,Consolas,"DejaVu Sans Mono",monospace}
footer{color:var(--soft);font-size:13.5px;padding:8px 4px 0}
@media(max-width:760px){
main{padding:28px 16px}
h1{font-size:32px}.lead{font-size:17.5px;margin:18px 0 24px}
section{padding:22px 18px 20px;margin-left:-6px;margin-right:-6px}
.two,.even,.three{grid-template-columns:minmax(0,1fr);gap:18px}
.wide>svg{width:820px;max-width:none}
.wide.half>svg{width:100%;max-width:100%}
svg.back .remark{display:none}svg.back .name{font-size:21px}
table{font-size:13.5px}th,td{padding:6px 5px}
}
@media print{
body{background:#fff;font-size:10.5pt}main{max-width:none;padding:0}
section,.tiles{border-color:#ccc;break-inside:avoid}section.long{break-inside:auto}
.wide{overflow:visible}h2{break-after:avoid}svg,table{break-inside:avoid}
pre{white-space:pre-wrap}
@page{margin:16mm 14mm}
}
)css";

}  // namespace tuina::telemetry
