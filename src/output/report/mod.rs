//! `report.html`: one page that tells a person what a sweep has found. Self-contained, and small whatever the sweep.
//!
//! The table is read once, row by row; curves of a few designs are computed again from their joints.

pub mod html;
pub mod tallies;
pub mod sample;
pub mod scan;
mod sensitivity;
pub mod laws;
pub mod chosen;
pub mod answers;
mod curves;
mod asked;
mod pressure;
mod map;
mod misfit;
mod errors;
mod failures;
mod origin;

use crate::error::Error;
use crate::output::chart::style::{page_variables, style_sheet};
use crate::output::chart::text::escaped;
use crate::output::results::Results;
use crate::study::config::Asked;
use chosen::Chosen;
use scan::Scan;

/// The most designs whose curves are drawn.
pub const MOST_DESIGNS: usize = 7;

/// What all sections are made from.
pub struct Report<'a> {
    pub results: &'a Results,
    pub title: String,
    pub asked: Asked,
    pub scan: Scan,
    pub chosen: Vec<Chosen>,
    /// Whether the user has named the designs.
    pub named: bool,
}

/// Whether a result has what a page is made of.
pub fn has_page(results: &Results) -> bool {
    if results.has_table() {
        results.rows(&scan::NEEDED).is_ok()
    } else {
        !answers::section(results.dir()).is_empty()
    }
}

/// The whole page, with the curves of `designs`, or of some spread over the sweep where none is named.
pub fn page(results: &Results, designs: &[u64]) -> Result<String, Error> {
    let mut designs = designs.to_vec();
    designs.sort_unstable();
    designs.dedup();
    if designs.len() > MOST_DESIGNS {
        return Err(Error::TooManyDesigns { asked: designs.len(), most: MOST_DESIGNS });
    }
    let answers = answers::section(results.dir());
    let sensitivity = sensitivity::section(results.dir());
    if !results.has_table() && !answers.is_empty() {
        let title = origin::title(results);
        let header = format!("<header>\n<h1>{}</h1>\n</header>\n", escaped(&title));
        return Ok(whole(&title, &[header, answers, sensitivity, origin::section(results)].concat()));
    }
    let asked = results.asked()?;
    let scan = Scan::read(results, asked.solve.accuracy, &designs)?;
    let chosen = chosen::choose(&scan, &designs, asked.solve);
    let title = origin::title(results);
    let report = Report { results, title, asked, scan, chosen, named: !designs.is_empty() };
    let sections = [
        asked::section(&report),
        answers,
        curves::section(&report),
        pressure::section(&report),
        map::section(&report),
        misfit::section(&report),
        errors::section(&report),
        failures::section(&report),
        sensitivity,
        origin::section(results),
    ];
    Ok(whole(&report.title, &sections.concat()))
}

fn whole(title: &str, sections: &str) -> String {
    format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\"/>\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\"/>\n\
         <meta name=\"color-scheme\" content=\"light dark\"/>\n<title>{}</title>\n\
         <style>\n{}{}{PAGE_STYLE}</style>\n</head>\n<body>\n<main>\n{}</main>\n</body>\n</html>\n",
        escaped(title),
        page_variables(),
        style_sheet(),
        sections
    )
}

const PAGE_STYLE: &str = "\
*{box-sizing:border-box}
body{margin:0;background:var(--paper);color:var(--ink);font:16px/1.5 system-ui,\"Segoe UI\",Helvetica,Arial,sans-serif}
main{max-width:1120px;margin:0 auto;padding:24px 20px 48px}
h1{font-size:1.75rem;line-height:1.25;margin:0 0 .2em;overflow-wrap:anywhere}
h2{font-size:1.25rem;margin:2.2em 0 .5em;padding-top:.7em;border-top:1px solid var(--line)}
p{margin:.5em 0;max-width:76ch}
.faint{color:var(--faint)}
.facts{display:grid;grid-template-columns:repeat(auto-fit,minmax(150px,1fr));gap:10px;margin:18px 0;padding:0}
.facts div{border:1px solid var(--line);border-radius:8px;padding:9px 12px}
.facts dt{color:var(--faint);font-size:.82rem}
.facts dd{margin:0;font-size:1.12rem;font-weight:600;font-variant-numeric:tabular-nums}
.charts{display:grid;grid-template-columns:repeat(auto-fill,minmax(min(100%,460px),1fr));gap:22px 28px;margin:14px 0}
figure{margin:0;min-width:0;break-inside:avoid}
figcaption{font-weight:600;margin-bottom:2px}
figcaption small{display:block;font-weight:400;color:var(--faint);font-size:.85rem;line-height:1.4}
svg.chart{display:block;width:100%;height:auto;max-width:620px;print-color-adjust:exact;-webkit-print-color-adjust:exact}
.wide{overflow-x:auto;margin:12px 0}
table{border-collapse:collapse;font-size:.92rem;font-variant-numeric:tabular-nums}
th,td{padding:4px 12px 4px 0;text-align:right;vertical-align:top;border-bottom:1px solid var(--line)}
th{font-weight:600;color:var(--faint);vertical-align:bottom}
th:first-child,td:first-child,.words{text-align:left}
td.words:first-child{min-width:8em}
td,th{white-space:nowrap}.words{white-space:normal}
.key{display:inline-block;width:.85em;height:.85em;border-radius:3px;margin-right:.5em;vertical-align:-.06em;\
print-color-adjust:exact;-webkit-print-color-adjust:exact}
code,pre{font-family:ui-monospace,Menlo,Consolas,monospace;font-size:.88em}
pre{overflow:auto;max-height:32em;padding:12px;border:1px solid var(--line);border-radius:8px;line-height:1.4}
summary{cursor:pointer;font-weight:600}
@media (max-width:480px){main{padding:16px 14px 32px}h1{font-size:1.4rem}body{font-size:15px}}
@media print{main{max-width:none;padding:0}section>p,header>p{break-after:avoid}\
.facts{grid-template-columns:repeat(6,1fr);gap:6px}\
.facts dd{font-size:.95rem}body{font-size:10.5pt}h2{break-after:avoid}tr{break-inside:avoid}\
.charts{grid-template-columns:1fr 1fr;gap:14px 18px}.wide{overflow:visible}pre{max-height:none;white-space:pre-wrap}}
@page{margin:14mm}
";
